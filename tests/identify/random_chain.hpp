#pragma once

// Random arms as chains, and samples of their sweeps, for tests of the chain's parts.

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "identify/chain/chain.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/chain_residual.hpp"
#include "identify/geometry/angle.hpp"

namespace identify::test {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  double normal(double sigma = 1) { return sigma * gauss_(engine_); }
  double uniform(double from, double to) {
    return from + (to - from) * std::uniform_real_distribution<>()(engine_);
  }
  Eigen::Vector3d vector(double sigma) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  Eigen::Vector3d direction() { return vector(1).normalized(); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<> gauss_;
};

/// Axes in any direction, lengths of some hundred millimetres.
inline Chain random_chain(std::size_t joints, std::size_t targets, Random& random) {
  Chain chain;
  for (std::size_t j = 0; j < joints; ++j)
    chain.axes.push_back({random.direction(), random.vector(400)});
  for (std::size_t t = 0; t < targets; ++t) chain.targets_mm.push_back(random.vector(500));
  chain.tool = Eigen::AngleAxisd(random.uniform(0, 3), random.direction()).toRotationMatrix();
  return chain;
}

/// How the samples of sweeps are measured.
struct Measured {
  double position_mm = 0;
  double orientation_rad = 0;
  double locked_rad = 0;  ///< error of the angles; the joints themselves wobble ten times as much
  double swept_rad = 0;
  double from_rad = -0.8;
  double to_rad = 0.8;
  int samples = 50;  ///< a sweep
};

/// A sweep of each joint for each target, exact turns with the errors asked for.
inline std::vector<ChainObservation> sweeps_of(const Chain& chain, const Measured& how,
                                               Random& random) {
  std::vector<ChainObservation> all;
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    for (std::size_t t = 0; t < chain.targets_mm.size(); ++t)
      for (int i = 0; i < how.samples; ++i) {
        Turns turns{};
        for (std::size_t k = 0; k < chain.axes.size(); ++k)
          turns[k] = random.normal(10 * how.locked_rad);
        turns[j] = how.from_rad + (how.to_rad - how.from_rad) * i / (how.samples - 1);
        const Eigen::Isometry3d pose = chain.displacement(turns);
        ChainObservation seen;
        seen.position_mm = pose * chain.targets_mm[t] + random.vector(how.position_mm);
        const Eigen::Vector3d off = random.vector(how.orientation_rad);
        seen.orientation = pose.linear() * chain.tool;
        if (off.norm() > 0)
          seen.orientation =
              Eigen::AngleAxisd(off.norm(), off.normalized()).toRotationMatrix() * seen.orientation;
        for (std::size_t k = 0; k < chain.axes.size(); ++k)
          seen.turns[k] = turns[k] + random.normal(k == j ? how.swept_rad : how.locked_rad);
        seen.measured_turn = seen.turns[j];
        seen.joint = j;
        seen.target = t;
        seen.sweep = j * chain.targets_mm.size() + t;
        all.push_back(seen);
      }
  return all;
}

inline ChainNoise noise_of(const Chain& chain, const Measured& how, bool free) {
  return {how.position_mm, how.orientation_rad, how.locked_rad,
          std::vector<double>(chain.axes.size(), free ? kFreeAngle : how.swept_rad)};
}

/// As the samples of a controller or, where their angles are not `told`, of a device alone.
inline std::vector<Sweep> as_sweeps(const std::vector<ChainObservation>& all, std::size_t joints,
                                    bool told = true) {
  std::vector<Sweep> sweeps;
  for (std::size_t i = 0; i < all.size();) {
    const ChainObservation& first = all[i];
    std::vector<Sample> samples;
    for (; i < all.size() && all[i].sweep == first.sweep; ++i) {
      Sample sample;
      sample.time_s = 0.012 * static_cast<double>(samples.size());
      sample.position_mm = all[i].position_mm;
      sample.has_position = sample.has_orientation = true;
      const Eigen::Matrix3d& r = all[i].orientation;
      sample.abc_rad = {std::atan2(r(1, 0), r(0, 0)),
                        std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
                        std::atan2(r(2, 1), r(2, 2))};
      if (told) {
        sample.joints = static_cast<std::uint8_t>(joints);
        sample.angles_rad = all[i].turns;
        sample.angles_rad[first.joint] = all[i].measured_turn;
      }
      samples.push_back(sample);
    }
    Sweep sweep;
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    sweep.joint = first.joint;
    sweep.target = first.target;
    sweep.direction = first.falling ? -1 : 1;
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

/// As the estimator works on them; every joint's home is at zero.
inline ChainNodes nodes_of(const std::vector<ChainObservation>& all, std::size_t joints,
                           bool told = true) {
  std::vector<StrokeMoments> strokes;
  for (const Sweep& sweep : as_sweeps(all, joints, told))
    strokes.push_back(moments_of(sweep, {*sweep.joint, told ? joints : 0, true}).value());
  return identify::nodes_of(std::move(strokes), std::vector<std::optional<double>>(joints, 0.0),
                            std::vector<bool>(joints, true));
}

/// Errors of a fit's axes and targets in the parameters of the true chain.
inline Eigen::VectorXd difference(const Chain& from, const Chain& to) {
  const ChainParameters parameters{from.axes.size(), from.targets_mm.size()};
  Eigen::VectorXd change(parameters.count(true));
  for (std::size_t j = 0; j < from.axes.size(); ++j) {
    const auto basis = across(from.axes[j].direction);
    // The point of the other axis next to this one's.
    const ChainAxis& axis = to.axes[j];
    const Eigen::Vector3d gap = from.axes[j].point_mm - axis.point_mm;
    const Eigen::Vector3d point = axis.point_mm + axis.direction.dot(gap) * axis.direction;
    change.segment<4>(parameters.axis(j))
        << basis.transpose() * (axis.direction - from.axes[j].direction),
        basis.transpose() * (point - from.axes[j].point_mm);
  }
  for (std::size_t t = 0; t < from.targets_mm.size(); ++t)
    change.segment<3>(parameters.target(t)) = to.targets_mm[t] - from.targets_mm[t];
  const Eigen::AngleAxisd turn(to.tool * from.tool.transpose());
  change.tail<3>() = turn.angle() * turn.axis();
  return change;
}

}  // namespace identify::test
