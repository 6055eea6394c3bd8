#include "daemon/history/history_words.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "daemon/results/change.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

std::string sentence(const History& history, const DatedChange& change, const std::string& name,
                     const std::string& unit, double size, double sigma) {
  const auto signed_told = [&](double value) {
    return (value > 0 ? "+" : "") + told_with(value, sigma);
  };
  const std::string band = signed_told(size) + ' ' + unit +
                           (change.kind == ChangeKind::drift ? " a year" : "") +
                           " (95 %: " + signed_told(size - identify::kSigmasOf95Percent * sigma) +
                           " to " + signed_told(size + identify::kSigmasOf95Percent * sigma) + ") ";
  switch (change.kind) {
    case ChangeKind::jump:
      return name + " jumped by " + band + when(history, change) + '.';
    case ChangeKind::drift:
      return name + " drifts by " + band + when(history, change) + '.';
    case ChangeKind::odd:
      break;
  }
  const bool last = change.at + 1 == history.campaigns.size();
  return name + " is off by " + band + when(history, change) +
         (last ? ", the last campaign so far." : ", in that campaign alone.");
}

}  // namespace

std::string date_of(std::chrono::nanoseconds time) {
  return utc_text(time).substr(0, 10);
}

std::string date_of(const History& history, std::chrono::nanoseconds time) {
  const auto& campaigns = history.campaigns;
  const bool same_day =
      std::adjacent_find(campaigns.begin(), campaigns.end(), [](const auto& a, const auto& b) {
        return date_of(a.record.time) == date_of(b.record.time);
      }) != campaigns.end();
  return same_day ? date_of(time) + ' ' + utc_text(time).substr(11, 5) : date_of(time);
}

int decimals_of(const History& history, bool lengths) {
  double least = 1;
  for (std::size_t k = 0; k < history.numbers.size(); ++k)
    if (history.numbers[k].length == lengths)
      least = std::min(least, kCoverage * in_unit(history.numbers[k],
                                                  history.fit_sigma(static_cast<Eigen::Index>(k))));
  return decimals_for(least, kFewestOfChange, kMostOfChange);
}

std::string told_with(double value, double sigma) {
  return fixed(value, sigma > 0 ? decimals_for(kCoverage * sigma, 0, kMostOfChange) : 4);
}

std::string when(const History& history, const DatedChange& change) {
  const auto date = [&](std::size_t at) {
    return date_of(history, history.campaigns[at].record.time);
  };
  if (change.kind == ChangeKind::odd) return "on " + date(change.at);
  if (change.kind == ChangeKind::drift)
    return "since " + date(change.at) +
           (change.earliest < change.latest
                ? " (or from " + date(change.earliest) + " to " + date(change.latest) + ")"
                : "");
  return "between " + date(change.earliest > 0 ? change.earliest - 1 : 0) + " and " +
         date(change.latest);
}

std::string change_sentence(const History& history, const DatedChange& change) {
  const identify::ArmNumber& number = history.numbers[change.number];
  return sentence(history, change, name_of(number), unit_of(number), in_unit(number, change.size),
                  in_unit(number, change.sigma));
}

std::string friction_sentence(const History& history, const DatedChange& change) {
  return sentence(history, change,
                  "friction of joint " + std::to_string(history.friction[change.number].joint + 1),
                  "A", change.size, change.sigma);
}

std::string verdict_words(const History& history) {
  std::string text;
  for (const DatedChange& change : history.changes)
    text += (text.empty() ? "" : " ") + change_sentence(history, change);
  if (!text.empty()) return text;
  return history.campaigns.size() < 3 ? "There are too few campaigns to date a change."
                                      : "No change is seen that can be dated.";
}

std::string alarms_words(const History& history) {
  std::size_t tested = 0, alarms = 0;
  for (const ComparedCampaign& campaign : history.campaigns) {
    tested += campaign.tested;
    alarms += campaign.changed;
  }
  return fmt::format("{} of {} called changed; {:.3g} % of unchanged ones would be.", alarms,
                     rsi::counted(tested, "campaign"), 100 * history.level);
}

std::string repeatability_words(const History& history) {
  const auto& between = history.between;
  const std::string sizes = fmt::format(
      "lengths {:.2g} mm, zeros {:.2g} deg, twists {:.2g} deg, all lengths together "
      "{:.2g} ppm; ",
      between[0], degrees(between[1]), degrees(between[2]), 1e6 * between[3]);
  switch (history.basis) {
    case Basis::marked:
      return sizes + fmt::format(
                         "from {} that are marked as the same state, which tell it with "
                         "{:.0f} degrees of freedom.",
                         rsi::counted(history.basis_campaigns, "campaign"), history.degrees);
    case Basis::marked_and_years:
      return sizes +
             fmt::format(
                 "from {} that are marked as the same state, and from all years without their "
                 "jumps, as the marked ones are of one season. A slow drift is in it: mark "
                 "campaigns of all seasons.",
                 rsi::counted(history.basis_campaigns, "campaign"));
    case Basis::years:
      return sizes +
             "from all years without their jumps, as none are marked as the same state. A slow "
             "drift is in it: mark campaigns with `sweepd note DIR --same-state NAME`, or give "
             "--same-state.";
    case Basis::successive:
      return sizes +
             "from what differs from one campaign to the next, as none are marked as the same "
             "state. Slow cycles, as that of the seasons, are not in it and count as changes: mark "
             "campaigns with `sweepd note DIR --same-state NAME`, or give --same-state.";
    case Basis::nothing:
      break;
  }
  return sizes +
         "assumed, as no campaigns are marked as the same state and there are too few to compare "
         "each with the next. What remounting and temperature do is not known: alarms may be "
         "false, and only large changes are seen. `sweepd compare` tells of two campaigns.";
}

}  // namespace sweepd
