#include <algorithm>
#include <cmath>
#include <map>

#include <boost/math/distributions/students_t.hpp>

#include "daemon/history/compared_campaigns.hpp"

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
/// them in one of a thousand histories, and most of it came in one step. A season comes in many.
constexpr double kBeside = 0.5;
constexpr std::size_t kFewestBeside = 3;
constexpr double kJumpByChance = 1e-3;
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

/// How campaigns differ from the one before, and what is usual of each number.
class Steps {
 public:
  explicit Steps(const History& history) {
    for (const ComparedCampaign& campaign : history.campaigns)
      if (campaign.tells_all()) told_.push_back(&campaign);
    const auto count = static_cast<Index>(history.numbers.size());
    usual_ = VectorXd::Zero(count);
    for (Index k = 0; k < count && told_.size() > 1; ++k) {
      std::vector<double> sizes;
      for (std::size_t i = 1; i < told_.size(); ++i) sizes.push_back(std::abs(step(i)(k)));
      const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
      std::nth_element(sizes.begin(), middle, sizes.end());
      usual_(k) = kByMedian * *middle;
    }
    strange_.assign(told_.size(), false);
    for (std::size_t i = 1; i < told_.size(); ++i)
      strange_[i] = (step(i).cwiseAbs().array() > kStrange * usual_.array()).any() || is_jump(i);
  }

  [[nodiscard]] const std::vector<const ComparedCampaign*>& told() const { return told_; }
  [[nodiscard]] VectorXd step(std::size_t to) const {
    return told_[to]->values - told_[to - 1]->values;
  }
  /// Something happened between the two.
  [[nodiscard]] bool strange(std::size_t to) const { return strange_[to]; }

 private:
  /// Student's test of each number, of those before and those after.
  [[nodiscard]] bool is_jump(std::size_t to) const {
    std::size_t from = to, end = to;
    while (from > 0 && age(*told_[from - 1], *told_[to]) < kBeside) --from;
    while (end < told_.size() && age(*told_[to], *told_[end]) < kBeside) ++end;
    if (to - from < kFewestBeside || end - to < kFewestBeside) return false;
    const auto before = static_cast<double>(to - from), after = static_cast<double>(end - to);
    VectorXd means[2] = {VectorXd::Zero(usual_.size()), VectorXd::Zero(usual_.size())};
    for (std::size_t i = from; i < end; ++i)
      means[i < to ? 0 : 1] += told_[i]->values / (i < to ? before : after);
    VectorXd squares = VectorXd::Zero(usual_.size());
    for (std::size_t i = from; i < end; ++i)
      squares += (told_[i]->values - means[i < to ? 0 : 1]).cwiseAbs2();
    const double degrees = before + after - 2;
    const double looked = static_cast<double>(told_.size()) * static_cast<double>(usual_.size());
    const double least =
        quantile(complement(boost::math::students_t(degrees), kJumpByChance / (2 * looked)));
    const Eigen::ArrayXd apart = (means[1] - means[0]).cwiseAbs();
    const Eigen::ArrayXd error = (squares.array() / degrees * (1 / before + 1 / after)).sqrt();
    return (apart > least * error && step(to).cwiseAbs().array() > kInOneStep * apart).any();
  }

  std::vector<const ComparedCampaign*> told_;
  VectorXd usual_;
  std::vector<bool> strange_;
};

/// Of each campaign to the next, but where something happened.
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

/// Of campaigns about the means of their years, without years in which something happened.
Scatter yearly_scatter(const History& history) {
  const Steps steps(history);
  const auto& told = steps.told();
  const auto count = static_cast<Index>(history.numbers.size());
  Scatter scatter{MatrixXd::Zero(count, count), 0};
  for (std::size_t from = 0, to = 0; from < told.size(); from = to) {
    bool strange = false;
    VectorXd mean = VectorXd::Zero(count);
    for (to = from; to < told.size() && age(*told[from], *told[to]) < 1; ++to) {
      strange = strange || (to > from && steps.strange(to));
      mean += told[to]->values;
    }
    const auto members = static_cast<double>(to - from);
    if (strange || age(*told[from], *told[to - 1]) < kMostOfYear) continue;
    mean /= members;
    for (std::size_t i = from; i < to; ++i)
      scatter.products += (told[i]->values - mean) * (told[i]->values - mean).transpose();
    scatter.degrees += members - 1;
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
