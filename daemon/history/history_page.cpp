
#include <algorithm>
#include <cmath>
#include <functional>

#include <pugixml.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/history/history.hpp"
#include "daemon/history/history_words.hpp"
#include "daemon/history/time_axis.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/report/html_report.hpp"
#include "daemon/results/change.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/models/kinematic_model.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

constexpr double kPageWidth = 740, kLeft = 52, kBelow = 22;
constexpr std::size_t kAcross = 3;
constexpr double kSmallWidth = kPageWidth / kAcross, kSmallHeight = 96, kAboveSmall = 20,
                 kSmallLeft = 48;

using TimePoints = std::vector<std::pair<double, double>>;

Range time_range(const History& history) {
  Range range = Range::nothing();
  for (const ComparedCampaign& campaign : history.campaigns)
    range.include(years(campaign.record.time));
  constexpr double kDay = 86400 / kYear_s;  // what is closer is of one day
  if (range.size() < kDay) return {range.low - kDay / 2, range.high + kDay / 2};
  return range.widened(0.02);
}

double at_time(const History& history, std::size_t campaign) {
  return years(history.campaigns[campaign].record.time);
}

void mark_notes(const History& history, Plot& plot) {
  for (const auto& [campaign, note] : history.notes)
    if (!note.text.empty()) plot.mark(years(note.time), joint_line(4));
}

void add_changes(Markup body, const History& history) {
  if (history.changes.empty() && history.friction_changes.empty()) return;
  body.put("h2", "What has changed");
  auto list = body.add("ul");
  const auto add = [&](const DatedChange& change, const std::string& sentence) {
    auto item = list.add("li");
    item.text(sentence);
    for (const CampaignNote& note : history.notes_near(change))
      if (!note.text.empty())
        item.put("p", "Note of " + date_of(history, note.time) + ": " + note.text,
                 {{"class", "note"}});
  };
  for (const DatedChange& change : history.changes) add(change, change_sentence(history, change));
  for (const DatedChange& change : history.friction_changes)
    add(change, friction_sentence(history, change));
}

void add_totals(Markup body, const History& history) {
  constexpr double kHeight = 190;
  auto figure =
      add_figure(body, "All numbers together",
                 "of each campaign against the reference: T², with the repeatability "
                 "between campaigns. Above the dashed line a campaign is called changed. " +
                     alarms_words(history) + " Upright lines are notes.");
  Picture picture(figure, kPageWidth, kHeight + kBelow + 10, "T squared over time");
  Range y = Range::nothing();
  TimePoints unchanged, changed;
  const double floor = history.t_limit / 100;
  for (const ComparedCampaign& campaign : history.campaigns) {
    if (!campaign.tested) continue;
    const double value = std::log10(std::max(floor, campaign.t_squared));
    (campaign.changed ? changed : unchanged).emplace_back(years(campaign.record.time), value);
    y.include(value);
  }
  y.include(std::log10(history.t_limit));
  Plot plot =
      plot_over_time(picture, {kLeft, 8, kPageWidth - kLeft - 10, kHeight}, time_range(history),
                     {.range = y.widened(0.06), .title = "T²", .logarithmic = true}, 8);
  mark_notes(history, plot);
  plot.level(std::log10(history.t_limit), "limit");
  plot.dots(unchanged, joint_dots(0));
  plot.dots(changed, joint_dots(1));
}

/// What the dated changes make of one number, from the mean of the first to the last campaign.
TimePoints modelled(const History& history, std::size_t number,
                    const std::vector<DatedChange>& changes,
                    const std::function<double(std::size_t)>& value) {
  const auto by = [&](std::size_t i) {
    double sum = 0;
    for (const DatedChange& change : changes) {
      if (change.number != number || i < change.at) continue;
      if (change.kind == ChangeKind::odd && i != change.at) continue;
      sum += change.kind == ChangeKind::drift
                 ? change.size * (at_time(history, i) - at_time(history, change.at))
                 : change.size;
    }
    return sum;
  };
  double mean = 0, count = 0;
  for (std::size_t i = 0; i < history.campaigns.size(); ++i) {
    if (!std::isfinite(value(i))) continue;
    mean += value(i) - by(i);
    ++count;
  }
  TimePoints line;
  for (std::size_t i = 0; i < history.campaigns.size() && count > 0; ++i) {
    if (i > 0 && by(i) != by(i - 1))  // a jump is upright
      for (const DatedChange& change : changes)
        if (change.number == number && change.at == i && change.kind == ChangeKind::jump)
          line.emplace_back(at_time(history, i), line.back().second);
    line.emplace_back(at_time(history, i), mean / count + by(i));
  }
  return line;
}

