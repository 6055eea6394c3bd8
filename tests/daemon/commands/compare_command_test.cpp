#include "daemon/commands/compare_command.hpp"

#include <cmath>
#include <sstream>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::compare;
using sweepd::CompareOptions;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// Results side by side in a folder, each in one of its own.
class ComparedResults {
 public:
  void write(const std::string& name, const sweepd::Outcome& outcome) {
    write(name, Json::parse(sweepd::result_json(outcome)));
  }
  void write(const std::string& name, const Json& json) {
    fs::create_directory(folder_ / name);
    (void)folder_.write(name + "/result.json", json.dump());
  }
  [[nodiscard]] int exit_code(bool json = false) {
    std::ostringstream out;
    const int code = compare({folder_ / "a", folder_ / "b", 0.05, json}, out);
    text = out.str();
    return code;
  }
  /// Why the two cannot be compared.
  [[nodiscard]] std::string refusal() {
    try {
      (void)exit_code();
    } catch (const std::runtime_error& problem) {
      return problem.what();
    }
    return "";
  }
  [[nodiscard]] fs::path path() const { return folder_.path(); }

  std::string text;

 private:
  TemporaryFolder folder_;
};

Json complete() {
  auto outcome = sweepd::test::complete_outcome();
  outcome.positive = identify::test::kr5_arc().positive;
  return Json::parse(sweepd::result_json(outcome));
}

/// As where the target is on axis 6, or joint 6 never turned.
Json without_last_axis(Json json) {
  for (auto& number : json["dh"][4].items())
    if (number.key() != "joint" && number.key() != "positive") number.value() = nullptr;
  json["dh"][4]["relation"] = "unknown";
  json.erase("models");
  Json names = Json::array(), rows = Json::array();
  Json& covariance = json["covariance"];
  const auto kept = [&](std::size_t k) {
    return covariance["names"][k].get<std::string>().find('5') == std::string::npos;
  };
  for (std::size_t r = 0; r < covariance["names"].size(); ++r) {
    if (!kept(r)) continue;
    names.push_back(covariance["names"][r]);
    Json row = Json::array();
    for (std::size_t k = 0; k < covariance["rows"][r].size(); ++k)
      if (kept(k)) row.push_back(covariance["rows"][r][k]);
    rows.push_back(std::move(row));
  }
  covariance = {{"names", names}, {"rows", rows}};
  json["status"] = "partial";
  json["reason"] = "no axis for joint 6";
  return json;
}

Json compared_number(const std::string& text, const std::string& name) {
  const Json json = Json::parse(text);
  for (const Json& number : json["numbers"])
    if (number["name"] == Json(name)) return number;
  FAIL("there is no " + name);
  return {};
}

}  // namespace

TEST_CASE("the same result twice has not changed, and that is said to be little",
          "[compare_command][long]") {
  ComparedResults results;
  results.write("a", complete());
  results.write("b", complete());
  CHECK(results.exit_code() == 0);
  CHECK_THAT(results.text,
             Catch::Matchers::StartsWith("No change seen: ") &&
                 ContainsSubstring("A and B are the same result") &&
                 ContainsSubstring("Both are the controller's model") &&
                 ContainsSubstring("left out  b1, zero1") &&
                 ContainsSubstring("all differences, noise included, move it by up to"));
}

TEST_CASE("a result that was made without the specified table is of the same arm",
          "[compare_command][long]") {
  ComparedResults results;
  results.write("a", complete());
  results.write("b", sweepd::test::unspecified_outcome());
  CHECK(results.exit_code(true) == 0);
  const Json json = Json::parse(results.text);
  CHECK(json["degrees_of_freedom"] == Json(18));
  CHECK(json["t_squared"].get<double>() < 1e-2);  // of the same samples: what rounding leaves
}

