#include "daemon/history/compared_campaigns.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include "daemon/report/file_parts.hpp"
#include "daemon/results/change.hpp"
#include "daemon/results/change_test.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

namespace sweepd {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using identify::ArmNumber;
using identify::ArmNumberKind;

bool same(const ArmNumber& a, const ArmNumber& b) {
  return a.kind == b.kind && a.joint == b.joint && a.length == b.length;
}

std::vector<Index> places_of(const VectorXd& values) {
  std::vector<Index> places;
  for (Index k = 0; k < values.size(); ++k)
    if (!std::isnan(values(k))) places.push_back(k);
  return places;
}

/// The campaigns' numbers in the reference's form.
void set_values(std::vector<CampaignRecord> records, const std::vector<std::string>& states,
                History& history) {
  const ToldArm reference = *records[history.reference].arm;
  const identify::ComparedArms own = identify::compared(reference.arm, reference.arm);
  history.numbers = own.numbers;
  const auto count = static_cast<Index>(own.numbers.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    ComparedCampaign campaign;
    campaign.state = states[i];
    campaign.values = VectorXd::Constant(count, kNothing);
    campaign.fit_covariance = MatrixXd::Zero(count, count);
    const auto pair = i == history.reference ? own : compared(reference, *records[i].arm);
    std::vector<Index> from, to;
    for (std::size_t k = 0; k < pair.numbers.size(); ++k)
      for (Index at = 0; at < count; ++at)
        if (same(pair.numbers[k], own.numbers[static_cast<std::size_t>(at)])) {
          from.push_back(static_cast<Index>(k));
          to.push_back(at);
        }
    for (std::size_t k = 0; k < from.size(); ++k)
      campaign.values(to[k]) = own.first(to[k]) + pair.difference(from[k]);
    campaign.fit_covariance(to, to) = pair.second_covariance(from, from);
    campaign.told = to.size();
    campaign.record = std::move(records[i]);
    history.campaigns.push_back(std::move(campaign));
  }
}

std::vector<VaryingNumber> varying(const History& history) {
  std::vector<VaryingNumber> all;
  const VectorXd& values = history.campaigns[history.reference].values;
  for (std::size_t k = 0; k < history.numbers.size(); ++k) {
    const ArmNumber& number = history.numbers[k];
    if (number.length)
      all.push_back({Varying::lengths,
                     number.kind == ArmNumberKind::zero ? 0 : values(static_cast<Index>(k))});
    else
      all.push_back({number.kind == ArmNumberKind::zero ? Varying::zeros : Varying::twists, 0});
  }
  return all;
}

/// What a campaign's fit is worse by than the average one.
MatrixXd worse_by(const MatrixXd& fit, const MatrixXd& average) {
  const VectorXd sigma = average.diagonal().cwiseSqrt();
  const MatrixXd scaled =
      sigma.cwiseInverse().asDiagonal() * (fit - average) * sigma.cwiseInverse().asDiagonal();
  constexpr double kAlike = 0.1;
  if (scaled.diagonal().maxCoeff() < kAlike) return MatrixXd::Zero(fit.rows(), fit.cols());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solved(scaled);
  const MatrixXd columns = sigma.asDiagonal() * solved.eigenvectors();
  return columns * solved.eigenvalues().cwiseMax(0).asDiagonal() * columns.transpose();
}

/// One campaign against the mean of the reference's state, by F: `covariance` widened so that chi
/// squared and normal limits are those of F at the level.
class CampaignTest {
 public:
  CampaignTest(double level) : level_(level) {}

  void test(ComparedCampaign& campaign, const VectorXd& difference, const MatrixXd& covariance,
            double degrees, const std::vector<Index>& places) {
    const auto count = static_cast<double>(places.size());
    const double wider = wider_by(count, degrees);
    const ChangeTest found = test_change(difference(places), wider * covariance(places, places),
                                         level_, Smallest::left_out);
    campaign.tested = true;
    campaign.t_squared = found.t_squared * wider;
    campaign.p = cdf(complement(boost::math::fisher_f(count, degrees), campaign.t_squared / count));
    campaign.changed = found.changed;
    for (std::size_t k = 0; k < places.size(); ++k)
      if (found.numbers[k].changed) campaign.named.push_back(static_cast<std::size_t>(places[k]));
  }
  double wider_by(double count, double degrees) {
    auto [known, anew] = known_.try_emplace({count, degrees}, 1.0);
    if (anew)
      known->second = count * quantile(complement(boost::math::fisher_f(count, degrees), level_)) /
                      quantile(complement(boost::math::chi_squared(count), level_));
    return known->second;
  }

 private:
  double level_;
  std::map<std::pair<double, double>, double> known_;
};

MatrixXd average_fit(const History& history) {
  const auto count = static_cast<Index>(history.numbers.size());
  MatrixXd sum = MatrixXd::Zero(count, count);
  double campaigns = 0;
  for (const ComparedCampaign& campaign : history.campaigns) {
    const bool counts = !is_marked(history.basis) || !campaign.state.empty();
    if (!counts || !campaign.tells_all()) continue;
    sum += campaign.fit_covariance;
    ++campaigns;
  }
  return sum / campaigns;  // the reference tells all, and is marked where any is
}

/// The campaigns that are of the reference's state, itself among them.
void set_reference_state(History& history) {
  const std::string& state = history.campaigns[history.reference].state;
  for (std::size_t i = 0; i < history.campaigns.size(); ++i)
    if (i == history.reference ||
        (!state.empty() && history.campaigns[i].state == state && history.campaigns[i].tells_all()))
      history.reference_state.push_back(i);
}

/// Compares the campaigns of a history with the mean of the reference's state, one by one in the
/// order of time, and then dates what changed.
class CampaignComparison {
 public:
  CampaignComparison(const Repeatability& repeatability, const MatrixXd& average,
                     const HistoryOptions& options, History& history)
      : repeatability_(repeatability),
        average_(average),
        options_(options),
        history_(history),
        members_(static_cast<double>(history.reference_state.size())),
        mean_(VectorXd::Zero(history.sigma.size())),
        usual_(repeatability.spread().covariance),
        usual_weight_(usual_.inverse()),
        test_(options.level) {
    for (const std::size_t i : history.reference_state)
      mean_ += history.campaigns[i].values / members_;
  }

