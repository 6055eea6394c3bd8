#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include <nlohmann/json.hpp>

#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/outcomes.hpp"

using OrderedJson = nlohmann::ordered_json;
using identify::Knowledge;
using sweepd::Outcome;
using sweepd::result_json;
using namespace sweepd::test;
using namespace std::chrono_literals;

namespace {

OrderedJson parsed(const Outcome& outcome) {
  return OrderedJson::parse(result_json(outcome));
}

/// Calls `visit` with each number of the document and the name that it stands under.
void for_each_number(const OrderedJson& json, const std::string& name,
                     const std::function<void(const std::string&, const OrderedJson&)>& visit) {
  if (json.is_number()) visit(name, json);
  if (json.is_array())
    for (const auto& item : json) for_each_number(item, name, visit);
  if (json.is_object())
    for (const auto& [key, value] : json.items()) for_each_number(value, key, visit);
}

const std::vector<std::string> kNumbers{"b_mm", "theta_deg", "a_mm", "alpha_deg"};
const std::vector<std::string> kSigmas{"b_sigma_mm", "theta_sigma_deg", "a_sigma_mm",
                                       "alpha_sigma_deg"};

}  // namespace

TEST_CASE("a complete result has every field of the schema, in its type and unit",
          "[result_json]") {
  const auto json = parsed(complete_outcome());
  CHECK(json.at("schema") == "sweepd.result/1");
  CHECK(json.at("robot") == "kr5-arc");
  CHECK(json.at("status") == "complete");
  CHECK_FALSE(json.contains("reason"));
  CHECK(json.at("describes") == "controller_model");  // a trace
  CHECK(json.at("estimator") == "chain");
  REQUIRE(json.at("home_deg").size() == 6);
  // Means over strokes of some hundred samples with a wobble of 0.0001 deg.
  CHECK(json.at("home_deg")[1].get<double>() == Approx(-90).margin(1e-4));

  const auto& source = json.at("source");
  CHECK(source.at("kind") == "trace");
  for (const char* count : {"telegrams", "lost", "duplicated", "reordered", "malformed"}) {
    INFO(count);
    CHECK(source.at(count).is_number_unsigned());
  }
  CHECK(source.at("cycle_ms") == 4.0);
  CHECK(source.at("cycle_ms").is_number_float());

  REQUIRE(json.at("joints").size() == 6);
  int number = 0;
  for (const auto& joint : json.at("joints")) {
    CHECK(joint.at("joint") == ++number);
    REQUIRE_FALSE(joint.at("sweeps").empty());
    double before = -1;
    for (const auto& sweep : joint.at("sweeps")) {
      CHECK(sweep.at("samples").get<std::size_t>() > 20);
      CHECK(sweep.at("start_s").get<double>() > before);
      CHECK(sweep.at("end_s").get<double>() > sweep.at("start_s").get<double>());
      before = sweep.at("end_s").get<double>();
      CHECK(sweep.at("range_deg").get<double>() > 20);
      CHECK(std::abs(sweep.at("direction").get<int>()) == 1);
    }
    const auto& axis = joint.at("axis");
    CHECK(axis.at("direction").size() == 3);
    CHECK(axis.at("point").size() == 3);
    CHECK(axis.at("direction_sigma_deg").get<double>() > 0);
    CHECK(axis.at("direction_sigma_deg").get<double>() < 0.01);
    CHECK(axis.at("point_sigma_mm").get<double>() > 0);
    const auto& circle = joint.at("circle");
    CHECK(circle.at("center").size() == 3);
    CHECK(circle.at("normal").size() == 3);
    CHECK(circle.at("radius_mm").get<double>() > 100);
    CHECK(circle.at("arc_deg").get<double>() > 69);
    CHECK(circle.at("plane_rms_mm").get<double>() < 0.01);
    CHECK(circle.at("radial_rms_mm").get<double>() < 0.01);
  }

  for (const char* table : {"dh", "specified", "difference"}) {
    INFO(table);
    REQUIRE(json.at(table).size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(json[table][i].at("joint") == i + 1);
      for (const auto& name : kNumbers) CHECK(json[table][i].contains(name));
    }
  }
  for (const auto& row : json.at("dh")) {
    for (const auto& sigma : kSigmas) CHECK(row.contains(sigma));
    CHECK(row.at("relation").is_string());
  }
  CHECK(json.at("estimates").at("chain").at("dh") == json.at("dh"));
  CHECK(json.at("estimates").at("circle").at("dh").size() == 6);

  const auto& box = json.at("bounding_box");
  const auto lengths = box.at("lengths_mm").get<std::vector<double>>();
  REQUIRE(lengths.size() == 3);
  CHECK(lengths[0] >= lengths[1]);
  CHECK(lengths[1] >= lengths[2]);
  // Both are rounded.
  CHECK(box.at("volume_m3").get<double>() ==
        Approx(lengths[0] * lengths[1] * lengths[2] * 1e-9).epsilon(1e-6));
  CHECK(box.at("center").size() == 3);
  REQUIRE(box.at("orientation").size() == 3);
  CHECK(box.at("orientation")[0].size() == 3);
  CHECK(json.at("warnings").is_array());
}

