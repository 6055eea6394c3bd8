#include "daemon/commands/history_command.hpp"

#include <fstream>
#include <sstream>

#include "daemon/commands/note_command.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/history/drawn_campaigns.hpp"
#include "tests/daemon/history/whole_result.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::HistoryCommandOptions;
using sweepd::NoteOptions;
using sweepd::test::TemporaryFolder;
using sweepd::test::whole_result;
namespace fs = std::filesystem;

namespace {

/// Campaigns of a robot that lost its zero of joint 4 in between.
class RobotFolder {
 public:
  RobotFolder() {
    const sweepd::test::DrawnCampaigns drawn(whole_result().dump());
    std::mt19937 random(5);
    for (int i = 0; i < 8; ++i) {
      const std::string name = "2024-0" + std::to_string(i + 1) + "-01";
      fs::create_directories(folder_ / ("kr5/" + name));
      auto result = whole_result();
      auto rows = drawn.rows();
      if (i >= 5)
        rows[3].theta_rad += 40 * sweepd::radians(result["dh"][3]["theta_sigma_deg"].get<double>());
      write(result, drawn.draw(rows, random).arm->arm.dh);
      (void)folder_.write("kr5/" + name + "/result.json", result.dump());
    }
  }
  [[nodiscard]] fs::path robot() const { return folder_ / "kr5"; }
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] int history(HistoryCommandOptions options = {}) {
    if (options.of.empty()) options.of = {robot()};
    std::ostringstream out;
    const int code = show_history(options, out);
    text = out.str();
    return code;
  }
  void note(NoteOptions options) {
    std::ostringstream out;
    CHECK(sweepd::note(options, out) == 0);
    text = out.str();
  }

  std::string text;

