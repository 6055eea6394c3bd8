// Telegrams that were recorded on a KR C4: one decimal, 4 ms, axis angles without positions.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/replay_command.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/acceptance/recording.hpp"
#include "tests/catch.hpp"

using namespace acceptance;
using Json = nlohmann::json;

namespace {

constexpr double kCycle_s = 0.004;
/// One unit of the last decimal that this controller printed.
constexpr double kUnit_deg = 0.1;

/// The text between `before` and the next quotation mark.
std::string_view quoted(std::string_view line, std::string_view before) {
  const auto at = line.find(before);
  if (at == std::string_view::npos) throw std::runtime_error("no " + std::string(before));
  const auto begin = at + before.size();
  return line.substr(begin, line.find('"', begin) - begin);
}

std::vector<double> quoted_numbers(const std::vector<std::string>& lines, std::string_view before) {
  std::vector<double> values;
  for (const auto& line : lines) values.push_back(number(quoted(line, before)));
  return values;
}

/// What the values of <Delay D=> tell without sweepd.
struct LateReplies {
  std::size_t telegrams = 0;  ///< with a D that is not zero
  std::size_t runs = 0;       ///< of such telegrams, one after the other
  double longest = 0;
};

LateReplies late_replies(const std::vector<double>& delays) {
  LateReplies late;
  double before = 0;
  for (const double delay : delays) {
    if (delay > 0) ++late.telegrams;
    if (delay > 0 && before == 0) ++late.runs;
    late.longest = std::max(late.longest, delay);
    before = delay;
  }
  return late;
}

/// A stretch of telegrams in which the joint stands, or turns back, as far as the print shows.
struct FlatTop {
  std::size_t first = 0;
  std::size_t last = 0;
  double angle_deg = 0;
};

/// Where the motion begins, each turning point, and where it ends. An extreme of the printed angles
/// is one when the joint has gone back from it by half a degree; its flat top are the telegrams
/// around it whose angle is at most one unit of print below.
std::vector<FlatTop> flat_tops(const std::vector<double>& angles_deg) {
  constexpr double kBack_deg = 0.5;
  const auto around = [&](std::size_t extreme) {
    const double angle = angles_deg[extreme];
    const auto flat = [&](std::size_t i) {
      return std::abs(angles_deg[i] - angle) < 1.5 * kUnit_deg;
    };
    FlatTop top{extreme, extreme, angle};
    while (top.first > 0 && flat(top.first - 1)) --top.first;
    while (top.last + 1 < angles_deg.size() && flat(top.last + 1)) ++top.last;
    return top;
  };
  std::vector<FlatTop> tops{around(0)};
  std::size_t extreme = 0;
  int direction = 0;
  for (std::size_t i = 1; i < angles_deg.size(); ++i) {
    const double beyond = angles_deg[i] - angles_deg[extreme];
    if (direction == 0 && std::abs(beyond) > kBack_deg) direction = beyond > 0 ? 1 : -1;
    if (direction * beyond > 0) extreme = i;
    if (direction * beyond < -kBack_deg) {
      tops.push_back(around(extreme));
      direction = -direction;
      extreme = i;
    }
  }
  tops.push_back(around(angles_deg.size() - 1));
  return tops;
}

struct Replayed {
  std::vector<std::string> lines;
  std::uint64_t telegrams = 0;
  std::string report;
  Json result;
};

Replayed replayed(const std::filesystem::path& recording) {
  const TemporaryFolder folder;
  Replayed all;
  all.lines = lines_of(recording);
  all.telegrams = recording_to_capture(recording, folder / "recording.pcap");
  sweepd::ReplayOptions options;
  options.traces = {folder / "recording.pcap"};
  options.output = folder / "result";
  std::ostringstream report;
  std::ostringstream errors;
  REQUIRE(sweepd::replay(options, report, errors) == 0);
  CHECK(errors.str().empty());
  all.report = report.str();
  all.result = Json::parse(text_of(folder / "result/result.json"));
  return all;
}

void print_strokes(const Json& sweeps, const std::vector<FlatTop>& tops) {
  std::cout << "joint 1   from  its flat top      to  its flat top      range deg  (seconds)\n";
  const auto top = [](const FlatTop& flat) {
    return right(static_cast<double>(flat.first) * kCycle_s, 3, 9) + ".." +
           right(static_cast<double>(flat.last) * kCycle_s, 3, 6);
  };
  for (std::size_t i = 0; i < sweeps.size(); ++i)
    std::cout << right(sweeps[i]["start_s"].get<double>(), 3, 14) << top(tops[i])
              << right(sweeps[i]["end_s"].get<double>(), 3, 9) << top(tops[i + 1])
              << right(sweeps[i]["direction"].get<double>() * sweeps[i]["range_deg"].get<double>(),
                       1, 9)
              << '\n';
}

void check_recording(const std::string& file, std::uint64_t telegrams, const LateReplies& late) {
  const auto folder = real_data("recordings");
  if (!folder) return;
  const Replayed seen = replayed(*folder / file);
  std::cout << file << "\n\n" << seen.report << '\n';

  const Json& source = seen.result["source"];
  CHECK(seen.lines.size() == telegrams);
  CHECK(seen.telegrams == telegrams);
  CHECK(source["telegrams"] == telegrams);
  for (const char* none : {"malformed", "lost", "duplicated", "reordered", "restarts"}) {
    INFO(none);
    CHECK(source[none] == 0);
  }
  CHECK(source["cycle_ms"] == 4.0);

  const LateReplies counted = late_replies(quoted_numbers(seen.lines, "<Delay D=\""));
  CHECK(counted.telegrams == late.telegrams);
  CHECK(counted.runs == late.runs);
  CHECK(source["late_replies"] == counted.telegrams);
  CHECK(source["late_runs"] == counted.runs);
  CHECK(source["longest_late_run"] == counted.longest);

  // Joint 1 went from rest over eight turning points to rest.
  const auto tops = flat_tops(quoted_numbers(seen.lines, "<AIPos A1=\""));
  const Json& sweeps = seen.result["joints"][0]["sweeps"];
  REQUIRE(tops.size() == 10);
  REQUIRE(sweeps.size() == tops.size() - 1);
  print_strokes(sweeps, tops);
  // Within the flat top, one cycle to either side: the print cannot say it more exactly.
  const auto within = [](double time_s, const FlatTop& top) {
    const double cycle = time_s / kCycle_s;
    return cycle > static_cast<double>(top.first) - 1.5 &&
           cycle < static_cast<double>(top.last) + 1.5;
  };
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    INFO("stroke " << i + 1);
    CHECK(within(sweeps[i]["start_s"], tops[i]));
    CHECK(within(sweeps[i]["end_s"], tops[i + 1]));
    const double turned_deg = tops[i + 1].angle_deg - tops[i].angle_deg;
    CHECK(sweeps[i]["direction"] == (turned_deg > 0 ? 1 : -1));
    // Up to one unit is cut off at either end.
    CHECK(sweeps[i]["range_deg"].get<double>() ==
          Approx(std::abs(turned_deg)).margin(2 * kUnit_deg + 1e-9));
  }

  CHECK(seen.result["status"] == "partial");
  CHECK_THAT(seen.result["reason"].get<std::string>(),
             Catch::Matchers::ContainsSubstring("no positions"));
  std::vector<int> never_moved;
  for (const Json& warning : seen.result["warnings"])
    if (warning["code"] == "joint_never_moved") never_moved.push_back(warning["joint"]);
  CHECK(never_moved == std::vector<int>{2, 3, 4, 5, 6});
  for (std::size_t j = 1; j < 6; ++j) CHECK(seen.result["joints"][j]["sweeps"].empty());
}

}  // namespace

TEST_CASE("A recorded sine of joint 1 is replayed without a flaw", "[recordings]") {
  check_recording("a1-sine.txt", 4548, {0, 0, 0});
}

TEST_CASE("A recording with late replies is replayed and they are counted", "[recordings]") {
  // Eleven telegrams have a D above zero; they stand in nine runs, two of which reach 2 (once it
  // goes 1, 2, 0, 1).
  check_recording("a1-late-packets.txt", 6523, {11, 9, 2});
}
