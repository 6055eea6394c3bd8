#include "daemon/report/html_report.hpp"

#include <set>
#include <sstream>

#include <Eigen/Dense>
#include <pugixml.hpp>

#include "daemon/results/result_files.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"
#include "tests/daemon/outcomes.hpp"
#include "tests/daemon/scara.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/daemon/texts.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

/// The report of an outcome, as a run leaves it.
std::string report_html(const Outcome& outcome) {
  const TemporaryFolder folder;
  write_result(folder.path(), outcome);
  return content(folder / file_names::kReportPage);
}

/// Without what is markup: what a reader can find in it.
std::string words_of(const std::string& html) {
  std::string text;
  bool inside = false;
  for (const char c : html) {
    if (c == '<') inside = true;
    if (!inside) text += c;
    if (c == '>') {
      inside = false;
      text += ' ';
    }
  }
  return text;
}

/// Whether a browser gets what was meant: all that is opened is closed, in order.
void check_whole(const std::string& html) {
  REQUIRE(html.starts_with(kHtmlBegin));
  std::string xml = html.substr(kHtmlBegin.size());
  for (std::size_t at = 0; (at = xml.find("<meta", at)) != std::string::npos; ++at)
    xml.insert(xml.find('>', at), "/");
  pugi::xml_document document;
  CHECK(document.load_string(xml.c_str()).status == pugi::status_ok);
  CHECK(document.select_nodes("//script | //img | //link | //iframe | //a").empty());
  constexpr std::string_view kNamespace = "http://www.w3.org/2000/svg";
  for (std::size_t at = 0; (at = xml.find(kNamespace, at)) != std::string::npos;)
    xml.erase(at, kNamespace.size());
  // The six letters of a temporary folder's name may hold any word.
  constexpr std::string_view kTemporary = "sweepd-";
  for (std::size_t at = 0; (at = xml.find(kTemporary, at)) != std::string::npos;)
    xml.erase(at, kTemporary.size() + 6);
  CHECK(xml.find("http:") == std::string::npos);
  CHECK(xml.find("https:") == std::string::npos);
  CHECK(xml.find("url(") == std::string::npos);
  CHECK(xml.find("nan") == std::string::npos);
  CHECK(xml.find("inf") == std::string::npos);
}

}  // namespace

TEST_CASE("the report of a complete run has the paper's figures and all numbers of dh.csv",
          "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  const auto html = content(folder / file_names::kReportPage);
  check_whole(html);
  CHECK(html.size() < 600'000);
  const auto words = words_of(html);
  for (const char* const figure :
       {"Fitted circle for each joint motion.", "Range of motion provided to each joint.",
        "Circle, centre and normal of each joint.", "Spread of the points of each joint.",
        "Residuals along each arc.", "What the uncertainties come from.", "Sweeps on a time line."})
    CHECK_THAT(words, ContainsSubstring(figure));
  CHECK_THAT(words, ContainsSubstring("All 6 joints are identified"));
  CHECK_THAT(words, ContainsSubstring("The numbers describe the controller's model"));
  CHECK_THAT(words, ContainsSubstring("not stated"));
  CHECK_THAT(words, ContainsSubstring("how far the target stands from where the fit to all sweeps "
                                      "(chain) has it"));
  std::istringstream csv(content(folder / "dh.csv"));
  std::string line;
  std::getline(csv, line);
  while (std::getline(csv, line)) {
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      if (!cell.empty()) CHECK_THAT(words, ContainsSubstring(" " + cell + " "));
  }
}

TEST_CASE("the page says why an angle is not compared", "[html_report]") {
  Outcome outcome = complete_outcome();
  CHECK_THAT(words_of(report_html(outcome)), !ContainsSubstring("“–” beside θ"));
  outcome.identification.home_rad[3].reset();
  CHECK_THAT(words_of(report_html(outcome)),
             ContainsSubstring("“–” beside θ: not compared, since the controller's angles at home "
                               "are not known: give --plan, or angles."));
}

TEST_CASE("start, link and the command that repeats a session are told as they are",
          "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  (void)folder.write("run.json", R"({"schema": "sweepd.run/1", "sweepd": "1", "command": "run",
    "started": "20261125T131930Z", "description": "robots/kr5_arc.toml"})");
  (void)folder.write("link.json", R"({"schema": "sweepd.link/1", "verdict": "bad",
    "reasons": [{"grade": "bad", "code": "lost", "message": "57 telegrams are lost"}]})");
  const ReportFolder read = read_report_folder(folder.path());
  const auto words = words_of(html_report(std::span(&read, 1)));
  CHECK_THAT(words, ContainsSubstring(" 2026-11-25 13:19:30 UTC "));
  CHECK_THAT(words, ContainsSubstring(" bad, see below "));
  CHECK_THAT(words, ContainsSubstring(" bad: 57 telegrams are lost  lost "));
  CHECK_THAT(words, ContainsSubstring("sweepd replay trace*.pcap --config SETTINGS"));
  CHECK_THAT(words, !ContainsSubstring("--robot robots/kr5_arc.toml"));
}