TEST_CASE("a zero that moved by ten times its uncertainty is named, alone",
          "[compare_command][long]") {
  ComparedResults results;
  Json later = complete();
  const double sigma = later["dh"][3]["theta_sigma_deg"].get<double>();
  later["dh"][3]["theta_deg"] = later["dh"][3]["theta_deg"].get<double>() + 10 * sigma;
  results.write("a", complete());
  results.write("b", later);
  CHECK(results.exit_code() == 3);
  CHECK_THAT(results.text, Catch::Matchers::StartsWith("Changed: zero4 by -"));
  CHECK(results.exit_code(true) == 3);
  const Json json = Json::parse(results.text);
  CHECK(json["verdict"] == Json("changed"));
  const Json zero4 = compared_number(results.text, "zero4_deg");
  CHECK(zero4["changed"] == Json(true));
  CHECK(zero4["difference"].get<double>() == Approx(-10 * sigma).epsilon(0.01));
  CHECK(zero4["sigma"].get<double>() == Approx(std::sqrt(2) * sigma).epsilon(0.01));
  CHECK(compared_number(results.text, "zero5_deg")["changed"] == Json(false));
  CHECK(json["displacement_by_changes"]["low_mm"].get<double>() > 0);
}

TEST_CASE("what only tells where base, tool and home are does not count",
          "[compare_command][long]") {
  ComparedResults results;
  Json later = complete();
  later["dh"][0]["b_mm"] = 17;
  later["dh"][0]["theta_deg"] = 17;
  later["tool"]["point_mm"] = {1, 2, 3};
  for (std::size_t j = 1; j < 5; ++j) {  // each turned by 30 degrees, about -Z of its row
    later["home_deg"][j] = later["home_deg"][j].get<double>() + 30;
    later["dh"][j]["theta_deg"] = later["dh"][j]["theta_deg"].get<double>() - 30;
  }
  results.write("a", complete());
  results.write("b", later);
  CHECK(results.exit_code(true) == 0);
  CHECK(Json::parse(results.text)["t_squared"].get<double>() < 1e-2);
}

TEST_CASE("a zero is no better known than gears and printed angles are",
          "[compare_command][long]") {
  ComparedResults results;
  Json first = complete();
  first["describes"] = "arm";
  for (Json& angles : first["estimates"]["chain"]["angles"]) {
    angles["trust"] = "smooth";
    angles["error_rms_arcsec"] = 20;
    angles["remainder_rms_arcsec"] = angles["expected_rms_arcsec"] = 0;
  }
  Json later = first;
  const auto sigma = [&] {
    results.write("a", first);
    results.write("b", later);
    (void)results.exit_code(true);
    return compared_number(results.text, "zero3_deg")["sigma"].get<double>();
  };
  const double same_home = sigma();
  CHECK(same_home < 1e-3);
  later["home_deg"][2] = later["home_deg"][2].get<double>() + 45;
  later["dh"][2]["theta_deg"] = later["dh"][2]["theta_deg"].get<double>() - 45;
  // Joint 3 swept 90 degrees, others less: what it is off by grows from 20 arcsec at sqrt(1/12) of
  // that, and no less than it does on average.
  CHECK(sigma() == Approx(20.0 / 3600 * std::sqrt(3)).epsilon(0.1));
  CHECK_THAT(results.text, ContainsSubstring("The homes are apart in joint 3."));
  later = first;
  later["angle_step_deg"] = 0.1;
  CHECK(sigma() == Approx(0.1 / std::sqrt(12)).epsilon(1e-3));
}

TEST_CASE("where an axis is open, the joints before it are compared", "[compare_command][long]") {
  ComparedResults results;
  Json whole = complete();
  results.write("a", whole);
  results.write("b", without_last_axis(whole));
  CHECK(results.exit_code() == 0);
  CHECK_THAT(results.text, ContainsSubstring("The data leave axis 6 open in one of the two.") &&
                               ContainsSubstring("rows 5 to 6 (open).") &&
                               ContainsSubstring("zero4") && !ContainsSubstring("zero5"));
  const auto other = GENERATE(0, 1);
  whole["dh"][3]["theta_deg"] = whole["dh"][3]["theta_deg"].get<double>() + 0.1;
  results.write("a", other == 0 ? whole : without_last_axis(whole));
  CHECK(results.exit_code(true) == 3);
  CHECK(Json::parse(results.text)["joints"].get<int>() == 5);
  CHECK(compared_number(results.text, "zero4_deg")["changed"].get<bool>());
}

