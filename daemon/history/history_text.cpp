
#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/drawing/markup.hpp"
#include "daemon/history/history.hpp"
#include "daemon/history/history_words.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/results/change.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/utc.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kMostListed = 12;
constexpr std::size_t kDate = 18;

std::string beginning(const History& history) {
  const auto& campaigns = history.campaigns;
  return history.robot + ": " + rsi::counted(campaigns.size(), "campaign") + " of " +
         (history.describes == "arm" ? "the arm" : "the controller's model") + ", " +
         date_of(history, campaigns.front().record.time) + " to " +
         date_of(history, campaigns.back().record.time);
}

std::string changes(const History& history) {
  std::string out;
  const auto add = [&](const DatedChange& change, const std::string& sentence) {
    out += paragraph("* ", sentence);
    for (const CampaignNote& note : history.notes_near(change))
      if (!note.text.empty())
        out += paragraph("    note of " + date_of(history, note.time) + ": ",
                         rsi::printable(note.text));
  };
  for (const DatedChange& change : history.changes) add(change, change_sentence(history, change));
  if (history.changes.empty()) out += paragraph("", verdict_words(history));
  for (const DatedChange& change : history.friction_changes)
    add(change, friction_sentence(history, change));
  return out;
}

std::string numbers(const History& history) {
  const ComparedCampaign& reference = history.campaigns[history.reference];
  const ComparedCampaign& last = history.campaigns.back();
  std::string out = left("number", 7) + left("unit", 5) + right("reference", 13) +
                    right("last", 13) + right("U", 10) + right("U of fit", 10) +
                    right("smallest", 10) + '\n';
  const int lengths = decimals_of(history, true), angles = decimals_of(history, false);
  for (std::size_t k = 0; k < history.numbers.size(); ++k) {
    const identify::ArmNumber& number = history.numbers[k];
    const auto at = static_cast<Eigen::Index>(k);
    const int decimals = number.length ? lengths : angles;
    const auto cell = [&](double value, std::size_t width) {
      return std::isfinite(value) ? sweepd::number(in_unit(number, value), decimals, width)
                                  : right("-", width);
    };
    out += left(name_of(number), 7) + left(unit_of(number), 5) + cell(reference.values(at), 13) +
           cell(last.values(at), 13) + cell(kCoverage * history.sigma(at), 10) +
           cell(kCoverage * history.fit_sigma(at), 10) + cell(history.smallest(at), 10) + '\n';
  }
  return out;
}

std::string campaign_line(const History& history, const ComparedCampaign& campaign) {
  std::string named;
  for (const std::size_t k : campaign.named)
    named += (named.empty() ? "" : ", ") + name_of(history.numbers[k]);
  const std::string verdict = !campaign.tested    ? "reference"
                              : !campaign.changed ? "-"
                              : named.empty()     ? "changed"
                                                  : "changed: " + named;
  return left(date_of(history, campaign.record.time), kDate) +
         right(fixed(campaign.t_squared, 1), 10) + right(fixed(campaign.p, 4), 9) + "  " +
         left(campaign.record.link ? campaign.record.link->verdict : "-", 10) +
         left(campaign.record.arm->status, 10) + verdict + '\n';
}

std::string last_campaigns(const History& history) {
  std::string out = left("date", kDate) + right("T2", 10) + right("p", 9) + "  " +
                    left("link", 10) + left("status", 10) + "verdict\n";
  const std::size_t from =
      history.campaigns.size() - std::min(history.campaigns.size(), kMostListed);
  for (std::size_t i = from; i < history.campaigns.size(); ++i)
    out += campaign_line(history, history.campaigns[i]);
  return out;
}

std::string friction(const History& history) {
  std::string out;
  for (const FrictionSeries& series : history.friction) {
    double first = kNothing, last = kNothing;
    for (const double value : series.values_a) {
      if (!std::isfinite(value)) continue;
      if (!std::isfinite(first)) first = value;
      last = value;
    }
    out += fmt::format("{}joint {} {} A, first {} A", out.empty() ? "" : "; ", series.joint + 1,
                       fixed(last, 3), fixed(first, 3));
  }
  return out;
}