TEST_CASE(
    "axes that are given are no telegrams, and senses that nothing tells are said to be assumed",
    "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  ReportFolder read = read_report_folder(folder.path());
  CHECK_THAT(words_of(html_report(std::span(&read, 1))),
             ContainsSubstring(" one every ") && !ContainsSubstring("which way some of them move"));
  read.result["estimator"] = "axes";
  read.result["warnings"] = {{{"code", "direction_ambiguous"}, {"message", "nothing tells"}}};
  const auto words = words_of(html_report(std::span(&read, 1)));
  CHECK_THAT(words, ContainsSubstring(" 6 axes, given as lines "));
  CHECK_THAT(words, !ContainsSubstring(" telegrams, "));
  CHECK_THAT(words, ContainsSubstring("Nothing tells which way some of them move"));
}

TEST_CASE("the largest displacement is that of all points that are shown", "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  ReportFolder read = read_report_folder(folder.path());
  read.displacement_csv =
      "slice,x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,size_mm,band95_mm\n"
      ",0,0,100,1,0,0,1,0.02\n,0,0,200,2,0,0,2,0.02\n"
      "x,5,0,100,1,0,0,1,0.02\nx,5,50,300,2.5,0,0,2.5,0.03\n";
  CHECK_THAT(words_of(html_report(std::span(&read, 1))),
             ContainsSubstring("The largest of these and of the slices is 2.500 ± 0.030 mm (95 %) "
                               "at X 5, Y 50, Z 300 mm"));
}

TEST_CASE("the same files give the same bytes", "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  const auto first = content(folder / file_names::kReportPage);
  const ReportFolder read = read_report_folder(folder.path());
  CHECK(html_report(std::span(&read, 1)) == first);
}

