#include "daemon/points/point_poses.hpp"

#include <spdlog/fmt/fmt.h>

#include "rsi/counted.hpp"

namespace sweepd {

bool holds_poses(const PointsFile& file) {
  return !file.with_joints && (file.with_poses || (!file.with_times && file.angles > 0));
}

std::vector<identify::Pose> static_poses(const PointsFile& file, std::size_t joints) {
  if (file.angles < joints)
    throw CsvError(
        fmt::format("{}: expected joint angles of {} for static poses, found those of {}: add "
                    "the columns a1_deg to a{}_deg",
                    file.path.string(), rsi::counted(joints, "joint"), file.angles, joints));
  std::vector<identify::Pose> poses;
  for (const Point& point : file.points)
    if (point.sample.has_position && point.sample.joints >= joints)
      poses.push_back({point.sample, point.target,
                       fmt::format("{} line {}", file.path.filename().string(), point.line)});
  return poses;
}

}  // namespace sweepd