std::string left_out(const History& history) {
  std::string out;
  for (std::size_t k = 0; k < std::min(history.left_out.size(), kMostListed); ++k)
    out += paragraph("left out      ", history.left_out[k].why_not);
  if (history.left_out.size() > kMostListed)
    out += paragraph("left out      ",
                     "and " + std::to_string(history.left_out.size() - kMostListed) + " more.");
  return out;
}

void append_value(std::string& csv, double value, int decimals) {
  csv += ',';
  if (std::isfinite(value)) append_fixed(csv, value, decimals);
}

/// A name may have a comma or a quote in it, or what a terminal obeys.
std::string csv_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : rsi::printable(text))
    out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

std::string history_text(const History& history) {
  std::string out = beginning(history) + "\n\n" + changes(history) + '\n';
  for (const std::string& message : history.messages) out += paragraph("!  ", message);
  if (!history.messages.empty()) out += '\n';
  out += last_campaigns(history);
  if (history.campaigns.size() > kMostListed)
    out += "The last " + std::to_string(kMostListed) + " of " +
           std::to_string(history.campaigns.size()) + "; --csv has all.\n";
  out += '\n' + numbers(history) + '\n';
  const ComparedCampaign& reference = history.campaigns[history.reference];
  out += paragraph("reference     ",
                   reference.record.name + " of " + date_of(history, reference.record.time) +
                       (history.reference_state.size() > 1
                            ? ", with all " + std::to_string(history.reference_state.size()) +
                                  " campaigns of its state: their mean"
                            : ""));
  out += paragraph("alarms        ", alarms_words(history));
  out += paragraph("repeatability ", repeatability_words(history));
  if (!history.friction.empty()) out += paragraph("friction      ", friction(history) + '.');
  out += paragraph("U             ",
                   "expanded uncertainty of one campaign, k = 2, with the repeatability; of fit: "
                   "what the campaign says of itself");
  out += paragraph("smallest      ",
                   "a change of this number alone that one campaign shows in 80 % of cases");
  // Names and notes are from elsewhere: nothing in them may steer the terminal.
  return clean_text(out + left_out(history));
}

std::string history_csv(const History& history) {
  std::string csv = "time,campaign,status,state,t_squared,degrees_of_freedom,p,changed,named";
  for (const identify::ArmNumber& number : history.numbers) {
    const std::string name = name_of(number), unit = unit_of(number);
    csv += fmt::format(",{0}_{1},{0}_low_{1},{0}_high_{1}", name, unit);
  }
  for (const FrictionSeries& series : history.friction)
    csv += ",friction" + std::to_string(series.joint + 1) + "_a";
  csv += ",link,received,lost,late_replies,latency_p99_9_us,jitter_p99_9_us\n";
  for (std::size_t i = 0; i < history.campaigns.size(); ++i) {
    const ComparedCampaign& campaign = history.campaigns[i];
    std::string named;
    for (const std::size_t k : campaign.named)
      named += (named.empty() ? "" : " ") + name_of(history.numbers[k]);
    csv += utc_text(campaign.record.time) + ',' + csv_quoted(campaign.record.name) + ',' +
           campaign.record.arm->status + ',' + csv_quoted(campaign.state);
    append_value(csv, campaign.tested ? campaign.t_squared : kNothing, 3);
    csv += ',' + std::to_string(campaign.told);
    append_value(csv, campaign.tested ? campaign.p : kNothing, 6);
    csv += campaign.changed ? ",1," : ",0,";
    csv += named;
    for (std::size_t k = 0; k < history.numbers.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const identify::ArmNumber& number = history.numbers[k];
      for (const double bars : {0.0, -identify::kSigmasOf95Percent, identify::kSigmasOf95Percent})
        append_value(csv, in_unit(number, campaign.values(at) + bars * campaign.sigma(at)), 7);
    }
    for (const FrictionSeries& series : history.friction) append_value(csv, series.values_a[i], 4);
    const auto& link = campaign.record.link;
    csv += ',' + (link ? link->verdict : "");
    for (const double count : {link ? link->received : kNothing, link ? link->lost : kNothing,
                               link ? link->late_replies : kNothing})
      append_value(csv, count, 0);
    append_value(csv, link ? link->latency_p99_9_us : kNothing, 1);
    append_value(csv, link ? link->jitter_p99_9_us : kNothing, 1);
    csv += '\n';
  }
  return csv;
}

}  // namespace sweepd
