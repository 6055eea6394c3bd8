#include "daemon/history/friction_series.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "daemon/history/history.hpp"
#include "daemon/report/file_parts.hpp"
#include "identify/geometry/median.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kFewest = 6;
constexpr double kLeast_a = 1e-4;  // as files print it

/// Of one campaign, by what differs to the next one: what is slow or happens once is not in it.
double successive_sigma(const std::vector<double>& values) {
  std::vector<double> differences;
  double before = kNothing;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (std::isfinite(before)) differences.push_back(std::abs(value - before));
    before = value;
  }
  if (differences.empty()) return kLeast_a;
  return std::max(kLeast_a, kByMedian / std::sqrt(2) * identify::median_of(differences));
}

}  // namespace

void find_friction(History& history) {
  std::map<std::size_t, FrictionSeries> joints;
  for (std::size_t i = 0; i < history.campaigns.size(); ++i)
    for (const JointFriction& one : history.campaigns[i].record.friction) {
      FrictionSeries& series = joints[one.joint];
      series.joint = one.joint;
      series.values_a.resize(history.campaigns.size(), kNothing);
      series.values_a[i] = one.friction_a;
    }
  for (auto& [joint, series] : joints) history.friction.push_back(std::move(series));
  for (std::size_t k = 0; k < history.friction.size(); ++k) {
    const auto& values = history.friction[k].values_a;
    NumberSeries series;
    std::vector<std::size_t> places;
    const double weight = 1 / std::pow(successive_sigma(values), 2);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      places.push_back(i);
      series.times.push_back(years(history.campaigns[i].record.time));
      series.values.push_back(Eigen::VectorXd::Constant(1, values[i]));
      series.weights.push_back(Eigen::MatrixXd::Constant(1, 1, weight));
    }
    if (places.size() < kFewest) continue;
    // A median of differences tells a scatter about a third as well as its degrees.
    series.degrees = std::max(3.0, static_cast<double>(places.size()) / 3);
    for (DatedChange change :
         dated_changes(series, history.level / static_cast<double>(history.friction.size()))) {
      change.number = k;
      for (std::size_t* at : {&change.at, &change.earliest, &change.latest}) *at = places[*at];
      history.friction_changes.push_back(change);
    }
  }
}

}  // namespace sweepd
