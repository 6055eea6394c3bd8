#include <algorithm>
#include <cmath>
#include <map>

#include <boost/math/distributions/students_t.hpp>

#include "daemon/history/compared_campaigns.hpp"
#include "identify/geometry/spread.hpp"

namespace sweepd {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Fewer tell nothing of how they scatter.
constexpr std::size_t kFewestSuccessive = 6;
/// Of what one campaign differs from the next, in its usual size: more is a change.
constexpr double kStrange = 6;
/// In years: campaigns over so long have met all seasons.
constexpr double kMostOfYear = 0.7;
/// A jump: campaigns of half a year before and after a place lie apart by as much as chance has
/// them in one of a hundred histories, and most of it came in one step. A season comes in many.
/// How campaigns repeat is told without it.
constexpr double kBeside = 0.5;
constexpr std::size_t kFewestBeside = 3;
constexpr double kJumpByChance = 0.01;
constexpr double kInOneStep = 0.6;

/// Years from one to the other.
double age(const ComparedCampaign& from, const ComparedCampaign& to) {
  return years(to.record.time) - years(from.record.time);
}

/// Of campaigns about the means of their states. `longest`: years of the longest state.
Scatter marked_scatter(const History& history, std::size_t& campaigns, double& longest) {
  std::map<std::string, std::vector<const ComparedCampaign*>> states;
  for (const ComparedCampaign& campaign : history.campaigns)
    if (!campaign.state.empty() && campaign.tells_all())
      states[campaign.state].push_back(&campaign);
  const auto count = static_cast<Index>(history.numbers.size());
  Scatter scatter{MatrixXd::Zero(count, count), 0};
  for (const auto& [state, members] : states) {
    if (members.size() < 2) continue;
    VectorXd mean = VectorXd::Zero(count);
    for (const auto* member : members) mean += member->values / static_cast<double>(members.size());
    for (const auto* member : members)
      scatter.products += (member->values - mean) * (member->values - mean).transpose();
    scatter.degrees += static_cast<double>(members.size()) - 1;
    campaigns += members.size();
    longest = std::max(longest, age(*members.front(), *members.back()));
  }
  return scatter;
}

/// How campaigns differ from the one before when jumps are taken out, and what is usual of each
/// number.
class Steps {
 public:
  explicit Steps(const History& history) {
    for (const ComparedCampaign& campaign : history.campaigns)
      if (campaign.tells_all()) {
        told_.push_back(&campaign);
        values_.push_back(campaign.values);
      }
    const auto count = static_cast<Index>(history.numbers.size());
    for (std::size_t i = 0; i < told_.size(); ++i) {
      const VectorXd jump = jump_at(i, count);
      jumps_.push_back(!jump.isZero(0));
      for (std::size_t k = i; k < told_.size(); ++k) values_[k] -= jump;
    }
    usual_ = VectorXd::Zero(count);
    for (Index k = 0; k < count && told_.size() > 1; ++k) {
      std::vector<double> sizes;
      for (std::size_t i = 1; i < told_.size(); ++i) sizes.push_back(std::abs(step(i)(k)));
      const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
      std::nth_element(sizes.begin(), middle, sizes.end());
      usual_(k) = identify::kSigmaByMedian * *middle;
    }
  }

  [[nodiscard]] const std::vector<const ComparedCampaign*>& told() const { return told_; }
  /// Of one of them, as if nothing had jumped.
  [[nodiscard]] const VectorXd& values(std::size_t at) const { return values_[at]; }
  [[nodiscard]] bool jumped(std::size_t to) const { return jumps_[to]; }
  [[nodiscard]] VectorXd step(std::size_t to) const { return values_[to] - values_[to - 1]; }
  /// So large that something happened between the two.
  [[nodiscard]] bool strange(std::size_t to) const {
    return (step(to).cwiseAbs().array() > kStrange * usual_.array()).any();
  }