TEST_CASE("each number has its 95 % interval, and beta stands where axes are parallel",
          "[result_json]") {
  const auto json = parsed(complete_outcome());
  const auto& row = json.at("dh")[0];
  const double half = 1.96 * row.at("b_sigma_mm").get<double>();
  // Value, sigma and ends are rounded to 1e-6 each.
  CHECK(row.at("b_low_mm").get<double>() ==
        Approx(row.at("b_mm").get<double>() - half).margin(3e-6));
  CHECK(row.at("b_high_mm").get<double>() ==
        Approx(row.at("b_mm").get<double>() + half).margin(3e-6));
  CHECK_FALSE(row.contains("beta_deg"));
  const auto& parallel = json.at("dh")[1];
  CHECK(parallel.at("b_low_mm").is_null());
  CHECK(parallel.at("beta_deg").is_number());
  CHECK(parallel.at("beta_sigma_deg").get<double>() > 0);
  CHECK(parallel.at("beta_high_deg") > parallel.at("beta_low_deg"));
}

TEST_CASE("the chain's evidence is part of the result", "[result_json]") {
  const auto chain = parsed(complete_outcome()).at("estimates").at("chain");
  CHECK(chain.at("summary").at("converged") == true);
  CHECK(chain.at("summary").at("undetermined").is_number());
  CHECK(chain.at("samples").get<std::size_t>() > 1000);
  CHECK(chain.at("outliers") == 0);
  CHECK(chain.at("shared_home") == true);
  CHECK(chain.at("with_orientation") == false);
  CHECK(chain.at("noise").at("orientation_deg").is_null());
  REQUIRE(chain.at("noise").at("swept_deg").size() == 6);
  CHECK(chain.at("noise").at("swept_deg")[0].is_number());
  REQUIRE(chain.at("angles").size() == 6);
  const auto& joint = chain.at("angles")[0];
  CHECK(joint.at("trust") == "trusted");
  CHECK_FALSE(joint.at("reason").get<std::string>().empty());
  for (const char* name : {"error_rms_arcsec", "remainder_rms_arcsec", "expected_rms_arcsec",
                           "size", "coherence", "remainder_coherence"})
    CHECK(joint.at(name).is_number());
  CHECK(joint.at("curve").size() == 6);
  CHECK(joint.at("backlash_arcsec").is_null());  // swept one way
}

TEST_CASE("angles that are not used have no noise, and a joint's box is its own", "[result_json]") {
  auto outcome = complete_outcome();
  outcome.identification.chain->noise.swept_rad[2] = std::numeric_limits<double>::infinity();
  const auto json = parsed(outcome);
  CHECK(json["estimates"]["chain"]["noise"]["swept_deg"][2].is_null());
  const auto& box = json.at("joints")[5].at("bounding_box");
  // Joint 6 carries the target round a circle of 200 mm, by 90 degrees.
  CHECK(box.at("lengths_mm")[0].get<double>() == Approx(200 * std::sqrt(2)).margin(0.5));
  CHECK(box.at("gap").is_number());
}