TEST_CASE("singular values in figure 4 are those of the points", "[html_report]") {
  const Outcome outcome = complete_outcome();
  const auto words = words_of(report_html(outcome));
  const auto& joint = outcome.identification.joints[2];
  std::vector<Eigen::Vector3d> points;
  for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
    if (joint.used[s])
      for (const auto& sample : *joint.sweeps[s].samples) points.push_back(sample.position_mm);
  Eigen::MatrixXd n(points.size(), 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    n.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  n.rowwise() -= n.colwise().mean().eval();
  const Eigen::Vector3d sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(n).singularValues();
  CHECK_THAT(words, ContainsSubstring("σ₁ " + fixed(sigma(0), 1)));
  CHECK_THAT(words, ContainsSubstring("σ₂ " + fixed(sigma(1), 1)));
}

TEST_CASE("a circle too small to be seen beside the others has an inset", "[html_report]") {
  const TemporaryFolder folder;
  write_result(folder.path(), complete_outcome());
  auto read = read_report_folder(folder.path());
  CHECK_THAT(words_of(html_report(std::span(&read, 1))), !ContainsSubstring("-fold"));
  read.result["joints"][5]["circle"]["radius_mm"] = 10;
  CHECK_THAT(words_of(html_report(std::span(&read, 1))), ContainsSubstring("Joint 6, "));
  CHECK_THAT(words_of(html_report(std::span(&read, 1))), ContainsSubstring("-fold"));
}

TEST_CASE("whatever a run was, its report says so", "[html_report]") {
  SECTION("partial") {
    const auto html = report_html(partial_outcome());
    check_whole(html);
    CHECK_THAT(words_of(html), ContainsSubstring("3 of 6 joints have an axis"));
  }
  SECTION("failed") {
    const auto html = report_html(failed_outcome());
    check_whole(html);
    CHECK_THAT(words_of(html), ContainsSubstring("Nothing is identified"));
    CHECK_THAT(words_of(html), !ContainsSubstring("The circles"));
  }
  SECTION("doubtful") {
    Outcome outcome = complete_outcome();
    outcome.identification.status = identify::Status::doubtful;
    outcome.identification.reason = "is it this robot?";
    outcome.identification.doubts.push_back({"off_home", 0, "a circle passes 10 mm off"});
    const auto html = report_html(outcome);
    check_whole(html);
    CHECK_THAT(words_of(html), ContainsSubstring("Do not use it: is it this robot?"));
    CHECK_THAT(words_of(html), ContainsSubstring("a circle passes 10 mm off"));
  }
  SECTION("nothing specified") {
    const auto html = report_html(unspecified_outcome());
    check_whole(html);
    CHECK_THAT(html, !ContainsSubstring("difference ± U"));
  }
  SECTION("linear joints") {
    const auto html = report_html(scara_outcome());
    check_whole(html);
    const auto words = words_of(html);
    CHECK_THAT(words, ContainsSubstring("place, mm"));
    CHECK_THAT(words, ContainsSubstring("A2 60.000 deg, A3 100.000 mm, A4 -30.000 deg"));
    CHECK_THAT(words, ContainsSubstring("sweeps of 90°, 160 mm"));
    CHECK_THAT(words, ContainsSubstring("linear"));  // the type, in the other forms of the arm
  }
  SECTION("points without times") {
    Outcome outcome = complete_outcome();
    CHECK_THAT(words_of(report_html(outcome)), ContainsSubstring("Sweeps on a time line"));
    outcome.points.emplace();
    outcome.points->timed = false;
    CHECK_THAT(words_of(report_html(outcome)), !ContainsSubstring("Sweeps on a time line"));
  }
  SECTION("given axes") {
    Outcome outcome = complete_outcome();
    outcome.identification.estimator = identify::Estimator::axes;
    const auto words = words_of(report_html(outcome));
    CHECK_THAT(words, ContainsSubstring("describe the arm as the given axes have it"));
  }
  SECTION("the frame of a device, and no sweeps kept") {
    check_whole(report_html(chain_outcome()));
  }
  SECTION("axes without circles, as of static poses") {
    const TemporaryFolder folder;
    write_result(folder.path(), complete_outcome());
    auto read = read_report_folder(folder.path());
    CHECK_THAT(words_of(html_report(std::span(&read, 1))), ContainsSubstring("Fitted circle"));
    for (auto& joint : read.result["joints"]) joint.erase("circle");
    const auto words = words_of(html_report(std::span(&read, 1)));
    CHECK_THAT(words, ContainsSubstring("there are no circles"));
    CHECK_THAT(words, !ContainsSubstring("Fitted circle"));
  }
  SECTION("twelve joints") {
    const TemporaryFolder folder;
    write_result(folder.path(), complete_outcome());
    auto read = read_report_folder(folder.path());
    for (const char* const table : {"joints", "dh"})
      for (int k = 0; k < 6; ++k) read.result[table].push_back(read.result[table][0]);
    const auto html = html_report(std::span(&read, 1));
    check_whole(html);
    CHECK_THAT(words_of(html), ContainsSubstring("All 12 joints"));
  }
}

TEST_CASE("names and facts from outside are never markup", "[html_report]") {
  Outcome outcome = partial_outcome();
  outcome.robot = "<script>alert(1)</script>\"'&\n\u202Erobot\xFF";
  const TemporaryFolder folder;
  write_result(folder.path(), outcome);
  check_whole(content(folder / file_names::kReportPage));
  const ReportFolder read = read_report_folder(folder.path());
  const auto facts =
      read_facts(folder.write("facts.toml", "customer = \"<img src=x onerror=y>\"\n"));
  const auto html = html_report(std::span(&read, 1), facts);
  check_whole(html);
  CHECK_THAT(html, ContainsSubstring("&lt;img src=x"));
}

TEST_CASE("two folders stand beside each other, with table 4 under them", "[html_report]") {
  const TemporaryFolder folder;
  for (const char* const name : {"ninety", "thirty"}) {
    std::filesystem::create_directory(folder / name);
    write_result(folder / name, complete_outcome());
  }
  const std::array both{read_report_folder(folder / "ninety"),
                        read_report_folder(folder / "thirty")};
  const auto html = html_report(both);
  check_whole(html);
  const auto words = words_of(html);
  CHECK_THAT(words, ContainsSubstring("ninety: sweeps of"));
  CHECK_THAT(words, ContainsSubstring("thirty: sweeps of"));
  CHECK_THAT(words, ContainsSubstring("volume, m³"));
  // Components stand below each other, whatever their signs.
  constexpr std::string_view kVector = "<td class=\"number vector\">";
  std::set<std::size_t> widths;
  int vectors = 0;
  for (auto at = html.find(kVector); at != std::string::npos; at = html.find(kVector, at + 1)) {
    widths.insert(html.find("</td>", at) - at);
    ++vectors;
  }
  CHECK(vectors == 6);
  CHECK(widths.size() == 1);
}

TEST_CASE("beside sweeps, a folder without any says so", "[html_report]") {
  const TemporaryFolder folder;
  for (const char* const name : {"sweeps", "poses"}) {
    std::filesystem::create_directory(folder / name);
    write_result(folder / name, complete_outcome());
  }
  std::array both{read_report_folder(folder / "sweeps"), read_report_folder(folder / "poses")};
  both[1].strokes.clear();
  CHECK_THAT(words_of(html_report(both)), ContainsSubstring("poses: no sweeps"));
}

TEST_CASE("a result that others wrote, with less in it, still makes a report", "[html_report]") {
  for (const char* const result :
       {"{\"schema\": \"sweepd.result/1\"}",
        "{\"schema\": \"sweepd.result/1\", \"joints\": [{}, {\"joint\": 2, \"circle\": {}}], "
        "\"dh\": [{}], \"uncertainty_budget\": [], \"warnings\": []}",
        "{\"schema\": \"sweepd.result/1\", \"joints\": [{\"sweeps\": [{\"start_s\": 1, \"end_s\": "
        "2}]}], \"bounding_box\": {\"center\": [1, 2]}}"}) {
    const TemporaryFolder folder;
    (void)folder.write("result.json", result);
    const ReportFolder read = read_report_folder(folder.path());
    check_whole(html_report(std::span(&read, 1)));
  }
}
