#include "daemon/commands/plan_command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "daemon/plan/plan_proposal.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using sweepd::test::content;
using sweepd::test::kConfig;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// Coarse enough to be quick, fine enough for sweeps of a second.
constexpr int kCycle_ms = 16;

/// Of a proposal, which rehearses many plans.
constexpr int kProposal_ms = 32;

PlanOptions options_of(const fs::path& plan = kConfig / "plans/kr5_arc_90deg.toml",
                       int cycle_ms = kCycle_ms) {
  PlanOptions options;
  options.robot = kConfig / "robots/kr5_arc.toml";
  options.plan = plan;
  options.cycle_ms = cycle_ms;
  return options;
}

struct Planned {
  int code;
  std::string text;
  std::string errors;
};

Planned run(const PlanOptions& options) {
  std::ostringstream out;
  std::ostringstream errors;
  const int code = plan(options, out, errors);
  return {code, out.str(), errors.str()};
}

std::string error_of(const PlanOptions& options) {
  try {
    const auto planned = run(options);
    return "no error, exit " + std::to_string(planned.code);
  } catch (const ConfigError& error) {
    return error.what();
  }
}

/// The 90 degree set with other text in it.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = content(kConfig / "plans/kr5_arc_90deg.toml");
  text.replace(text.find(from), from.size(), to);
  return text;
}

/// With everything that could be written, into `folder`.
PlanOptions writing(PlanOptions options, const TemporaryFolder& folder) {
  options.krl = KrlDialect::krc4;
  options.output = folder / "krl";
  return options;
}

Measurement coarse(int cycle_ms = kCycle_ms) {
  Measurement measurement;
  measurement.cycle = std::chrono::milliseconds(cycle_ms);
  return measurement;
}

/// Where a line ends depends on the length of a path in it.
std::string words(const std::string& text) {
  std::istringstream in(text);
  std::string all;
  for (std::string word; in >> word;) all += word + ' ';
  return all;
}

}  // namespace

TEST_CASE("plan says what the program will do, and how certain each number will be",
          "[plan_command][plan][long]") {
  const auto planned = run(options_of());
  CHECK(planned.code == 0);
  CHECK(planned.errors.empty());
  CHECK_THAT(planned.text, ContainsSubstring("KR 5 arc"));
  CHECK_THAT(words(planned.text), ContainsSubstring(" takes 44.3 s "));
  CHECK_THAT(planned.text, ContainsSubstring("    2      2     -60.000    -130.000        20.00"));
  CHECK_THAT(planned.text, ContainsSubstring("    6             200.00"));
  CHECK_THAT(planned.text, ContainsSubstring("    2   b      mm         0.0000        (set)"));
  CHECK_THAT(planned.text, ContainsSubstring("to the next axis: parallel"));
  CHECK(planned.text.find("Proposal") == std::string::npos);

  auto tracker = options_of();
  tracker.position_sigma_mm = 0.02;
  const auto measured = run(tracker);
  CHECK(measured.code == 0);
  CHECK_THAT(measured.text, ContainsSubstring("by another device, to 0.02 mm"));
  CHECK_THAT(measured.text, ContainsSubstring("    1   b      mm       400.0000        (set)"));
}

