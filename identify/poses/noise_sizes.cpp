#include "identify/poses/noise_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Below it residuals are those of computing.
constexpr double kLeastNoise_mm = 1e-6;
constexpr double kLeastJoint_rad = 1e-9;
/// One wheel that is off, or two, tell nothing of the others.
constexpr std::size_t kManyWheels = 3;

}  // namespace

double NoiseSizes::Sized::times() const {
  return expected > 0 ? std::sqrt(seen / expected) : 1;
}

void NoiseSizes::Sized::hold(double now, double before) {
  constexpr double kBefore = 4;
  if (!(now > 0)) return;
  seen += kBefore * before * before / std::pow(now, 4);
  expected += kBefore / (now * now);
}

NoiseSizes::NoiseSizes(const PoseFit& fit, const std::vector<StandRows>& stands,
                       const VectorXd& step)
    : now_(fit.noise) {
  for (const StandRows& stand : stands) add_stand(stand, fit.covariance, step);
  add_effects(fit, step);
}

void NoiseSizes::add_stand(const StandRows& stand, const MatrixXd& covariance,
                           const VectorXd& step) {
  const Index count = stand.off.size();
  const VectorXd left = stand.off - stand.columns.transpose() * step(stand.parameters);
  const VectorXd weighed = stand.divided_again(left);
  // V^-1 less what the fit takes up, in which each component is measured.
  const MatrixXd free = stand.divided_again(
      stand.divided_again(MatrixXd::Identity(count, count) - stand.taken_up(covariance))
          .transpose());
  const auto measure = [&](const MatrixXd& by, Sized& sized) {
    sized.seen += weighed.dot(by * weighed);
    sized.expected += free.cwiseProduct(by).sum();
  };
  measure(stand.by_position, position_);
  measure(stand.by_orientation, orientation_);
  measure(stand.by_joints, joints_);
}

void NoiseSizes::add_effects(const PoseFit& fit, const VectorXd& step) {
  Index at = fit.model.chain_parameters().count(true);
  std::set<std::size_t> found;
  for (const JointEffect& effect : fit.model.effects)
    if (!effect.assumed && effect.is_wheel()) found.insert(effect.joint);
  const bool many = now_.gears_rad > 0 && found.size() >= kManyWheels;
  // What gives way to one weight does to others.
  const bool elastic = now_.weights_rad > 0;
  // A size that was held to its variance beforehand falls short by what is left open of it; one
  // that was not exceeds it by that.
  const auto take = [&](double size, double sigma, bool held, Sized& sized) {
    const double known = sigma * sigma, off = size + step(at);
    const double open = fit.covariance(at, at) / (known * fit.widened);
    sized.seen += off * off / (known * known);
    sized.expected += (held ? 1 - open : 1 + open) / known;
    ++at;
  };
  const auto sized = [&](JointEffect::Kind kind) -> Sized& {
    if (kind == JointEffect::Kind::weight) return weights_;
    return kind == JointEffect::Kind::play ? play_ : gears_;
  };
  for (const JointEffect& effect : fit.model.effects)
    if (effect.assumed || (many && effect.is_wheel()) ||
        (elastic && effect.kind == JointEffect::Kind::weight))
      for (Index k = 0; k < effect.count(); ++k)
        take(effect.size(k), now_.assumed_rad(effect.kind), effect.assumed, sized(effect.kind));
    else
      at += effect.count();
  for (const JointPlace& place : fit.model.places)
    take(place.off_rad, now_.joint_rad, true, joints_);
}

void NoiseSizes::hold(const PoseNoise& before) {
  position_.hold(now_.position_mm, before.position_mm);
  joints_.hold(now_.joint_rad, before.joint_rad);
  orientation_.hold(now_.orientation_rad, before.orientation_rad);
}

double NoiseSizes::joint_share() const {
  const double joint = now_.joint_rad * now_.joint_rad * joints_.expected;
  const double rest = now_.position_mm * now_.position_mm * position_.expected;
  return joint / (joint + rest);
}

PoseNoise NoiseSizes::next() const {
  PoseNoise noise = now_;
  noise.position_mm = std::max(kLeastNoise_mm, noise.position_mm * position_.times());
  noise.orientation_rad *= orientation_.times();
  noise.joint_rad = std::max(kLeastJoint_rad, noise.joint_rad * joints_.times());
  noise.gears_rad = std::max(kLeastJoint_rad, noise.gears_rad * gears_.times());
  if (noise.weights_rad > 0)
    noise.weights_rad = std::max(kLeastJoint_rad, noise.weights_rad * weights_.times());
  if (noise.play_rad > 0)
    noise.play_rad = std::max(kLeastJoint_rad, noise.play_rad * play_.times());
  return noise;
}

}  // namespace identify
