#include "daemon/results/models_json.hpp"

#include <nlohmann/json.hpp>

#include "daemon/results/models.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/results/result_json.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"
#include "tests/daemon/temporary_folder.hpp"

using OrderedJson = nlohmann::ordered_json;
using namespace sweepd;
using namespace sweepd::test;

TEST_CASE("the models of result.json have every form, in full precision", "[models_json]") {
  const Outcome outcome = chain_outcome();
  const auto json = OrderedJson::parse(result_json(outcome)).at("models");
  REQUIRE(json.size() == 6);
  for (const char* form : {"dh", "modified_dh", "hayati", "s_model", "exponentials", "urdf"}) {
    INFO(form);
    CHECK(json.at(form).at("joints").size() == 6);
    CHECK(json.at(form).contains("tool"));
  }
  CHECK(json.at("dh").contains("base"));
  CHECK_FALSE(json.at("exponentials").contains("base"));
  const auto& row = outcome.identification.dh[2];
  const auto& joint = json.at("dh").at("joints").at(2);
  CHECK(joint.at("joint") == 3);
  CHECK(joint.at("a_mm").get<double>() == row.a_mm.value);
  CHECK(joint.at("theta_deg").get<double>() == degrees(row.theta_rad.value));
  CHECK(joint.at("a_sigma_mm").get<double>() == row.a_mm.sigma);
  CHECK(joint.at("by_convention") == OrderedJson{"beta_deg", "positive"});
  CHECK_FALSE(joint.contains("beta_sigma_deg"));
}

TEST_CASE("a complete chain leaves robot.urdf, dh.tex and models.csv; another takes them away",
          "[models_json]") {
  const TemporaryFolder folder;
  Outcome outcome = chain_outcome();
  const auto there = [&](const char* name) { return std::filesystem::exists(folder / name); };
  write_result(folder.path(), outcome);
  for (const char* name : {"robot.urdf", "dh.tex", "models.csv", "result.json"}) CHECK(there(name));
  outcome.identification.estimator = identify::Estimator::circle;
  write_result(folder.path(), outcome);
  for (const char* name : {"robot.urdf", "dh.tex", "models.csv"}) CHECK_FALSE(there(name));
  CHECK_FALSE(OrderedJson::parse(result_json(outcome)).contains("models"));
}