TEST_CASE("lengths are in mm, angles in degrees", "[result_json]") {
  const auto json = parsed(complete_outcome());
  const auto& dh = json.at("dh");
  // A wobble of 0.0001 deg at a metre is 0.002 mm, and hundreds of samples share it.
  CHECK(dh[0].at("b_mm").get<double>() == Approx(400).margin(0.02));
  CHECK(dh[0].at("a_mm").get<double>() == Approx(180).margin(0.02));
  CHECK(dh[0].at("theta_deg").get<double>() == Approx(-90).margin(1e-3));
  CHECK(dh[0].at("alpha_deg").get<double>() == Approx(90).margin(1e-3));
  CHECK(json.at("specified")[3].at("b_mm") == 620.0);
  // Specified for the home of this campaign, which is a mean over a wobble.
  CHECK(json.at("specified")[3].at("theta_deg").get<double>() == Approx(180).margin(1e-4));
  CHECK(json.at("specified")[3].at("alpha_deg") == 90.0);
}

TEST_CASE("the columns of the orientation are the axes of the box, longest first",
          "[result_json]") {
  const auto outcome = complete_outcome();
  const auto json = parsed(outcome);
  const auto& box = *outcome.identification.bounding_box;
  for (Eigen::Index row = 0; row < 3; ++row)
    for (Eigen::Index column = 0; column < 3; ++column)
      CHECK(json["bounding_box"]["orientation"][static_cast<std::size_t>(row)]
                [static_cast<std::size_t>(column)]
                    .get<double>() == Approx(box.orientation(row, column)).margin(1e-8));
}

TEST_CASE("what convention sets is named, has no uncertainty and no difference", "[result_json]") {
  const auto json = parsed(complete_outcome());
  const auto& parallel = json.at("dh")[1];  // axes 2 and 3: b is free
  CHECK(parallel.at("relation") == "parallel");
  CHECK(parallel.at("b_mm") == 0.0);
  CHECK(parallel.at("b_sigma_mm").is_null());
  CHECK(parallel.at("by_convention") == OrderedJson({"b_mm"}));
  CHECK(json.at("difference")[1].at("b_mm").is_null());
  CHECK(json.at("difference")[1].at("a_mm").is_number());

  const auto& last = json.at("dh")[5];  // needs a frame on the end-effector
  CHECK(last.at("relation") == "last");
  CHECK(last.at("by_convention") == OrderedJson({"b_mm", "theta_deg", "a_mm", "alpha_deg"}));
  for (const auto& sigma : kSigmas) CHECK(last.at(sigma).is_null());
  for (const auto& name : kNumbers) CHECK(json.at("difference")[5].at(name).is_null());

  CHECK_FALSE(json.at("dh")[0].contains("by_convention"));
}

TEST_CASE("a difference is identified minus specified", "[result_json]") {
  const auto json = parsed(complete_outcome());
  for (std::size_t i = 0; i < 6; ++i)
    for (const auto& name : kNumbers) {
      const auto& difference = json["difference"][i][name];
      if (difference.is_null()) continue;
      INFO(name << " of row " << i + 1);
      const double raw =
          json["dh"][i][name].get<double>() - json["specified"][i][name].get<double>();
      const double full_turns = name.ends_with("_deg") ? 360 * std::round(raw / 360) : 0;
      CHECK(difference.get<double>() == Approx(raw - full_turns).margin(1e-6));  // of rounding
    }
}

