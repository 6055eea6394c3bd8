#include "daemon/points/missing_angles.hpp"

#include <spdlog/fmt/fmt.h>

#include "rsi/counted.hpp"

namespace sweepd {

std::optional<identify::Warning> missing_angles(const PointsFile& file) {
  if (file.without_angles == 0) return std::nullopt;
  return identify::Warning{
      "angles_missing",
      {},
      fmt::format("{} of {} of {} have no angles of {}, as these fields are empty. Such points are "
                  "left out, or tell positions alone: fill in the angles, or skip the columns of "
                  "all angles with --columns",
                  file.without_angles, rsi::counted(file.points.size(), "point"),
                  file.path.filename().string(), identify::joints_named(file.joints_untold))};
}

}  // namespace sweepd