  void compare(std::size_t at) {
    ComparedCampaign& campaign = history_.campaigns[at];
    const std::vector<Index> places = places_of(campaign.values);
    MatrixXd worse = MatrixXd::Zero(average_.rows(), average_.cols());
    if (!places.empty())
      worse(places, places) =
          worse_by(campaign.fit_covariance(places, places), average_(places, places));
    const MatrixXd covariance = usual_ + worse;
    campaign.sigma = campaign.fit_sigma = VectorXd::Constant(mean_.size(), kNothing);
    campaign.sigma(places) =
        (repeatability_.spread().widened() * covariance.diagonal()).cwiseSqrt()(places);
    campaign.fit_sigma(places) = campaign.fit_covariance.diagonal().cwiseSqrt()(places);
    if (places.empty()) return;
    const bool member =
        std::count(history_.reference_state.begin(), history_.reference_state.end(), at) > 0;
    test(campaign, member, worse, covariance, places);
    // Without what is compared with, nothing tells whether the first one since then is other, or
    // those behind it are.
    if (options_.since && campaign.record.time < *options_.since && !member) return;
    MatrixXd weight = usual_weight_;
    if (!worse.isZero(0) || places.size() < static_cast<std::size_t>(mean_.size())) {
      weight.setZero();
      weight(places, places) = MatrixXd(MatrixXd(covariance(places, places)).inverse());
    }
    series_.times.push_back(years(campaign.record.time));
    series_.values.push_back(campaign.values);
    series_.weights.push_back(std::move(weight));
    places_in_time_.push_back(at);
  }

  void date_changes() {
    series_.degrees = history_.degrees;
    if (places_in_time_.size() <= 2) return;
    for (DatedChange change : dated_changes(series_, options_.level)) {
      for (std::size_t* at : {&change.at, &change.earliest, &change.latest})
        *at = places_in_time_[*at];
      history_.changes.push_back(change);
    }
  }

  /// What a campaign with all numbers would have to show.
  void set_limits() {
    const auto count = static_cast<double>(mean_.size());
    const double wider = test_.wider_by(count, history_.degrees);
    history_.t_limit =
        wider * quantile(complement(boost::math::chi_squared(count), options_.level));
    const ChangeTest usual = test_change(VectorXd::Zero(mean_.size()),
                                         wider * (1 + 1 / members_) * usual_, options_.level);
    history_.smallest.resize(mean_.size());
    for (Index k = 0; k < mean_.size(); ++k)
      history_.smallest(k) = usual.numbers[static_cast<std::size_t>(k)].smallest;
  }

 private:
  /// A member of the reference's state against the others of it, where there are any.
  void test(ComparedCampaign& campaign, bool member, const MatrixXd& worse,
            const MatrixXd& covariance, const std::vector<Index>& places) {
    const VectorXd difference = campaign.values - mean_;
    if (!member) {
      test_.test(campaign, difference, covariance + usual_ / members_, history_.degrees, places);
    } else if (members_ > 1) {
      const double others = members_ / (members_ - 1);
      const auto spread = repeatability_.without(difference, history_.reference_state.size());
      test_.test(campaign, others * difference, spread.covariance * others + worse, spread.degrees,
                 places);
    }
  }

  const Repeatability& repeatability_;
  const MatrixXd& average_;
  const HistoryOptions& options_;
  History& history_;
  double members_;  // of the reference's state
  VectorXd mean_;   // of theirs
  const MatrixXd& usual_;
  MatrixXd usual_weight_;
  CampaignTest test_;
  NumberSeries series_;
  std::vector<std::size_t> places_in_time_;  // in the history, of those in the series
};

}  // namespace

void compare_campaigns(std::vector<CampaignRecord> records, const std::vector<std::string>& states,
                       std::size_t reference, const HistoryOptions& options, History& history) {
  history.reference = reference;
  set_values(std::move(records), states, history);
  if (history.numbers.empty()) return;
  const Scatter scatter = scatter_of(history);
  const MatrixXd average = average_fit(history);
  const Repeatability repeatability(average, varying(history), scatter);
  const Repeatability::Spread& spread = repeatability.spread();
  history.between = repeatability.between();
  history.degrees = spread.degrees;
  history.sigma = (spread.widened() * spread.covariance.diagonal()).cwiseSqrt();
  history.fit_sigma = average.diagonal().cwiseSqrt();
  set_reference_state(history);
  CampaignComparison comparison(repeatability, average, options, history);
  for (std::size_t i = 0; i < history.campaigns.size(); ++i) comparison.compare(i);
  comparison.date_changes();
  comparison.set_limits();
}

}  // namespace sweepd
