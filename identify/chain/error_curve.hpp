#pragma once

#include <Eigen/Core>

namespace identify {

/// How the errors of a joint's angles go along its turn, by least squares: offset, scale and
/// harmonics of the turn, and half a backlash by the direction. The errors of a stroke may have
/// something in common with no other's, as its locked joints stood elsewhere: random effects. What
/// is seen across the motion tells of them, too, so that errors may have three components.
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
    explicit Stroke(Eigen::Index effects) : effects_(effects) {}
    /// Mean of `samples` alike, with weights of one sample.
    struct Errors {
      Eigen::MatrixXd by_effects;  ///< one row an effect; a column each of the errors below
      Eigen::RowVectorXd by_turn;  ///< what a radian does to them
      Eigen::RowVectorXd mean;
      Eigen::MatrixXd within;  ///< sum of squares about the mean
      Eigen::MatrixXd weight;  ///< inverse of a sample's covariance
    };
    void add(double turn_rad, bool falling, double samples, const Errors& errors);
    /// Of the angle alone, without effects.
    void add(double turn_rad, bool falling, double samples, double error_rad, double within,
             double weight);

   private:
    friend class ErrorCurve;
    Eigen::Index effects_;
    Eigen::MatrixXd rows_, weighted_;
    Eigen::MatrixXd products_ = Eigen::MatrixXd::Zero(size(), size());
    [[nodiscard]] Eigen::Index size() const { return effects_ + Row::SizeAtCompileTime + 1; }
    double samples_ = 0;
    bool rises_ = false, falls_ = false;
  };
  /// `variances`: of the stroke's effects. `level`: of what the joint's own angle is off by all
  /// along a stroke and in no other (rad^2).
  void add(const Stroke& stroke, const Eigen::Ref<const Eigen::VectorXd>& variances,
           double level = 0);

  struct Fit {
    Row coefficients = Row::Zero();
    Row variances = Row::Zero();
    double explained = 0;    ///< sum of squares, weighed
    Eigen::Index terms = 0;  ///< that could be told apart
  };
  /// By the first `count` regressors, and the backlash where there are strokes both ways.
  [[nodiscard]] Fit fit(Eigen::Index count) const;

  /// What a stroke's errors are beside a fit's curve, on the average (rad), and how much that
  /// counts: one by its variance, which the stroke's effects have a part in.
  struct Level {
    double error_rad = 0;
    double weight = 0;
    bool falls = false;
  };
  [[nodiscard]] static Level level_of(const Stroke& stroke,
                                      const Eigen::Ref<const Eigen::VectorXd>& variances,
                                      const Fit& fit);

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
