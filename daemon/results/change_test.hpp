#pragma once

#include <vector>

#include <Eigen/Core>

namespace sweepd {

/// Of unchanged pairs, and of unchanged histories, no more than this share are called changed where
/// nobody asks for another one.
inline constexpr double kUsualLevel = 0.05;
/// Numbers are called changed with this chance where they have: see NumberChange::smallest.
inline constexpr double kPower = 0.8;
/// Of a matrix of correlations: a linearisation tells no closer ones.
inline constexpr double kLeastEigenvalue = 1e-5;

struct NumberChange {
  double sigma = 0;  ///< of the difference
  /// How likely a change this large is where nothing has changed; for all numbers together (Holm),
  /// and not below that of the total test.
  double p = 1;
  bool changed = false;  ///< p is below the level
  /// The size of a change of this number alone that would be called one with a chance of kPower.
  double smallest = 0;
};

/// Whether numbers that were measured twice have changed.
struct ChangeTest {
  double t_squared = 0;  ///< d' C^-1 d; follows chi squared where nothing has changed
  double p = 1;          ///< how likely that, or more, is then
  bool changed = false;  ///< p is below the level
  std::vector<NumberChange> numbers;
  /// The differences of the changed numbers where the others have not changed, zero for these: the
  /// correlations tell more of a few numbers than of all. With its covariance.
  Eigen::VectorXd changes;
  Eigen::MatrixXd changes_covariance;
};

/// Whether `smallest` is worked out: it takes longer than all else, and the differences do not
/// change it.
enum class Smallest { told, left_out };

/// Tests differences with their covariance, in any units. First all of them together (Hotelling's
/// T squared; the covariance is taken for known). Only where that says so, single numbers are
/// called changed (Holm 1979): so of unchanged pairs no more than `level` raise any alarm.
/// `level` is above 0 and below 1.
///
/// Correlations are taken for no closer than a linearisation can tell: eigenvalues of their matrix
/// count as 1e-5 at least.
[[nodiscard]] ChangeTest test_change(const Eigen::VectorXd& difference,
                                     const Eigen::MatrixXd& covariance, double level,
                                     Smallest smallest = Smallest::told);

}  // namespace sweepd
