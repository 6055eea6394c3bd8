#include "identify/given_axes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/chain/chain_table.hpp"
#include "identify/dh/base_height.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/height_advice.hpp"
#include "identify/identification.hpp"
#include "identify/specified_fit.hpp"

namespace identify {
namespace {

using Axes = std::vector<std::optional<Axis>>;

/// The largest distance between the given points and the feet of common normals. Feet of axes that
/// are nearly parallel lie anywhere and say nothing about size.
double size_mm(const std::vector<Axis>& axes) {
  const double kNearlyParallel = 1 * kDegree;
  std::vector<Eigen::Vector3d> places;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    places.push_back(axes[j].point_mm);
    if (j == 0) continue;
    const auto pair = relate(axes[j - 1].line(), axes[j].line());
    if (pair.sine < kNearlyParallel) continue;
    places.push_back(pair.first_foot_mm);
    places.push_back(pair.second_foot_mm);
  }
  return largest_distance_mm(places);
}

/// How far a table is from the specified one. Turning an axis round may change nothing but thetas:
/// then these decide, though the pose may have been another.
/// `known` has the same rows, with what is known of them.
double misfit(const std::vector<DhEstimate>& dh, const std::vector<DhEstimate>& known,
              const std::vector<DhRow>& specified, double size) {
  constexpr double kThetaWeight = 1e-3;
  double sum = 0;
  const auto add = [&](const DhNumber& number, double difference, double weight) {
    if (number.knowledge == Knowledge::identified) sum += weight * std::abs(difference);
  };
  for (std::size_t j = 0; j < dh.size(); ++j) {
    add(known[j].b_mm, dh[j].b_mm.value - specified[j].b_mm, 1 / size);
    add(known[j].a_mm, dh[j].a_mm.value - specified[j].a_mm, 1 / size);
    add(known[j].alpha_rad, wrapped(dh[j].alpha_rad.value - specified[j].alpha_rad), 1);
    add(known[j].theta_rad, wrapped(dh[j].theta_rad.value - specified[j].theta_rad), kThetaWeight);
  }
  return sum;
}

/// In a device's frame, where the base stands is nobody's number.
std::vector<DhEstimate> table_of(Axes axes, const Identification& found, double size,
                                 const Campaign& campaign) {
  const bool device = campaign.device_frame && !axes.empty();
  if (device) axes = seen_from_base(std::move(axes), size, found.specified);
  auto table = extract_dh(axes, size, found.specified);
  if (!device) return table;
  leave_first_to_frame(table, found.specified);
  leave_to_height(table, axes, size, found.specified);
  return table;
}

/// The axes, each turned as agrees best with the specified table; of equals the first.
Axes agreeing(const Axes& axes, const Identification& found, double size,
              const Campaign& campaign) {
  constexpr double kEqual = 1e-9;
  const auto known = table_of(axes, found, size, campaign);
  Axes best;
  double least = 0;
  for (std::size_t flips = 0; flips < std::size_t{1} << axes.size(); ++flips) {
    Axes tried = axes;
    for (std::size_t j = 0; j < axes.size(); ++j)
      if ((flips >> j & 1) != 0) tried[j] = tried[j]->reversed();
    const double sum =
        misfit(extract_dh(tried, size, found.specified), known, found.specified, size);
    if (!best.empty() && sum >= least - kEqual) continue;
    least = sum;
    best = std::move(tried);
  }
  return best;
}

}  // namespace

Identification identify_given_axes(const std::vector<Axis>& axes, const Campaign& campaign) {
  Identification found;
  found.status = Status::complete;
  found.estimator = Estimator::axes;
  found.home_rad.resize(axes.size());
  if (campaign.declared_home_rad.size() == axes.size())
    found.home_rad.assign(campaign.declared_home_rad.begin(), campaign.declared_home_rad.end());

  const double size = size_mm(axes);
  Axes z(axes.begin(), axes.end());
  if (campaign.specified) {
    found.specified = campaign.specified->rows;
    for (std::size_t j = 0; j < axes.size(); ++j) {
      if (!found.home_rad[j]) continue;
      found.specified[j] = specified_row(*campaign.specified, j, *found.home_rad[j]);
    }
    z = agreeing(z, found, size, campaign);
  }
  found.dh = table_of(z, found, size, campaign);
  found.joints.resize(axes.size());
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const bool turned = campaign.specified && campaign.specified->positive[j] < 0;
    found.joints[j].axis = turned ? z[j]->reversed() : z[j];
  }
  for (Warning& warning : advice_on_height(found, extract_dh(z, size, found.specified), campaign))
    found.warnings.push_back(std::move(warning));
  if (std::all_of(axes.begin(), axes.end(),
                  [](const Axis& axis) { return axis.covariance.isZero(0); }))
    found.warnings.push_back(
        {"no_uncertainties",
         {},
         "the axes came without uncertainties, so the table has none: it shows what differs, and "
         "not whether that is more than chance. Give how well each axis is known"});
  name_undetermined(found);
  if (auto contradiction = contradiction_of_specified(found, campaign))
    found.doubts.push_back(std::move(*contradiction));
  apply_doubts(found);
  return found;
}

}  // namespace identify
