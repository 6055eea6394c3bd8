#include "daemon/commands/report_command.hpp"

#include <cstdlib>
#include <sstream>

#include <nlohmann/json.hpp>

#include "daemon/commands/command_line.hpp"
#include "daemon/report/html_report.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/text/file_names.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

int report_of(const ReportOptions& options) {
  std::ostringstream ignored;
  return make_report(options, ignored);
}

/// PATH is something else for a while.
class OtherPath {
 public:
  explicit OtherPath(const std::string& path) : before_(std::getenv("PATH")) {
    setenv("PATH", path.c_str(), 1);
  }
  ~OtherPath() { setenv("PATH", before_.c_str(), 1); }
  OtherPath(const OtherPath&) = delete;
  OtherPath& operator=(const OtherPath&) = delete;

 private:
  std::string before_;
};

}  // namespace

TEST_CASE("a report is made again with facts, in a recording's folder, too", "[report_command]") {
  const TemporaryFolder folder;
  write_result(folder.path(), partial_outcome());
  (void)folder.write("run.json", R"({"schema": "sweepd.run/1", "command": "run"})");
  const auto before = content(folder / file_names::kReportPage);
  ReportOptions options;
  options.folders = {folder.path()};
  options.facts = folder.write("facts.toml", "payload = \"2.3 kg\"\n");
  CHECK(report_of(options) == 0);
  CHECK_THAT(content(folder / file_names::kReportPage), ContainsSubstring("2.3 kg"));
  CHECK_THAT(before, !ContainsSubstring("2.3 kg"));
}

TEST_CASE("a report of two folders tells what has changed, or why nobody can tell",
          "[report_command][long]") {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b", "c"}) std::filesystem::create_directory(folder / name);
  auto outcome = complete_outcome();
  outcome.positive = identify::test::kr5_arc().positive;
  write_result(folder / "a", outcome);
  outcome.identification.dh[3].theta_rad.value += 0.02 * identify::kDegree;
  write_result(folder / "b", outcome);
  write_result(folder / "c", partial_outcome());
  ReportOptions options;
  options.folders = {folder / "a", folder / "b", folder / "c"};
  options.output = folder / "all.html";
  CHECK(report_of(options) == 0);
  const auto html = content(folder / "all.html");
  CHECK_THAT(html, ContainsSubstring("What has changed"));
  CHECK_THAT(html, ContainsSubstring("From a (A) to b (B)") &&
                       ContainsSubstring("Changed: zero4 by -0.020000 deg"));
  CHECK_THAT(html, ContainsSubstring("From b (A) to c (B)") && ContainsSubstring("Not compared: "));
}

TEST_CASE("a report overwrites no other file, nor one that it reads", "[report_command]") {
  const TemporaryFolder folder;
  write_result(folder.path(), partial_outcome());
  ReportOptions options;
  options.folders = {folder.path()};
  options.output = folder.write("letter.html", "<p>somebody's");
  CHECK_THROWS_WITH(report_of(options), ContainsSubstring("letter.html is not overwritten"));
  CHECK(content(folder / "letter.html") == "<p>somebody's");
  options.facts = folder.write("facts.toml", "payload = \"2 kg\"\n");
  options.output = options.facts;
  options.force = true;
  CHECK_THROWS_WITH(report_of(options), ContainsSubstring("this command reads it"));
  static_cast<void>(folder.write("run.json", "{}"));
  for (const char* name : {"result.json", "run.json"}) {
    const auto before = content(folder / name);
    options.output = folder / name;
    CHECK_THROWS_WITH(report_of(options), ContainsSubstring("this command reads it"));
    CHECK(content(folder / name) == before);
  }
  options.output = folder / "letter.html";
  CHECK(report_of(options) == 0);
  CHECK(content(folder / "letter.html").starts_with(kHtmlBegin));
}

TEST_CASE("without Chromium a PDF says what to do, and the page is there", "[report_command]") {
  const TemporaryFolder folder;
  write_result(folder.path(), partial_outcome());
  ReportOptions options;
  options.folders = {folder.path()};
  options.output = folder / "own.html";
  options.pdf = true;
  const OtherPath nothing("/nonexistent::");
  CHECK_THROWS_WITH(report_of(options), ContainsSubstring("install it"));
  CHECK(std::filesystem::exists(folder / "own.html"));
}

TEST_CASE("a browser that fails leaves no PDF", "[report_command]") {
  const TemporaryFolder folder;
  write_result(folder.path(), partial_outcome());
  std::filesystem::create_directory(folder / "bin");
  const auto fake = folder.write("bin/chromium", "#!/bin/sh\nexit 3\n");
  std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
  ReportOptions options;
  options.folders = {folder.path()};
  options.pdf = true;
  const OtherPath only((folder / "bin").string());
  CHECK_THROWS_WITH(report_of(options), ContainsSubstring("did not print the report"));
  CHECK_FALSE(std::filesystem::exists(folder / "report.pdf"));
}

TEST_CASE("the annex tells how to make the result again, and of which files", "[report_command]") {
  const TemporaryFolder folder;
  write_result(folder.path(), partial_outcome());
  (void)folder.write(
      "run.json",
      nlohmann::json{
          {"schema", "sweepd.run/1"},
          {"command", "replay"},
          {"arguments", {"replay", "a trace.pcap", "it's"}},
          {"inputs", {{{"file", "a trace.pcap"}, {"bytes", 12}, {"sha256", "0123abcd"}}}}}
          .dump());
  ReportOptions options;
  options.folders = {folder.path()};
  CHECK(report_of(options) == 0);
  const auto html = content(folder / file_names::kReportPage);
  CHECK_THAT(html, ContainsSubstring("sweepd replay 'a trace.pcap' 'it'\\''s'"));
  CHECK_THAT(html, ContainsSubstring("0123abcd"));
}