TEST_CASE("a plan beyond the limits of the robot is refused with all reasons",
          "[plan_command][plan]") {
  const TemporaryFolder folder;
  std::string text = changed("start_deg = -45.0", "start_deg = -160.0");
  text.replace(text.find("end_deg = 30.0"), 14, "end_deg = -20.0");
  text.replace(text.rfind("speed_deg_s = 20.0"), 18, "speed_deg_s = 800.0");
  text.replace(text.find("positioning_speed_deg_s = 60.0"), 30, "positioning_speed_deg_s = 200.0");
  const auto file = folder.write("plan.toml", text);
  const std::string error = error_of(writing(options_of(file), folder));
  INFO(error);
  CHECK_THAT(error, ContainsSubstring("sweep.start_deg: expected joint 1 from -155 to 155 degrees, "
                                      "found -160"));
  CHECK_THAT(error, ContainsSubstring("sweep.end_deg: expected joint 3 from -15 to 158 degrees, "
                                      "found -20"));
  CHECK_THAT(error, ContainsSubstring("sweep.speed_deg_s: expected at most 721 degrees per second, "
                                      "as joint 6 can do no more, found 800"));
  CHECK_THAT(error, ContainsSubstring("positioning_speed_deg_s: expected at most 154 degrees per "
                                      "second, as joint 1 can do no more, found 200"));
  CHECK_FALSE(fs::exists(folder / "krl"));
}

TEST_CASE("a target on an axis is refused with the reason, and nothing is written",
          "[plan_command][plan][long]") {
  const auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  // Points of the axes of joints 1 to 6, seen from the frame after the last row.
  std::vector<double> home;
  for (const double angle_deg : robot.home_deg) home.push_back(radians(angle_deg));
  const Eigen::Isometry3d last = identify::forward_kinematics(*robot.arm, home);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < robot.joints(); ++j) {
    const Eigen::Vector3d on_axis = last.inverse() * (frame * Eigen::Vector3d(0, 0, 150));
    frame = frame * identify::transform(robot.arm->rows[j]);
    for (const bool device : {false, true}) {
      const TemporaryFolder folder;
      auto options = writing(options_of(), folder);
      options.tool_mm = {on_axis.x(), on_axis.y(), on_axis.z()};
      if (device) options.position_sigma_mm = 0.02;
      const auto planned = run(options);
      INFO("axis " << j + 1 << "\n" << planned.text << planned.errors);
      CHECK(planned.code == 1);
      CHECK_THAT(planned.errors,
                 ContainsSubstring("sweepd: joint " + std::to_string(j + 1) +
                                   ": the target point is 0.00 mm from its axis") &&
                     ContainsSubstring("would not be determined: choose a tool point"));
      CHECK_THAT(planned.text, ContainsSubstring("refused"));
      CHECK(fs::is_empty(folder.path()));
    }
  }
}

TEST_CASE("a target near an axis: what covariance says of it decides",
          "[plan_command][plan][long]") {
  auto options = options_of();
  options.tool_mm = {1.7, 0, 215};
  options.position_sigma_mm = 0.02;
  const auto by_device = run(options);
  CHECK(by_device.code == 1);
  CHECK_THAT(by_device.errors, ContainsSubstring("joint 6: the target point is 1.70 mm"));
  // The controller's own orientations tell the axis all the same.
  options.position_sigma_mm.reset();
  const auto by_controller = run(options);
  CHECK(by_controller.code == 0);
  CHECK_THAT(by_controller.text,
             ContainsSubstring("target close to it") && ContainsSubstring("[target_near_axis]"));
}

TEST_CASE("a sweep that would not be used is refused", "[plan_command][plan][long]") {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "plan.toml", changed("start_deg = 0.0\nend_deg = 90.0", "start_deg = 0.0\nend_deg = 4.0"));
  const auto planned = run(writing(options_of(file), folder));
  CHECK(planned.code == 1);
  CHECK_THAT(planned.errors, ContainsSubstring("sweep 6 (joint 6, 0 to 4 deg) would not be used: "
                                               "it is shorter than 5 degrees"));
  CHECK_FALSE(fs::exists(folder / "krl"));
}