TEST_CASE("a doubtful result has all its numbers and says every doubt", "[result_json]") {
  auto outcome = complete_outcome();
  CHECK_FALSE(parsed(outcome).contains("doubts"));
  outcome.identification.doubts = {{"frame_mirrored", {}, "the frame is mirrored"},
                                   {"circle_misfit", 2, "joint 3: no circle"}};
  identify::apply_doubts(outcome.identification);
  const auto json = parsed(outcome);
  CHECK(json.at("status") == "doubtful");
  CHECK(json.at("reason") == "the frame is mirrored");
  REQUIRE(json.at("doubts").size() == 2);
  CHECK(json["doubts"][0]["code"] == "frame_mirrored");
  CHECK_FALSE(json["doubts"][0].contains("joint"));
  CHECK(json["doubts"][1]["joint"] == 3);
  CHECK(json.at("dh") == parsed(complete_outcome()).at("dh"));
}

TEST_CASE("a partial result says why, and null for what the data cannot determine",
          "[result_json]") {
  const auto json = parsed(partial_outcome());
  CHECK(json.at("status") == "partial");
  CHECK_FALSE(json.at("reason").get<std::string>().empty());
  REQUIRE(json.at("joints").size() == 6);
  CHECK(json["joints"][0].contains("axis"));
  CHECK_FALSE(json["joints"][2].contains("axis"));
  CHECK_FALSE(json["joints"][2].contains("circle"));
  CHECK(json["joints"][2]["sweeps"].empty());
  REQUIRE(json.at("dh").size() == 6);
  const auto& row = json["dh"][1];  // axis 3 is missing
  for (const auto& name : {"a_mm", "alpha_deg", "theta_deg"}) {
    INFO(name);
    CHECK(row.at(name).is_null());
  }
  for (const auto& sigma : kSigmas) CHECK(row.at(sigma).is_null());
  CHECK(json["difference"][1]["a_mm"].is_null());
  CHECK(json["dh"][0]["a_mm"].is_number());
  bool warned = false;
  for (const auto& warning : json.at("warnings"))
    warned = warned || (warning.at("code") == "joint_never_moved" && warning.at("joint") == 3 &&
                        !warning.at("message").get<std::string>().empty());
  CHECK(warned);
}

TEST_CASE("what only Delay or times could tell is null, not nought",
          "[result_json][issue11][point_15]") {
  auto outcome = failed_outcome();
  outcome.counts.cycle = 4'001'234ns;
  outcome.counts.link.late_replies = 3;
  outcome.counts.link.late_runs = 2;
  auto source = parsed(outcome).at("source");
  CHECK(source.at("cycle_ms") == 4.001);
  CHECK(source.at("late_replies") == 3);
  CHECK(source.at("late_runs") == 2);
  outcome.counts.cycle.reset();
  outcome.counts.link.late_replies.reset();
  source = parsed(outcome).at("source");
  for (const char* unknown : {"cycle_ms", "late_replies", "late_runs", "longest_late_run"}) {
    INFO(unknown);
    CHECK(source.at(unknown).is_null());
  }
}

TEST_CASE("a failed result is one too: status, reason, source, no number made up",
          "[result_json]") {
  auto outcome = failed_outcome();
  outcome.counts.cycle.reset();
  const auto json = parsed(outcome);
  CHECK(json.at("status") == "failed");
  CHECK_FALSE(json.at("reason").get<std::string>().empty());
  CHECK(json.at("source").at("telegrams") == outcome.counts.link.telegrams);
  CHECK(json.at("source").at("cycle_ms").is_null());
  CHECK_FALSE(json.contains("home_deg"));
  CHECK_FALSE(json.contains("bounding_box"));
  for (const auto& row : json.at("dh"))
    for (const auto& name : kNumbers)
      CHECK((row.at(name).is_null() ||
             row.at("by_convention").dump().find(name) != std::string::npos));
  for (const auto& row : json.at("difference"))
    for (const auto& name : kNumbers) CHECK(row.at(name).is_null());
}

TEST_CASE("the result of no identification at all is valid too", "[result_json]") {
  const auto json = parsed({});
  CHECK(json.at("status") == "failed");
  CHECK(json.at("joints").empty());
  CHECK(json.at("dh").empty());
  CHECK(json.at("warnings").empty());
}

TEST_CASE("without a specified table there is neither it nor a difference", "[result_json]") {
  const auto json = parsed(unspecified_outcome());
  CHECK(json.at("status") == "complete");
  CHECK_FALSE(json.contains("specified"));
  CHECK_FALSE(json.contains("difference"));
}