 private:
  static void write(nlohmann::ordered_json& result, const std::vector<identify::DhEstimate>& dh) {
    for (std::size_t j = 0; j < dh.size(); ++j) {
      auto& row = result["dh"][j];
      const auto set = [&](const char* key, double value) {
        if (row.contains(key) && row[key].is_number()) row[key] = value;
      };
      set("b_mm", dh[j].b_mm.value);
      set("theta_deg", sweepd::degrees(dh[j].theta_rad.value));
      set("a_mm", dh[j].a_mm.value);
      set("alpha_deg", sweepd::degrees(dh[j].alpha_rad.value));
      set("beta_deg", sweepd::degrees(dh[j].beta_rad.value));
    }
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("a note in a folder without any result is refused", "[note_command]") {
  const TemporaryFolder folder;
  std::ostringstream out;
  CHECK_THROWS_WITH(sweepd::note({folder.path(), {"hello"}, {}, {}, {}}, out),
                    ContainsSubstring("holds no result: give a folder of results"));
  CHECK_FALSE(fs::exists(folder / "notes.jsonl"));
}

TEST_CASE("history tells the crash, and the note beside it", "[history_command][long]") {
  RobotFolder folder;
  folder.note({folder.robot(), {"collision,", "A4"}, {}, "2024-05-20", {}});
  for (const char* name : {"2024-01-01", "2024-02-01", "2024-03-01", "2024-04-01"})
    folder.note({folder.robot() / name, {}, "new", {}, {}});
  HistoryCommandOptions options;
  options.csv = folder.path("h.csv");
  options.html = folder.path("h.html");
  CHECK(folder.history(options) == 3);
  CHECK_THAT(folder.text, ContainsSubstring("zero4 jumped by") &&
                              ContainsSubstring("2024-05-01 and 2024-06-01") &&
                              ContainsSubstring("note of 2024-05-20: collision, A4"));
  CHECK_THAT(sweepd::test::content(folder.path("h.csv")), ContainsSubstring("zero4_low_deg"));
  CHECK_THAT(sweepd::test::content(folder.path("h.html")), ContainsSubstring("collision, A4"));
  CHECK(folder.history(options) == 3);  // over its own files
  options.csv = folder.robot() / "2024-01-01" / "result.json";
  CHECK_THROWS_AS(folder.history(options), std::invalid_argument);
  options.force = true;
  CHECK_THROWS_WITH(folder.history(options), ContainsSubstring("this command reads it"));
}

TEST_CASE("a history without a change ends with 0", "[history_command][long]") {
  RobotFolder folder;
  HistoryCommandOptions options;
  for (const char* name : {"2024-01-01", "2024-02-01", "2024-03-01", "2024-04-01"})
    options.of.push_back(folder.robot() / name);
  CHECK(folder.history(options) == 0);
  CHECK_THAT(folder.text, ContainsSubstring("No change is seen that can be dated."));
}

TEST_CASE("a robot is found by its name in the settings", "[history_command][long]") {
  RobotFolder folder;
  std::ofstream(folder.path("sweepd.toml"))
      << "[[robot]]\nname = \"kr5\"\ndescription = \"kr5.toml\"\nlisten = \"127.0.0.1:49152\"\n"
         "output = \".\"\n";
  HistoryCommandOptions options;
  options.of = {"kr5"};
  options.config = folder.path("sweepd.toml");
  CHECK(folder.history(options) == 3);
  options.of = {"kr6"};
  CHECK_THROWS_WITH(folder.history(options),
                    ContainsSubstring("kr6 is no folder, and no robot in"));
  options.config = folder.path("nothing.toml");
  CHECK_THROWS_WITH(folder.history(options), ContainsSubstring("there are no settings"));
}

TEST_CASE("dates that are none are refused", "[history_command]") {
  RobotFolder folder;
  HistoryCommandOptions options;
  options.since = "yesterday";
  CHECK_THROWS_WITH(folder.history(options), ContainsSubstring("yesterday is no date"));
  options.since.reset();
  options.same_state = "2024-01-01";
  CHECK_THROWS_WITH(folder.history(options), ContainsSubstring("write FROM..TO"));
  options.same_state = "2024-03-01..2024-01-01";
  CHECK_THROWS_WITH(folder.history(options), ContainsSubstring("ends before it begins"));
}

TEST_CASE("notes are written, and printed where there is nothing to write", "[note_command]") {
  RobotFolder folder;
  const fs::path campaign = folder.robot() / "2024-01-01";
  folder.note({campaign, {}, {}, {}, {}});
  CHECK(folder.text == "no notes in " + campaign.string() + "\n");
  folder.note({campaign, {"new", "belt"}, "service", "2024-01-02T10:30", {}});
  CHECK(folder.text == "noted in " + (campaign / "notes.jsonl").string() + "\n");
  folder.note({campaign, {}, {}, {}, "2023-12-31"});
  folder.note({campaign, {}, "", {}, {}});
  folder.note({campaign, {}, {}, {}, {}});
  CHECK_THAT(folder.text, ContainsSubstring("2024-01-02T10:30Z  same state: service  new belt\n"
                                            "2023-12-31T00:00Z  measured then\n") &&
                              ContainsSubstring("of no state"));
  CHECK_THROWS_WITH(sweepd::note({campaign, {"a"}, {}, "soon", {}}),
                    ContainsSubstring("--at: soon is no date"));
  CHECK_THROWS_WITH(sweepd::note({folder.path("nowhere"), {"a"}, {}, {}, {}}),
                    ContainsSubstring("is no folder"));
}

TEST_CASE("what a note or a name holds steers no terminal", "[note_command]") {
  RobotFolder folder;
  const fs::path campaign = folder.robot() / "2024-01-01";
  const std::string red = "\x1b[31m";
  folder.note({campaign, {"red" + red + "\nforged"}, "state" + red, {}, {}});
  folder.note({campaign, {}, {}, {}, {}});
  CHECK_THAT(folder.text, ContainsSubstring("same state: state?[31m  red?[31m?forged\n"));
  fs::create_directories(folder.robot() / ("2024-09-01" + red));
  std::ofstream(folder.robot() / ("2024-09-01" + red) / "run.json") << "{}";
  HistoryCommandOptions options;
  options.csv = folder.path("history.csv");
  (void)folder.history(options);
  CHECK_THAT(folder.text, ContainsSubstring("left out") && !ContainsSubstring("\x1b"));
  CHECK_THAT(sweepd::test::content(*options.csv),
             ContainsSubstring("state?[31m") && !ContainsSubstring("\x1b"));
}