TEST_CASE("the program is written for each controller", "[plan_command][plan][long]") {
  for (const auto dialect : {KrlDialect::krc2, KrlDialect::krc4}) {
    const TemporaryFolder folder;
    auto options = writing(options_of(), folder);
    options.krl = dialect;
    options.name = "my_sweeps";
    const auto planned = run(options);
    CHECK(planned.code == 0);
    CHECK_THAT(planned.text, ContainsSubstring((folder / "krl/my_sweeps.src").string()));
    const auto program =
        krl_program(load_plan(options.plan), {.dialect = dialect,
                                              .name = "my_sweeps",
                                              .rsi_file = {},
                                              .limits = load_robot(options.robot).limits});
    CHECK(content(folder / "krl/my_sweeps.src") == program.src);
    CHECK(content(folder / "krl/my_sweeps.dat") == program.dat);
  }
}

TEST_CASE("what KRL cannot express, and options that contradict each other, are told first",
          "[plan_command][plan]") {
  const TemporaryFolder folder;
  auto options = writing(options_of(), folder);
  options.name = "1st try";
  CHECK_THROWS_AS(run(options), std::invalid_argument);
  CHECK_THROWS_WITH(run(options), StartsWith("--name: expected a letter"));
  options.name = "";
  options.rsi_file = "a\"b";
  CHECK_THROWS_WITH(run(options), StartsWith("--rsi-file: expected a file name"));
  CHECK(fs::is_empty(folder.path()));
  auto no_program = options_of();
  no_program.name = "foo";
  CHECK_THROWS_WITH(run(no_program), StartsWith("--name: expected --krl"));
  no_program.name = "";
  no_program.rsi_file = "foo";
  CHECK_THROWS_WITH(run(no_program), StartsWith("--rsi-file: expected --krl"));

  auto no_folder = options_of();
  no_folder.krl = KrlDialect::krc2;
  CHECK_THROWS_AS(run(no_folder), std::invalid_argument);
  auto no_proposal = options_of();
  no_proposal.write_plan = folder / "plan.toml";
  CHECK_THROWS_AS(run(no_proposal), std::invalid_argument);
}

TEST_CASE("widened ranges keep to the limits, to 340 degrees, and to what was swept before",
          "[plan_command][plan]") {
  auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  const auto plan = load_plan(kConfig / "plans/kr5_arc_90deg.toml");
  const auto range = [&](std::size_t joint, double margin_deg) {
    const auto sweep = widened(plan, joint, robot, margin_deg).sweeps[joint - 1];
    return std::pair(sweep.start_deg, sweep.end_deg);
  };
  CHECK(range(1, 5) == std::pair(-150.0, 150.0));
  CHECK(range(2, 5) == std::pair(60.0, -175.0));  // falling, as before
  CHECK(range(3, 40) == std::pair(120.0, 25.0));  // before it kept less than the margin
  CHECK(range(6, 5) == std::pair(-125.0, 215.0));
  robot.limits[3] = {-350, 100};
  CHECK(range(4, 5) == std::pair(95.0, -245.0));
  robot.limits[3] = {};
  CHECK(range(4, 5) == std::pair(90.0, 0.0));
}

TEST_CASE("a proposal gains, keeps to the limits, and is the plan that is written",
          "[plan_command][plan][long]") {
  const TemporaryFolder folder;
  const auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  auto options = options_of(kConfig / "plans/kr5_arc_30deg.toml", kProposal_ms);
  options.propose = true;
  options.write_plan = folder / "wider.toml";
  const auto planned = run(options);
  CHECK(planned.code == 0);
  CHECK_THAT(planned.text, ContainsSubstring("Proposal") && ContainsSubstring("times smaller") &&
                               ContainsSubstring("neither the cell") && ContainsSubstring("T1"));

  const auto before = look_ahead(robot, load_plan(options.plan), coarse(kProposal_ms));
  const auto proposal = propose(robot, before, coarse(kProposal_ms), 5);
  REQUIRE_FALSE(proposal.steps.empty());
  for (const auto& step : proposal.steps) CHECK(step.gain >= 1.1);
  CHECK(gain(before.prediction, proposal.outlook.prediction) > 2);
  CHECK(proposal.outlook.refusals.empty());

  const auto written = load_plan(*options.write_plan);
  CHECK(check_plan(written, robot).empty());
  CHECK(plan_toml(written) == plan_toml(proposal.outlook.plan));
  for (std::size_t s = 0; s < written.sweeps.size(); ++s) {
    const auto& sweep = written.sweeps[s];
    const auto& limits = robot.limits[sweep.joint - 1];
    for (const double end_deg : {sweep.start_deg, sweep.end_deg}) {
      CHECK(end_deg >= limits.min_deg + 5);
      CHECK(end_deg <= limits.max_deg - 5);
    }
    CHECK(std::abs(sweep.end_deg - sweep.start_deg) <= 340);
  }
}