TEST_CASE("malformed datagrams are told by kind where there are any", "[result_json]") {
  auto outcome = failed_outcome();
  CHECK_FALSE(parsed(outcome).at("source").contains("malformed_by_kind"));
  outcome.counts.malformed[static_cast<std::size_t>(rsi::Defect::truncated)] = 3;
  outcome.counts.malformed[static_cast<std::size_t>(rsi::Defect::empty)] = 2;
  const auto source = parsed(outcome).at("source");
  CHECK(source.at("malformed") == 5);
  CHECK(source.at("malformed_by_kind") == OrderedJson({{"empty", 2}, {"truncated", 3}}));
}

TEST_CASE("positioning strokes are marked, and what was used is told", "[result_json]") {
  const auto json = parsed(complete_outcome());
  const auto& sweeps = json["joints"][0]["sweeps"];
  REQUIRE(sweeps.size() == 3);  // home to start, the sweep, end to home
  CHECK(sweeps[0].at("positioning") == true);
  CHECK(sweeps[0].at("used") == false);
  CHECK_FALSE(sweeps[1].contains("positioning"));
  CHECK(sweeps[1].at("used") == true);
}

TEST_CASE("numbers are rounded, but in models: a nanometre, and as little of an angle",
          "[result_json]") {
  auto json = parsed(complete_outcome());
  json.erase("models");
  for_each_number(json, "", [](const std::string& name, const OrderedJson& number) {
    const double value = number.get<double>();
    const double unit = name.ends_with("_mm")    ? 1e-6
                        : name.ends_with("_deg") ? 1e-7
                        : name.ends_with("_s")   ? 1e-6
                        : name == "volume_m3"    ? 1e-12
                        : name == "gap"          ? 1e-15
                                                 : 1e-9;
    INFO(name << " " << number.dump());
    CHECK(std::isfinite(value));
    if (name == "rows") return;  // of the covariance: its numbers have no smallest unit
    // Of doubles near 1000 the last bit is 1e-13.
    CHECK(std::abs(value / unit - std::round(value / unit)) < 1e-2);
    CHECK_FALSE((value == 0 && std::signbit(value)));
  });
}

TEST_CASE("a number that is not finite is null, never NaN", "[result_json]") {
  auto outcome = complete_outcome();
  auto& found = outcome.identification;
  found.dh[0].b_mm.value = std::numeric_limits<double>::quiet_NaN();
  found.dh[0].a_mm.sigma = std::numeric_limits<double>::infinity();
  found.joints[0].axis->covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto text = result_json(outcome);
  const auto json = OrderedJson::parse(text);
  CHECK(json["dh"][0]["b_mm"].is_null());
  CHECK(json["dh"][0]["a_sigma_mm"].is_null());
  CHECK(text.find("nan") == std::string::npos);
  CHECK(text.find("inf") == std::string::npos);
}

TEST_CASE("the same outcome gives the same bytes, in lines that a person can read",
          "[result_json]") {
  const auto text = result_json(complete_outcome());
  CHECK(text == result_json(complete_outcome()));
  CHECK(text.ends_with("}\n"));
  std::size_t begin = 0;
  while (begin < text.size()) {
    const auto end = text.find('\n', begin);
    // But for the rows of the covariance, which are as long as there are numbers.
    const bool row =
        text.find_first_not_of(" [", begin) == text.find_first_of("-0123456789", begin);
    if (!row) CHECK(end - begin < 240);
    begin = end + 1;
  }
}

TEST_CASE("any bytes in a name or a message give valid JSON", "[result_json]") {
  auto outcome = failed_outcome();
  outcome.robot = "quote\" backslash\\ tab\t";
  outcome.identification.warnings.push_back({"code", {}, "4°"});
  CHECK(parsed(outcome).at("robot") == outcome.robot);
  outcome.robot = "latin-1 \xe4";  // the name of a file, say
  CHECK_NOTHROW(parsed(outcome));
}