struct SmallPlot {
  std::string title, unit;
  std::size_t number = 0;
  std::function<double(std::size_t)> value, bar;  ///< of a campaign, in the unit
  std::vector<DatedChange> changes;               ///< in the unit
};

void draw_small(Picture& picture, const History& history, const SmallPlot& small,
                const Frame& frame) {
  Range y = Range::nothing();
  const std::size_t count = history.campaigns.size();
  for (std::size_t i = 0; i < count; ++i) {
    y.include(small.value(i) - small.bar(i));
    y.include(small.value(i) + small.bar(i));
  }
  if (y.empty()) return;
  Plot plot = plot_over_time(picture, frame, time_range(history),
                             {.range = y.widened(0.08), .ticks = 4}, 3);
  TimePoints dots;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(small.value(i))) continue;
    const double x = at_time(history, i);
    dots.emplace_back(x, small.value(i));
    plot.inside().line(plot.spot(x, small.value(i) - small.bar(i)),
                       plot.spot(x, small.value(i) + small.bar(i)), "hair");
  }
  plot.dots(dots, joint_dots(0));
  const bool changed =
      std::any_of(small.changes.begin(), small.changes.end(),
                  [&](const DatedChange& change) { return change.number == small.number; });
  if (changed)
    plot.line(modelled(history, small.number, small.changes, small.value),
              joint_line(1) + " whole");
  picture.words({frame.left, frame.top - 6}, small.title + " " + small.unit, Anchor::start,
                changed ? "strong" : "");
}

void draw_all(Markup figure, const History& history, const std::vector<SmallPlot>& plots,
              std::string_view what) {
  const double each = kAboveSmall + kSmallHeight + kBelow;
  const std::size_t rows = (plots.size() + kAcross - 1) / kAcross;
  Picture picture(figure, kPageWidth, each * static_cast<double>(rows), what);
  for (std::size_t k = 0; k < plots.size(); ++k) {
    const std::size_t row = k / kAcross;
    draw_small(picture, history, plots[k],
               {kSmallWidth * static_cast<double>(k % kAcross) + kSmallLeft,
                each * static_cast<double>(row) + kAboveSmall, kSmallWidth - kSmallLeft - 10,
                kSmallHeight});
  }
}

void add_numbers(Markup body, const History& history) {
  std::vector<SmallPlot> plots;
  for (std::size_t k = 0; k < history.numbers.size(); ++k) {
    const identify::ArmNumber& number = history.numbers[k];
    const auto at = static_cast<Eigen::Index>(k);
    const double from = history.campaigns[history.reference].values(at);
    auto changes = history.changes;
    for (DatedChange& change : changes) change.size = in_unit(number, change.size);
    plots.push_back({name_of(number), unit_of(number), k,
                     [&history, number, at, from](std::size_t i) {
                       return in_unit(number, history.campaigns[i].values(at) - from);
                     },
                     [&history, number, at](std::size_t i) {
                       return identify::kSigmasOf95Percent *
                              in_unit(number, history.campaigns[i].sigma(at));
                     },
                     changes});
  }
  auto figure = add_figure(body, "Each number",
                           "less that of the reference campaign, with bars of 95 % that hold the "
                           "repeatability between campaigns. Lines are the changes that are "
                           "named. zero: theta minus the controller's angle at home.");
  figure.set("class", "long");
  draw_all(figure, history, plots, "Numbers over time");
}

void add_friction(Markup body, const History& history) {
  if (history.friction.empty()) return;
  std::vector<SmallPlot> plots;
  for (std::size_t k = 0; k < history.friction.size(); ++k)
    plots.push_back({"joint " + std::to_string(history.friction[k].joint + 1), "A", k,
                     [&history, k](std::size_t i) { return history.friction[k].values_a[i]; },
                     [](std::size_t) { return 0.0; }, history.friction_changes});
  auto figure = add_figure(body, "Friction of each joint",
                           "by motor currents, in what the controller tells them in: ampere by "
                           "KUKA's RSI. It depends on speed, temperature and load.");
  draw_all(figure, history, plots, "Friction over time");
}