 private:
  /// Of numbers that jump, by how much; of others nothing. Student's test of each, of those before
  /// and those after.
  [[nodiscard]] VectorXd jump_at(std::size_t to, Index count) const {
    std::size_t from = to, end = to;
    while (from > 0 && age(*told_[from - 1], *told_[to]) < kBeside) --from;
    while (end < told_.size() && age(*told_[to], *told_[end]) < kBeside) ++end;
    // Of the last ones nobody knows yet what follows. They must not hide what they show.
    const bool latest = end == told_.size();
    if (to - from < kFewestBeside || (end - to < kFewestBeside && !latest))
      return VectorXd::Zero(count);
    const auto before = static_cast<double>(to - from), after = static_cast<double>(end - to);
    VectorXd means[2] = {VectorXd::Zero(count), VectorXd::Zero(count)};
    for (std::size_t i = from; i < end; ++i)
      means[i < to ? 0 : 1] += values_[i] / (i < to ? before : after);
    Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(count);
    for (std::size_t i = from; i < end; ++i)
      squares += (values_[i] - means[i < to ? 0 : 1]).array().square();
    const double degrees = before + after - 2;
    const double looked = static_cast<double>(told_.size()) * static_cast<double>(count);
    const double least =
        quantile(complement(boost::math::students_t(degrees), kJumpByChance / (2 * looked)));
    const Eigen::ArrayXd apart = means[1] - means[0];
    const Eigen::ArrayXd error = (squares / degrees * (1 / before + 1 / after)).sqrt();
    const Eigen::ArrayXd in_one_step = step(to).cwiseAbs();
    return (apart.abs() > least * error && in_one_step > kInOneStep * apart.abs())
        .select(apart, 0.0);
  }

  std::vector<const ComparedCampaign*> told_;
  std::vector<VectorXd> values_;
  std::vector<bool> jumps_;  ///< before each
  VectorXd usual_;
};

/// Of each campaign to the next, but where one differs far more than usual.
Scatter successive_scatter(const History& history) {
  const Steps steps(history);
  const auto count = static_cast<Index>(history.numbers.size());
  Scatter scatter{MatrixXd::Zero(count, count), 0};
  if (steps.told().size() < kFewestSuccessive) return scatter;
  for (std::size_t i = 1; i < steps.told().size(); ++i) {
    if (steps.strange(i)) continue;
    // Successive differences share campaigns: of their variance two thirds as much is known.
    scatter.products += 2.0 / 3 * steps.step(i) * steps.step(i).transpose() / 2;
    scatter.degrees += 2.0 / 3;
  }
  return scatter;
}

/// Of campaigns about the means of their years, without years in which one differs far more than
/// usual from the one before.
Scatter yearly_scatter(const History& history) {
  const Steps steps(history);
  const auto& told = steps.told();
  const auto count = static_cast<Index>(history.numbers.size());
  Scatter scatter{MatrixXd::Zero(count, count), 0};
  for (std::size_t from = 0, to = 0; from < told.size(); from = to) {
    bool strange = false;
    double jumps = 0;
    VectorXd mean = VectorXd::Zero(count);
    for (to = from; to < told.size() && age(*told[from], *told[to]) < 1; ++to) {
      strange = strange || (to > from && steps.strange(to));
      if (to > from && steps.jumped(to)) ++jumps;
      mean += steps.values(to);
    }
    const auto members = static_cast<double>(to - from);
    if (strange || age(*told[from], *told[to - 1]) < kMostOfYear) continue;
    mean /= members;
    for (std::size_t i = from; i < to; ++i)
      scatter.products += (steps.values(i) - mean) * (steps.values(i) - mean).transpose();
    scatter.degrees += members - 1 - jumps;
  }
  return scatter;
}

}  // namespace

Scatter scatter_of(History& history) {
  history.basis_campaigns = 0;
  double longest = 0;
  Scatter scatter = marked_scatter(history, history.basis_campaigns, longest);
  history.basis = Basis::marked;
  if (scatter.degrees > 0) {
    if (longest >= kMostOfYear) return scatter;
    // Marks of one season do not tell what the others do. What years have in them does.
    const Scatter of_years = yearly_scatter(history);
    if (!(of_years.degrees > 0)) return scatter;
    scatter.products += of_years.products;
    scatter.degrees += of_years.degrees;
    history.basis = Basis::marked_and_years;
    return scatter;
  }
  scatter = yearly_scatter(history);
  history.basis = Basis::years;
  if (scatter.degrees > 0) return scatter;
  scatter = successive_scatter(history);
  history.basis = scatter.degrees > 0 ? Basis::successive : Basis::nothing;
  return scatter;
}

}  // namespace sweepd
