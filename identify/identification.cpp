#include "identify/identification.hpp"

#include <algorithm>
#include <utility>

#include "identify/chain_estimator.hpp"
#include "identify/circle_estimator.hpp"

namespace identify {
namespace {

using Eigen::Index;

/// The largest distance between what belongs to the arm: axes where the target passes, and targets.
double size_mm(const Chain& chain, const std::vector<std::optional<Axis>>& axes) {
  std::vector<Eigen::Vector3d> places = chain.targets_mm;
  for (const auto& axis : axes)
    if (axis) places.push_back(axis->point_mm);
  double size = 1;
  for (const auto& a : places)
    for (const auto& b : places) size = std::max(size, (a - b).norm());
  return size;
}

/// The chain's axes as the DH table's Z: turned where the specified table has them so.
std::vector<DhEstimate> dh_of(const ChainEstimate& chain, const Identification& found,
                              const Campaign& campaign) {
  auto z = chain.axes;
  Eigen::MatrixXd covariance = chain.covariance;
  for (std::size_t j = 0; j < z.size(); ++j) {
    if (!z[j] || !campaign.specified || campaign.specified->positive[j] > 0) continue;
    z[j] = z[j]->reversed();
    const auto row = static_cast<Index>(6 * j);
    covariance.middleRows<3>(row) *= -1;
    covariance.middleCols<3>(row) *= -1;
  }
  return extract_dh(z, size_mm(chain.chain, z), found.specified, covariance);
}

}  // namespace

Identification identify(std::vector<Sweep> sweeps, const Campaign& campaign) {
  Identification found = identify_by_circles(std::move(sweeps), campaign);
  found.circle_dh = found.dh;
  found.chain = estimate_chain(found, campaign);
  if (!found.chain) return found;
  found.chain->dh = dh_of(*found.chain, found, campaign);
  if (!found.chain->summary.converged) return found;
  found.estimator = Estimator::chain;
  found.dh = found.chain->dh;
  std::string missing;
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    found.joints[j].axis = found.chain->axes[j];
    if (!found.joints[j].axis) missing += (missing.empty() ? "" : ", ") + std::to_string(j + 1);
  }
  if (found.status != Status::failed || missing.empty())
    found.status = missing.empty() ? Status::complete : Status::partial;
  found.reason = missing.empty() ? "" : "no axis for joint " + missing;
  return found;
}

std::string_view text(Status status) noexcept {
  switch (status) {
    case Status::complete:
      return "complete";
    case Status::partial:
      return "partial";
    case Status::failed:
      return "failed";
  }
  return "";
}

std::string_view text(Estimator estimator) noexcept {
  return estimator == Estimator::chain ? "chain" : "circle";
}

std::string_view text(AngleTrust trust) noexcept {
  switch (trust) {
    case AngleTrust::trusted:
      return "trusted";
    case AngleTrust::smooth:
      return "smooth";
    case AngleTrust::free:
      return "free";
  }
  return "";
}

}  // namespace identify
