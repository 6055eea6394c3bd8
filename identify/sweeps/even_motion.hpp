#pragma once

#include <Eigen/Core>

namespace identify {

/// A motion without its wobble and the noise with which it was seen: the values at each time of
/// lines through the samples next to it, by least squares. Fewer than nine stay as they are. Times
/// in s, values in any unit.
class EvenMotion {
 public:
  explicit EvenMotion(const Eigen::ArrayXd& times);
  /// `seen`: one a time.
  [[nodiscard]] Eigen::ArrayXd operator()(const Eigen::ArrayXd& seen) const;
  /// What of noise with a standard deviation of one is left in the values, but for both ends'.
  [[nodiscard]] double noise() const;

 private:
  static constexpr Eigen::Index kWide = 9;
  using Line = Eigen::Array<double, kWide, 1>;
  [[nodiscard]] Eigen::Index begin(Eigen::Index sample) const;

  Eigen::Array<double, kWide, Eigen::Dynamic> shares_;  ///< of each in a line's value, by column
};

/// Variance of what numbers scatter by from one to the next about an even motion. Of a motion that
/// gets to speed, rests, or lacks a sample now and then, where it is most even. In the square of
/// the numbers' unit.
[[nodiscard]] double unevenness(const Eigen::ArrayXd& numbers);

}  // namespace identify
