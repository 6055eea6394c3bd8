#include <algorithm>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#include "daemon/report/report_parts.hpp"
#include "daemon/report/report_table.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

std::size_t joints_of(const Json& result) {
  return list_of(result, "joints").size();
}

/// How many joints have an axis.
std::size_t axes_of(const Json& result) {
  const Json joints = list_of(result, "joints");
  return static_cast<std::size_t>(
      std::count_if(joints.begin(), joints.end(),
                    [](const Json& joint) { return part_of(joint, "axis").is_object(); }));
}

bool warns(const Json& result, std::string_view code) {
  const Json warnings = list_of(result, "warnings");
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const Json& warning) { return text_of(warning, "code") == code; });
}

std::string because(const Json& result) {
  const std::string reason = text_of(result, "reason");
  if (reason.empty()) return ".";
  const bool ended = std::string_view(".?!").find(reason.back()) != std::string_view::npos;
  return ": " + reason + (ended ? "" : ".");
}

void add_fact(Markup list, const std::string& name, const std::string& text,
              const char* kind = "stated") {
  auto line = list.add("p");
  line.put("span", name);
  line.add("bdi", {{"class", kind}}).text(text);
}

std::string source_text(const Json& result) {
  if (text_of(result, "estimator") == "axes")
    return fmt::format("{} axes, given as lines", axes_of(result));
  const Json& source = part_of(result, "source");
  const auto count = [&](const char* key) {
    return part_of(source, key).is_number() ? part_of(source, key).get<std::uint64_t>() : 0;
  };
  if (part_of(source, "points").is_number())
    return rsi::counted(count("points"), "point") + " in " + rsi::counted(count("files"), "file");
  std::string text = rsi::counted(count("telegrams"), "telegram");
  if (const double cycle_ms = number_of(source, "cycle_ms"); cycle_ms > 0)
    text += ", one every " + fixed(cycle_ms, 3) + " ms";
  return fmt::format("{}, {} lost, {} malformed", text, count("lost"), count("malformed"));
}

/// "2026-11-25 13:19:30 UTC"; as it is where it is no time.
std::string moment_text(const std::string& started) {
  const auto time = parse_utc(started);
  if (!time) return started;
  const auto text = utc_text(*time);
  return text.substr(0, 10) + ' ' + text.substr(11, 8) + " UTC";
}

std::string home_text(const Json& result) {
  std::string text;
  std::string unit;
  const Json home = list_of(result, "home_deg");
  const Json joints = list_of(result, "joints");
  for (std::size_t j = 0; j < home.size(); ++j) {
    if (!home[j].is_number()) continue;
    const char* const own = j < joints.size() && is_linear(joints[j]) ? " mm" : " deg";
    if (!text.empty()) text += (unit == own ? "" : unit) + ", ";
    text += fmt::format("A{} {}", j + 1, fixed(home[j].get<double>(), 3));
    unit = own;
  }
  return text.empty() ? "not known" : text + unit;
}

void add_messages(Markup parent, const char* title, const Json& messages) {
  if (!messages.is_array() || messages.empty()) return;
  auto part = parent.add("div", {{"class", "messages"}});
  part.put("h3", title);
  auto list = part.add("ul");
  for (const Json& one : messages)
    list.add("li").text(text_of(one, "message")).put("code", " " + text_of(one, "code"));
}

std::string describes_text(const Json& result) {
  if (const std::string told = text_of(result, "explanation"); !told.empty())
    return "The numbers describe " + told;
  if (text_of(result, "estimator") == "axes")
    return "The numbers describe the arm as the given axes have it.";
  if (text_of(result, "describes") == "arm")
    return "The numbers describe the arm as a device measured it.";
  return "The numbers describe the controller's model: it computes the positions that it sends "
         "from its own angles. They do not tell how the arm itself is. For that, measure the arm "
         "with a "
         "device.";
}

std::string departures_text(const std::vector<DhLine>& lines) {
  const Departures found = departures(lines);
  if (found.numbers == 0) return {};
  if (found.beyond == 0)
    return fmt::format(
        "None of {} numbers differs from the specification by more than its expanded uncertainty.",
        found.numbers);
  std::string text = fmt::format(
      "{} of {} numbers {} from the specification by more than the expanded uncertainty. By chance "
      "it would be {}.",
      found.beyond, found.numbers, found.beyond == 1 ? "differs" : "differ",
      found.numbers < 10 ? "none" : fmt::format("about {}", (found.numbers + 10) / 20));
  if (const auto& largest = found.largest)
    text += fmt::format(" The clearest is {} of joint {}: {} {}.", largest->symbol, largest->joint,
                        told(*largest->difference, *largest), largest->unit);
  return text;
}

}  // namespace

std::string verdict_sentence(const ReportFolder& folder) {
  const Json& result = folder.result;
  const std::string status = text_of(result, "status");
  const std::size_t joints = joints_of(result);
  if (status == "complete")
    return "All " + rsi::counted(joints, "joint") +
           " are identified, and nothing in the data contradicts the result." +
           (warns(result, "direction_ambiguous")
                ? " Nothing tells which way some of them move: what depends on that is assumed, "
                  "see the warnings."
                : "");
  if (status == "partial")
    return fmt::format("{} of {} {} an axis. The result is not complete{}", axes_of(result),
                       rsi::counted(joints, "joint"), axes_of(result) == 1 ? "has" : "have",
                       because(result));
  if (status == "doubtful")
    return "The data contradict the result. Do not use it" + because(result);
  return "Nothing is identified" + because(result);
}

void add_first_page(Markup parent, const ReportFolder& folder, const ReportFacts& facts) {
  const Json& result = folder.result;
  auto page = parent.add("section", {{"class", "front"}});
  page.put("p", "Measurement report", {{"class", "kind"}});
  page.add("h1").add("bdi").text(text_of(result, "robot"));
  const std::string status = text_of(result, "status");
  auto verdict = page.add("p", {{"class", "verdict " + clean_text(status)}});
  verdict.put("b", status + ". ").text(verdict_sentence(folder));
  if (status != "failed") page.put("p", describes_text(result));
  const auto lines = dh_lines(folder);
  if (const auto text = departures_text(lines); !text.empty() && status != "failed")
    page.put("p", text);
  add_messages(page, "What contradicts", list_of(result, "doubts"));
  if (!lines.empty() && status != "failed") add_dh_table(page, lines);
  add_messages(page, "Warnings", list_of(result, "warnings"));
  page.put("h3", "What was measured");
  auto list = page.add("div", {{"class", "facts"}});
  add_fact(list, "Folder", folder.name);
  if (!text_of(folder.run, "started").empty())
    add_fact(list, "Started", moment_text(text_of(folder.run, "started")));
  add_fact(list, "Data", source_text(result));
  Json reasons = list_of(folder.link, "reasons");
  for (Json& reason : reasons)
    reason["message"] = text_of(reason, "grade") + ": " + text_of(reason, "message");
  if (const auto link = text_of(folder.link, "verdict"); !link.empty())
    add_fact(list, "Link", link + (reasons.empty() ? "" : ", see below"));
  add_fact(list, "Home", home_text(result));
  for (const auto& [name, text] : facts)
    add_fact(list, name, text.empty() ? "not stated" : text, text.empty() ? "missing" : "given");
  page.put("p",
           "sweepd cannot know the facts in italics. Those that are not stated can be given with "
           "sweepd report --facts FILE.",
           {{"class", "note"}});
  add_messages(page, "What the verdict on the link rests on", reasons);
}

}  // namespace sweepd
