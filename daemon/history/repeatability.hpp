#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace sweepd {

/// What numbers have in common that scatter from campaign to campaign: a standard deviation each.
/// `expansion`: all lengths grow alike, as with temperature.
enum class Varying { lengths, zeros, twists, expansion };
inline constexpr std::size_t kVaryings = 4;

/// A number, as far as its scatter goes.
struct VaryingNumber {
  Varying kind = Varying::lengths;  ///< not expansion
  double length_mm = 0;             ///< of a length: what grows
};

/// Sums of squares and products of how campaigns of one state differ, and of how many independent
/// ones.
struct Scatter {
  Eigen::MatrixXd products;
  double degrees = 0;
};

/// How campaigns of one state of a robot scatter: what one fit says of itself, and what it cannot
/// know (remounting, temperature).
///
/// The covariance of a campaign is taken for drawn from an inverse Wishart distribution about a
/// structured one: that of a fit, and a variance for each of Varying. How far it may be from the
/// structure, and these variances, are those that make the scatter most likely (restricted
/// likelihood: the states' means are integrated out), with weak priors. Few campaigns thus leave
/// the structure; many take its place. The predictive distribution of one more campaign is
/// Student's t, so that T squared follows F. Campaigns never scatter by much less than a fit says:
/// results of the same data are no proof of repeatability. After Tai and Speed (2006), who have no
/// structure.
class Repeatability {
 public:
  struct Spread {
    /// The scale of Student's t of one campaign about its state.
    Eigen::MatrixXd covariance;
    double degrees = 0;  ///< that it is known with: F's and t's

    /// By how much variances are larger than the scale; 2 at most.
    [[nodiscard]] double widened() const { return degrees > 4 ? degrees / (degrees - 2) : 2; }
  };

  /// `fit`: the covariance of one campaign's fit, the average. mm, rad.
  Repeatability(const Eigen::MatrixXd& fit, const std::vector<VaryingNumber>& numbers,
                Scatter scatter);

  [[nodiscard]] const Spread& spread() const { return spread_; }
  /// The same without one that is in the scatter: `difference` from the mean of the `count`
  /// campaigns of its state, itself among them.
  [[nodiscard]] Spread without(const Eigen::VectorXd& difference, std::size_t count) const;
  /// Standard deviations between campaigns, in the order of Varying: mm, rad, rad, 1.
  [[nodiscard]] const std::array<double, kVaryings>& between() const { return between_; }

 private:
  [[nodiscard]] Spread predicted(const Scatter& scatter) const;

  Scatter scatter_;
  Eigen::MatrixXd fit_root_;  // Cholesky's
  Eigen::MatrixXd prior_;     // the inverse Wishart's matrix
  double prior_degrees_ = 0;
  double structure_variance_ = 0;  // of the logarithm of its size: 2 / degrees
  std::array<double, kVaryings> between_{};
  Spread spread_;
};

}  // namespace sweepd
