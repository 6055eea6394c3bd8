#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "daemon/history/campaign_folders.hpp"
#include "daemon/history/dated_change.hpp"
#include "daemon/history/repeatability.hpp"
#include "daemon/results/change_test.hpp"
#include "identify/change/compared_arms.hpp"

namespace sweepd {

struct HistoryOptions {
  std::optional<std::chrono::nanoseconds> since;  ///< earlier ones only as reference or marked
  double level = kUsualLevel;
  std::optional<std::filesystem::path> reference;  ///< one of the campaigns; nothing: chosen
  /// All campaigns from the one to the other are of one state.
  std::optional<std::pair<std::chrono::nanoseconds, std::chrono::nanoseconds>> same_state;
  std::string describes;  ///< controller_model or arm; empty: arm where there is any
};

/// A campaign beside the reference. Numbers are mm and rad, in the order of History::numbers; not a
/// number where the campaign does not tell it.
struct ComparedCampaign {
  CampaignRecord record;
  std::string state;  ///< that it is marked as being of; empty: none
  Eigen::VectorXd values;
  Eigen::VectorXd sigma;      ///< with the repeatability between campaigns
  Eigen::VectorXd fit_sigma;  ///< by the campaign itself
  Eigen::MatrixXd fit_covariance;
  bool tested = false;   ///< not of a reference that stands alone
  std::size_t told = 0;  ///< how many numbers are compared
  double t_squared = 0;
  double p = 1;  ///< by F, see Repeatability
  bool changed = false;
  std::vector<std::size_t> named;  ///< numbers that are called changed

  [[nodiscard]] bool tells_all() const { return !values.array().isNaN().any(); }
};

/// What the repeatability between campaigns is known from.
enum class Basis {
  marked,            ///< campaigns that are marked as of one state
  marked_and_years,  ///< these are of one season: how campaigns of a year scatter, too
  years,             ///< none is marked: how campaigns of a year scatter
  successive,        ///< none of them fills a year: what differs from one campaign to the next
  nothing,           ///< too few for that: an assumption
};
[[nodiscard]] constexpr bool is_marked(Basis basis) {
  return basis == Basis::marked || basis == Basis::marked_and_years;
}

/// A friction or another plain number of each campaign.
struct FrictionSeries {
  std::size_t joint = 0;
  std::vector<double> values_a;  ///< one a campaign; not a number where there is none
};

struct History {
  std::string robot;
  std::string describes;
  double level = 0;
  std::vector<ComparedCampaign> campaigns;  ///< by time
  std::vector<CampaignRecord> left_out;     ///< why_not says why
  std::size_t reference = 0;
  std::vector<std::size_t> reference_state;  ///< whose mean is compared with, the reference too

  std::vector<identify::ArmNumber> numbers;
  Eigen::VectorXd smallest;   ///< change of one number alone that one campaign shows in 80 %
  Eigen::VectorXd sigma;      ///< of one campaign, with the repeatability
  Eigen::VectorXd fit_sigma;  ///< without
  Basis basis = Basis::nothing;
  std::size_t basis_campaigns = 0;  ///< that are marked, from which the repeatability is known
  std::array<double, kVaryings> between{};
  double degrees = 0;
  double t_limit = 0;  ///< T squared of a campaign with all numbers that is called changed

  std::vector<DatedChange> changes;  ///< `at` and so on are places in `campaigns`; a year's drift
  std::vector<FrictionSeries> friction;
  std::vector<DatedChange> friction_changes;                ///< `number` is a place in `friction`
  std::vector<std::pair<std::string, CampaignNote>> notes;  ///< by time; of which campaign, if one
  std::vector<std::string> messages;

  /// Notes from shortly before the campaign before the change to the one after it.
  [[nodiscard]] std::vector<CampaignNote> notes_near(const DatedChange& change) const;
};

inline constexpr double kYear_s = 365.25 * 86400;
[[nodiscard]] double years(std::chrono::nanoseconds time);

/// Throws std::runtime_error where there is nothing that can be told.
[[nodiscard]] History history_of(FoundCampaigns found, const HistoryOptions& options);

}  // namespace sweepd
