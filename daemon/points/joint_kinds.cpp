#include "daemon/points/joint_kinds.hpp"

#include "identify/sweeps/sample.hpp"

namespace sweepd {

std::vector<JointKind> joint_kinds(const RobotSetup& setup) {
  const auto kind = [](bool linear) { return linear ? JointKind::linear : JointKind::turning; };
  std::vector<JointKind> kinds(identify::kMostJoints);
  if (setup.plan)
    for (const auto& sweep : setup.plan->sweeps) kinds[sweep.joint - 1] = kind(sweep.linear);
  const auto limits = setup.limits();
  for (std::size_t j = 0; j < limits.size(); ++j) kinds[j] = kind(limits[j].linear);
  return kinds;
}

}  // namespace sweepd
