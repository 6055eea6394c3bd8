#include "identify/poses/pose_sag.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "identify/geometry/angle.hpp"

namespace identify {

std::vector<double> sag_of(const PoseEstimate& found) {
  const PoseModel& model = found.fit.model;
  std::vector<double> sag_rad(model.chain.axes.size());
  std::vector<bool> carries(sag_rad.size());
  for (const JointEffect& effect : model.effects)
    if (effect.kind == JointEffect::Kind::weight) carries[effect.joint] = true;
  for (const JointEffect& effect : model.effects) {
    double size_rad = 0;
    // Poses hardly tell a wheel that is off from weight, where a joint carries any.
    if (effect.kind == JointEffect::Kind::weight || (!effect.assumed && carries[effect.joint])) {
      size_rad = effect.assumed ? std::sqrt(2) * found.fit.noise.weights_rad : effect.amplitude();
    } else if (effect.kind == JointEffect::Kind::compliance) {
      for (const Pose& pose : found.poses)
        size_rad = std::max(
            size_rad, std::abs(effect.size.dot(model.pattern(effect, model.told(pose.sample)))));
    }
    sag_rad[effect.joint] = std::hypot(sag_rad[effect.joint], size_rad);
  }
  return sag_rad;
}

bool gives_way_more(const std::vector<double>& sag_rad, const std::vector<double>& granted_rad) {
  constexpr double kMore = 1.2, kNone_rad = 1 * kArcsec;
  for (std::size_t j = 0; j < sag_rad.size(); ++j) {
    const double granted = j < granted_rad.size() ? granted_rad[j] : 0;
    if (sag_rad[j] > kMore * granted + kNone_rad) return true;
  }
  return false;
}

}  // namespace identify
