#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace sweepd {

/// What numbers did over time.
enum class ChangeKind {
  jump,   ///< other from one campaign on
  drift,  ///< more and more so, evenly in time, from one campaign on
  odd,    ///< one campaign alone is off
};

/// A change of one number, the others as they were.
struct DatedChange {
  ChangeKind kind = ChangeKind::jump;
  std::size_t number = 0;
  /// The first campaign that is other; of a drift the one after which it begins.
  std::size_t at = 0;
  /// Where it may be as well: the campaigns for which the data speak hardly less (95 %).
  std::size_t earliest = 0;
  std::size_t latest = 0;
  double size = 0;   ///< of a drift: a unit of time
  double sigma = 0;  ///< of `size`, taking the date for known
  double p = 1;      ///< of all that was looked for, how likely one like it is by chance
};

/// Numbers of campaigns, in the order of time.
struct NumberSeries {
  std::vector<double> times;             ///< in any unit, rising
  std::vector<Eigen::VectorXd> values;   ///< not a number: not known of that campaign
  std::vector<Eigen::MatrixXd> weights;  ///< inverse covariances; zero where there is no value
  double degrees = 1e6;                  ///< with which these are known: of Student's t
};

/// Steps, ramps and single outliers, found one after the other: the likeliest first, each tested
/// against all that were looked for (Bonferroni), with all others fitted at the same time. What
/// campaigns after each other share, such as a season, is taken off: a change counts by how much
/// sums of successive residuals scatter, not by how they would if campaigns were independent. Of
/// unchanged series no more than `level` have any change, as far as that can be told.
[[nodiscard]] std::vector<DatedChange> dated_changes(const NumberSeries& series, double level);

}  // namespace sweepd