TEST_CASE("a proposal that could not be written is refused before anything is computed",
          "[plan_command][plan]") {
  const TemporaryFolder folder;
  auto options = options_of(kConfig / "plans/kr5_arc_30deg.toml", kProposal_ms);
  options.propose = true;
  const auto refused = [&](const fs::path& file, const std::string& why) {
    options.write_plan = file;
    std::ostringstream out;
    CHECK_THROWS_WITH(plan(options, out, out), ContainsSubstring(why));
    CHECK(out.str().empty());
  };
  refused(folder / "none/wider.toml", "cannot write ");
  refused(options.plan, "this command reads it");
  refused(folder.write("mine.toml", "# my own\n"), "it is there already");
  CHECK(content(folder / "mine.toml") == "# my own\n");
}

TEST_CASE("a plan that is too short is refused, its proposal is written",
          "[plan_command][plan][long]") {
  const TemporaryFolder folder;
  const auto file = folder.write(
      "plan.toml", changed("start_deg = 0.0\nend_deg = 90.0", "start_deg = 0.0\nend_deg = 4.0"));
  auto options = options_of(file, kProposal_ms);
  options.propose = true;
  options.write_plan = folder / "wider.toml";
  CHECK(run(options).code == 0);
  CHECK(run(options_of(*options.write_plan)).code == 0);

  fs::remove(*options.write_plan);
  CHECK(run(writing(options, folder)).code == 1);  // the program would be that of the short one
  CHECK_FALSE(fs::exists(*options.write_plan));
  CHECK_FALSE(fs::exists(folder / "krl"));
}

TEST_CASE("the plan simulated gives the sweeps that it asks for", "[plan_command][plan][long]") {
  const auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  for (const char* name : {"kr5_arc_90deg.toml", "kr5_arc_30deg.toml"}) {
    const auto plan = load_plan(kConfig / "plans" / name);
    const auto rehearsal = rehearse(robot, plan, {});
    std::vector<std::size_t> order;
    for (std::size_t s = 0; s < plan.sweeps.size(); ++s) {
      INFO(name << ", sweep " << s + 1);
      REQUIRE(rehearsal.stroke_of_sweep[s]);
      order.push_back(*rehearsal.stroke_of_sweep[s]);
      const auto& stroke = rehearsal.strokes[order.back()];
      const double turned = plan.sweeps[s].end_deg - plan.sweeps[s].start_deg;
      CHECK(stroke.joint == plan.sweeps[s].joint - 1);
      CHECK(stroke.direction == (turned > 0 ? 1 : -1));
      CHECK(stroke.defect == identify::SweepDefect::none);
      // The segmentation cuts up to 0.1 % off where the joint hardly moves.
      CHECK(std::abs(degrees(stroke.range_rad) - std::abs(turned)) < 0.002 * std::abs(turned));
      CHECK(degrees(stroke.range_rad) < std::abs(turned) + 0.001);
    }
    CHECK(std::is_sorted(order.begin(), order.end()));
    CHECK(rehearsal.identification.status == identify::Status::complete);
  }
}