TEST_CASE("the controller's model and an arm are not compared", "[compare_command]") {
  ComparedResults results;
  Json arm = complete();
  arm["describes"] = "arm";
  results.write("a", complete());
  results.write("b", arm);
  CHECK_THAT(results.refusal(),
             ContainsSubstring("a/result.json has the controller's model") &&
                 ContainsSubstring("b/result.json has the arm, as a device measured it") &&
                 ContainsSubstring("compare two of a kind"));
}

TEST_CASE("what cannot be compared is refused with a reason", "[compare_command]") {
  ComparedResults results;
  results.write("a", complete());
  Json other = complete();
  SECTION("failed") {
    results.write("b", sweepd::test::failed_outcome());
    CHECK_THAT(results.refusal(), ContainsSubstring("is a failed result"));
  }
  SECTION("without some axes") {
    results.write("b", sweepd::test::partial_outcome());
    CHECK_THAT(results.refusal(), ContainsSubstring("does not know enough of the table (no "
                                                    "axis for joints 3, 5, 6)"));
  }
  SECTION("with axes open, by a sweepd that did not tell senses") {
    other = without_last_axis(other);
    for (Json& row : other["dh"]) row.erase("positive");
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("was written by an earlier sweepd"));
  }
  SECTION("of another version") {
    other["schema"] = "sweepd.result/2";
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("has the schema sweepd.result/2"));
  }
  SECTION("no result") {
    other["schema"] = "sweepd.run/1";
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("holds no result of sweepd"));
  }
  SECTION("not there") {
    CHECK_THAT(results.refusal(), ContainsSubstring("cannot be read: No such file or directory: "));
  }
  SECTION("without covariance") {
    other.erase("covariance");
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("has no covariance"));
  }
  SECTION("a covariance that somebody broke") {
    const auto broken = GENERATE(0, 1, 2, 3);
    if (broken == 0) other["covariance"]["rows"].erase(3);
    if (broken == 1) other["covariance"]["rows"][2].erase(3);
    if (broken == 2) other["covariance"]["rows"][2][4] = "0";
    if (broken == 3) other["covariance"]["names"][2] = "b17_mm";
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("has no covariance"));
  }
  SECTION("of other joints") {
    other["dh"][4]["variable"] = "b_mm";
    results.write("b", other);
    CHECK_THAT(results.refusal(), ContainsSubstring("the linear joints of "));
  }
  CHECK(results.text.empty());
}

TEST_CASE("doubtful results and other robots are compared, and named", "[compare_command][long]") {
  ComparedResults results;
  Json doubtful = complete();
  doubtful["status"] = "doubtful";
  doubtful["reason"] = "two strokes contradict each other";
  doubtful["robot"] = "other";
  results.write("a", complete());
  results.write("b", doubtful);
  CHECK(results.exit_code() == 0);
  CHECK_THAT(results.text, ContainsSubstring("B is doubtful: two strokes contradict each other.") &&
                               ContainsSubstring("A is of the robot kr5-arc, B of other."));
  doubtful["reason"] = "all lengths are 1000 times larger than specified: are they in metres?";
  for (auto& row : doubtful["dh"])
    for (const char* const key : {"b_mm", "a_mm"})
      if (row[key].is_number()) row[key] = -1000 * row[key].get<double>();
  results.write("b", doubtful);
  CHECK(results.exit_code() == 3);
  CHECK_THAT(results.text, ContainsSubstring("metres?\n"));
  // Columns do not run into each other.
  const double a1_mm = complete()["dh"][0]["a_mm"], false_mm = doubtful["dh"][0]["a_mm"];
  CHECK_THAT(results.text,
             ContainsSubstring(fmt::format("{:.6f} {:.6f}", false_mm, false_mm - a1_mm)));
}