void add_link(Markup body, const History& history) {
  std::vector<SmallPlot> plots;
  const auto add = [&](const char* title, const char* unit, auto value) {
    const bool any = std::any_of(
        history.campaigns.begin(), history.campaigns.end(), [&](const ComparedCampaign& campaign) {
          return campaign.record.link && std::isfinite(value(*campaign.record.link));
        });
    if (!any) return;
    plots.push_back({title,
                     unit,
                     0,
                     [&history, value](std::size_t i) {
                       const auto& link = history.campaigns[i].record.link;
                       return link ? value(*link) : kNothing;
                     },
                     [](std::size_t) { return 0.0; },
                     {}});
  };
  add("late replies", "of a million",
      [](const LinkQuality& link) { return 1e6 * link.late_replies / link.received; });
  add("lost telegrams", "of a million",
      [](const LinkQuality& link) { return 1e6 * link.lost / link.received; });
  add("reply within (99.9 %)", "us", [](const LinkQuality& link) { return link.latency_p99_9_us; });
  if (plots.empty()) return;
  auto figure = add_figure(body, "The link", "of each campaign that has a link.json.");
  draw_all(figure, history, plots, "The link over time");
}

void add_table(Markup body, const History& history) {
  auto table = body.add("table");
  table.put("caption",
            "U: expanded uncertainty of one campaign (k = 2), with the repeatability; of fit: what "
            "the campaign says of itself. Smallest: a change of this number alone that one "
            "campaign shows in 80 % of cases.");
  auto head = table.add("thead").add("tr");
  for (const char* title : {"number", "unit"}) head.put("th", title);
  for (const char* title : {"reference", "last", "U", "U of fit", "smallest"})
    head.put("th", title, {{"class", "number"}});
  auto rows = table.add("tbody");
  const int lengths = decimals_of(history, true), angles = decimals_of(history, false);
  const auto& first = history.campaigns[history.reference].values;
  const auto& last = history.campaigns.back().values;
  for (std::size_t k = 0; k < history.numbers.size(); ++k) {
    const identify::ArmNumber& number = history.numbers[k];
    const auto at = static_cast<Eigen::Index>(k);
    auto row = rows.add("tr");
    row.put("td", name_of(number)).put("td", unit_of(number));
    for (const double value : {first(at), last(at), kCoverage * history.sigma(at),
                               kCoverage * history.fit_sigma(at), history.smallest(at)})
      row.put("td",
              std::isfinite(value) ? fixed(in_unit(number, value), number.length ? lengths : angles)
                                   : "-",
              {{"class", "number"}});
  }
}

void add_notes(Markup body, const History& history) {
  bool any = false;
  for (const auto& [campaign, note] : history.notes) any = any || !note.text.empty();
  if (any) {
    body.put("h2", "Notes");
    auto rows = body.add("table").add("tbody");
    for (const auto& [campaign, note] : history.notes) {
      if (note.text.empty()) continue;
      auto row = rows.add("tr");
      row.put("td", date_of(history, note.time)).put("td", note.text).put("td", campaign);
    }
  }
  if (history.messages.empty() && history.left_out.empty()) return;
  body.put("h2", "What is not in it");
  auto list = body.add("div", {{"class", "messages"}}).add("ul");
  for (const std::string& message : history.messages) list.put("li", message);
  for (const CampaignRecord& record : history.left_out) list.put("li", record.why_not);
}

}  // namespace

std::string history_page(const History& history) {
  pugi::xml_document document;
  auto body = begin_page(document, "History: " + history.robot);
  body.put("p",
           history.describes == "arm" ? "History of the arm" : "History of the controller's model",
           {{"class", "kind"}});
  body.put("h1", history.robot);
  body.put("p", verdict_words(history),
           {{"class", history.changes.empty() ? "verdict" : "verdict partial"}});
  body.put("p", rsi::counted(history.campaigns.size(), "campaign") + ", " +
                    date_of(history, history.campaigns.front().record.time) + " to " +
                    date_of(history, history.campaigns.back().record.time) +
                    ". Reference: " + history.campaigns[history.reference].record.name +
                    (history.reference_state.size() > 1
                         ? ", with all " + std::to_string(history.reference_state.size()) +
                               " campaigns of its state"
                         : "") +
                    ".");
  add_changes(body, history);
  body.put("h2", "Over time");
  add_totals(body, history);
  add_numbers(body, history);
  add_friction(body, history);
  add_link(body, history);
  body.put("h2", "How much is seen");
  body.put("p", "Repeatability between campaigns: " + repeatability_words(history));
  add_table(body, history);
  add_notes(body, history);
  return std::string(kHistoryBegin) + html_text(document);
}

}  // namespace sweepd
