#include "identify/poses/pose_sag.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

/// One a joint, as poses tell.
std::vector<double> sag_of(const PoseEstimate& found) {
  const PoseModel& model = found.fit.model;
  std::vector<double> sag_rad(model.chain.axes.size());
  std::vector<bool> carries(sag_rad.size());
  for (const JointEffect& effect : model.effects)
    if (effect.kind == JointEffect::Kind::weight) carries[effect.joint] = true;
  for (const JointEffect& effect : model.effects) {
    double size_rad = 0;
    if (effect.kind == JointEffect::Kind::compliance)
      for (const Pose& pose : found.poses)
        size_rad = std::max(
            size_rad,
            std::abs(effect.size.dot(model.patterns({effect}, model.told(pose.sample))[0])));
    else if (!effect.assumed && carries[effect.joint])
      size_rad = effect.amplitude();
    else if (effect.kind == JointEffect::Kind::weight)
      size_rad = std::sqrt(2) *  // of two sizes
                 std::hypot(found.fit.noise.weights_rad, found.weights_unsure_rad);
    sag_rad[effect.joint] = std::hypot(sag_rad[effect.joint], size_rad);
  }
  return sag_rad;
}

}  // namespace

double weights_unsure_rad(const PoseFit& fit, const std::vector<Pose>& poses,
                          const std::optional<ChainPrior>& prior) {
  constexpr double kUsual_rad = 10 * kArcsec;
  if (!(fit.noise.weights_rad > 0)) return 0;
  PoseNoise noise = fit.noise;
  noise.weights_rad = kUsual_rad;
  const PoseFit usual = with_noise(fit, noise, poses, prior);
  double known = 0, count = 0;
  Eigen::Index at = usual.model.chain_parameters().count(true);
  for (const JointEffect& effect : usual.model.effects)
    for (Eigen::Index k = 0; k < effect.count(); ++k, ++at) {
      if (!effect.assumed || effect.kind != JointEffect::Kind::weight) continue;
      const double beforehand = std::pow(usual.known_beforehand(effect), 2);
      known += 1 - usual.covariance(at, at) / beforehand;  // s^2 / (s^2 + v)
      ++count;
    }
  if (!(known > 0)) return kUsual_rad;
  const double usual_square = kUsual_rad * kUsual_rad;
  const double told = std::max(0.0, usual_square * (count / known - 1));  // v
  const double square = fit.noise.weights_rad * fit.noise.weights_rad;
  return std::sqrt(std::min(usual_square, (square + told) * std::sqrt(2 / count)));
}

bool grant_sag(const PoseEstimate& found, std::vector<double>& granted_rad) {
  constexpr double kMore = 1.2, kNone_rad = 1 * kArcsec;
  const auto sag_rad = sag_of(found);
  granted_rad.resize(sag_rad.size());
  bool more = false;
  for (std::size_t j = 0; j < sag_rad.size(); ++j) {
    more = more || sag_rad[j] > kMore * granted_rad[j] + kNone_rad;
    granted_rad[j] = std::max(granted_rad[j], sag_rad[j]);
  }
  return more;
}

}  // namespace identify
