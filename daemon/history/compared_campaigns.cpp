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

}  // namespace

void compare_campaigns(std::vector<CampaignRecord> records, const std::vector<std::string>& states,
                       std::size_t reference, const HistoryOptions& options, History& history) {
  history.reference = reference;
  set_values(std::move(records), states, history);
  if (history.numbers.empty()) return;
  const Scatter scatter = scatter_of(history);
  const MatrixXd average = average_fit(history);
  const Repeatability repeatability(average, varying(history), scatter);
  history.between = repeatability.between();
  history.degrees = repeatability.spread().degrees;
  const double widened = repeatability.spread().widened();
  history.sigma = (widened * repeatability.spread().covariance.diagonal()).cwiseSqrt();
  history.fit_sigma = average.diagonal().cwiseSqrt();

  const std::string& state = history.campaigns[reference].state;
  for (std::size_t i = 0; i < history.campaigns.size(); ++i)
    if (i == reference ||
        (!state.empty() && history.campaigns[i].state == state && history.campaigns[i].tells_all()))
      history.reference_state.push_back(i);
  const auto members = static_cast<double>(history.reference_state.size());
  VectorXd mean = VectorXd::Zero(history.sigma.size());
  for (const std::size_t i : history.reference_state) mean += history.campaigns[i].values / members;

  CampaignTest test(options.level);
  NumberSeries series;
  std::vector<std::size_t> places_in_time;
  const MatrixXd usual_weight = repeatability.spread().covariance.inverse();
  for (std::size_t i = 0; i < history.campaigns.size(); ++i) {
    ComparedCampaign& campaign = history.campaigns[i];
    const std::vector<Index> places = places_of(campaign.values);
    MatrixXd worse = MatrixXd::Zero(average.rows(), average.cols());
    if (!places.empty())
      worse(places, places) =
          worse_by(campaign.fit_covariance(places, places), average(places, places));
    const MatrixXd covariance = repeatability.spread().covariance + worse;
    campaign.sigma = campaign.fit_sigma = VectorXd::Constant(mean.size(), kNothing);
    campaign.sigma(places) = (widened * covariance.diagonal()).cwiseSqrt()(places);
    campaign.fit_sigma(places) = campaign.fit_covariance.diagonal().cwiseSqrt()(places);
    if (places.empty()) continue;
    const bool member =
        std::count(history.reference_state.begin(), history.reference_state.end(), i) > 0;
    const VectorXd difference = campaign.values - mean;
    if (!member)
      test.test(campaign, difference, covariance + repeatability.spread().covariance / members,
                history.degrees, places);
    else if (members > 1) {  // against the others of its state
      const double others = members / (members - 1);
      const auto spread = repeatability.without(difference, history.reference_state.size());
      test.test(campaign, others * difference, spread.covariance * others + worse, spread.degrees,
                places);
    }
    // Without what is compared with, nothing tells whether the first one since then is other, or
    // those behind it are.
    if (options.since && campaign.record.time < *options.since && !member) continue;
    MatrixXd weight = usual_weight;
    if (!worse.isZero(0) || places.size() < static_cast<std::size_t>(mean.size())) {
      weight.setZero();
      weight(places, places) = MatrixXd(MatrixXd(covariance(places, places)).inverse());
    }
    series.times.push_back(years(campaign.record.time));
    series.values.push_back(campaign.values);
    series.weights.push_back(std::move(weight));
    places_in_time.push_back(i);
  }
  series.degrees = history.degrees;
  if (places_in_time.size() > 2)
    for (DatedChange change : dated_changes(series, options.level)) {
      for (std::size_t* at : {&change.at, &change.earliest, &change.latest})
        *at = places_in_time[*at];
      history.changes.push_back(change);
    }
  const double wider = test.wider_by(static_cast<double>(mean.size()), history.degrees);
  history.t_limit =
      wider * quantile(complement(boost::math::chi_squared(static_cast<double>(mean.size())),
                                  options.level));
  const ChangeTest usual =
      test_change(VectorXd::Zero(mean.size()),
                  wider * (1 + 1 / members) * repeatability.spread().covariance, options.level);
  history.smallest.resize(mean.size());
  for (Index k = 0; k < mean.size(); ++k)
    history.smallest(k) = usual.numbers[static_cast<std::size_t>(k)].smallest;
}

}  // namespace sweepd
