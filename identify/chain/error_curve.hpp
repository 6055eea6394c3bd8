#pragma once

#include <Eigen/Core>

namespace identify {

/// How the errors of a joint's angles go along its turn, by least squares: offset, scale and
/// harmonics of the turn, and half a backlash by the direction. The errors of a stroke may have
/// something in common with no other's, as its locked joints stood elsewhere: random effects.
class ErrorCurve {
 public:
  static constexpr Eigen::Index kSmooth = 6;  ///< offset, scale, two harmonics
  static constexpr Eigen::Index kHigher = 8;  ///< harmonics three to six
  using Row = Eigen::Matrix<double, kSmooth + kHigher + 1, 1>;
  /// Where the backlash stands.
  static constexpr Eigen::Index kBacklash = kSmooth + kHigher;
  [[nodiscard]] static Row regressors(double turn_rad, bool falling);

  /// The sums of one stroke.
  class Stroke {
   public:
    /// `effects`: how many it has of its own.
    explicit Stroke(Eigen::Index effects);
    /// `by_effects`: what each effect changes the error by. `samples` errors have this mean and
    /// `within`, the sum of squares about it; each has a variance of one over `certainty`.
    void add(double turn_rad, bool falling, const Eigen::VectorXd& by_effects, double error,
             double samples, double within, double certainty);

   private:
    friend class ErrorCurve;
    Eigen::VectorXd row_;
    Eigen::MatrixXd products_;  ///< of (effects, regressors, error)
    double samples_ = 0;
    bool rises_ = false, falls_ = false;
  };
  /// `variances`: of the stroke's effects.
  void add(const Stroke& stroke, const Eigen::VectorXd& variances);

  struct Fit {
    Row coefficients = Row::Zero();
    Row variances = Row::Zero();
    double explained = 0;    ///< sum of squares, weighed
    Eigen::Index terms = 0;  ///< that could be told apart
  };
  /// By the first `count` regressors, and the backlash where there are strokes both ways.
  [[nodiscard]] Fit fit(Eigen::Index count) const;

  /// Of all errors, weighed.
  [[nodiscard]] double squares() const { return squares_; }
  [[nodiscard]] double samples() const { return samples_; }
  [[nodiscard]] bool both_ways() const { return rises_ && falls_; }

 private:
  Eigen::Matrix<double, Row::SizeAtCompileTime, Row::SizeAtCompileTime> normal_ =
      decltype(normal_)::Zero();
  Row right_ = Row::Zero();
  double squares_ = 0;
  double samples_ = 0;
  bool rises_ = false;
  bool falls_ = false;
};

}  // namespace identify
