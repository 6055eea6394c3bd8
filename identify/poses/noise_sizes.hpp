#pragma once

#include <vector>

#include <Eigen/Core>

#include "identify/poses/pose_fit.hpp"
#include "identify/poses/pose_stands.hpp"

namespace identify {

/// What a fit's step leaves shows of the size of each component of the noise (PoseFit).
class NoiseSizes {
 public:
  /// `stands`: those that count. `step`: the fit's next one, with the covariance of the parameters
  /// that belongs to it in `fit`.
  NoiseSizes(const PoseFit& fit, const std::vector<StandRows>& stands, const Eigen::VectorXd& step);

  /// Gears of all joints can take up all that a few poses leave. The noise is not none for that:
  /// what there was of it `before`, without them, counts as four more degrees of freedom.
  void hold(const PoseNoise& before);

  /// The fit's noise, its variances times what is seen over what is expected.
  [[nodiscard]] PoseNoise next() const;
  /// Of the variance that joints and positions make up, the joints'.
  [[nodiscard]] double joint_share() const;

 private:
  struct Sized {
    double seen = 0;
    double expected = 0;
    [[nodiscard]] double times() const;
    void hold(double now, double before);
  };
  void add_stand(const StandRows& stand, const Eigen::MatrixXd& covariance,
                 const Eigen::VectorXd& step);
  void add_effects(const PoseFit& fit, const Eigen::VectorXd& step);

  PoseNoise now_;
  Sized position_, orientation_, joints_, gears_, weights_, play_;
};

}  // namespace identify