TEST_CASE("what few decimals leave out is in the uncertainties that are predicted",
          "[plan_command][plan][long]") {
  const auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  for (const char* name : {"kr5_arc_90deg.toml", "kr5_arc_30deg.toml"}) {
    const auto plan = load_plan(kConfig / "plans" / name);
    Measurement measurement = coarse();
    measurement.precision = 1;
    const auto expected = look_ahead(robot, plan, measurement).prediction.dh;
    const auto found = rehearse(robot, plan, measurement, 100).identification;
    REQUIRE(found.dh.size() == expected.size());
    const auto check = [&](const identify::DhNumber& predicted, const identify::DhNumber& stated,
                           double error) {
      if (predicted.knowledge != identify::Knowledge::identified) return;
      CHECK(std::abs(error) < 4 * predicted.sigma);
      // One campaign in steps of 0.1 mm and 16 ms: another falls on the steps otherwise.
      CHECK(predicted.sigma > 0.4 * stated.sigma);
      CHECK(predicted.sigma < 1.7 * stated.sigma);
    };
    for (std::size_t j = 0; j < expected.size(); ++j) {
      INFO(name << ", row " << j + 1);
      const auto& row = found.dh[j];
      const auto& truth = found.specified[j];
      check(expected[j].b_mm, row.b_mm, row.b_mm.value - truth.b_mm);
      check(expected[j].a_mm, row.a_mm, row.a_mm.value - truth.a_mm);
      check(expected[j].theta_rad, row.theta_rad,
            identify::wrapped(row.theta_rad.value - truth.theta_rad));
      check(expected[j].alpha_rad, row.alpha_rad,
            identify::wrapped(row.alpha_rad.value - truth.alpha_rad));
    }
  }
}

TEST_CASE("predicted uncertainties are those of simulated campaigns",
          "[plan_command][plan][long]") {
  const auto robot = load_robot(kConfig / "robots/kr5_arc.toml");
  const auto plan = load_plan(kConfig / "plans/kr5_arc_90deg.toml");
  constexpr int kRuns = 40;
  for (const bool device : {false, true}) {
    Measurement measurement = coarse();
    if (device) measurement.position_sigma_mm = 0.02;
    const auto expected = look_ahead(robot, plan, measurement).prediction.dh;
    const std::array numbers{&identify::DhEstimate::b_mm, &identify::DhEstimate::theta_rad,
                             &identify::DhEstimate::a_mm, &identify::DhEstimate::alpha_rad};
    const std::array truths{&identify::DhRow::b_mm, &identify::DhRow::theta_rad,
                            &identify::DhRow::a_mm, &identify::DhRow::alpha_rad};
    std::vector<double> squares(4 * expected.size(), 0.0);
    for (int seed = 1; seed <= kRuns; ++seed) {
      const auto found =
          rehearse(robot, plan, measurement, 100 + static_cast<std::uint64_t>(seed)).identification;
      REQUIRE(found.dh.size() == expected.size());
      for (std::size_t i = 0; i < squares.size(); ++i) {
        double error =
            (found.dh[i / 4].*numbers[i % 4]).value - found.specified[i / 4].*truths[i % 4];
        if (i % 2 == 1) error = identify::wrapped(error);
        squares[i] += error * error;
      }
    }
    // A standard deviation from N runs scatters by 1/sqrt(2 N), 11 %: one number of twenty is off
    // by 4 times that once in a thousand times. The mean over all is of at least five independent
    // ones: 5 %, and 15 % never.
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const auto& number = expected[i / 4].*numbers[i % 4];
      if (number.knowledge != identify::Knowledge::identified) continue;
      const double ratio = std::sqrt(squares[i] / kRuns) / number.sigma;
      INFO("row " << i / 4 + 1 << ", number " << i % 4 << ": " << ratio);
      CHECK(std::abs(ratio - 1) < 4 / std::sqrt(2.0 * kRuns));
      sum += ratio;
      ++count;
    }
    CHECK(count >= 15);
    CHECK(std::abs(sum / count - 1) < 0.15);
  }
}
