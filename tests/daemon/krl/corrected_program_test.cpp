#include "daemon/krl/corrected_program.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <spdlog/fmt/fmt.h>

#include "daemon/krl/krl_position.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/robot.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using identify::kDegree;

namespace {

using Angles = std::array<double, 6>;
using Eigen::Isometry3d;

/// A KR 5, built, and the frames of its points.
struct Cell {
  simulation::Robot robot = simulation::built(simulation::kr5(), 2);
  identify::PlacedArm controller{robot.specified, Isometry3d(Eigen::Translation3d(2000, -300, 150)),
                                 robot.targets_mm};
  identify::PoseFit identified;
  ProgramOptions options;

  explicit Cell(bool built = true) {
    identify::PlacedArm truth = controller;
    if (built) truth.arm = robot.arm;
    identified.model.chain = truth.chain();
    identified.model.home_rad = truth.arm.home_rad;
    const auto count = identified.model.parameters();
    identified.covariance = Eigen::MatrixXd::Zero(count, count);
    identified.noise.position_mm = 0.01;
    options.flange = krl_frame("{X 0,Y 0,Z 115,A 0,B 0,C 0}");
    options.tool = krl_frame("{X 200,Y 0,Z 100,A 0,B 30,C 0}");
    options.base = krl_frame("{X 500,Y 100,Z -20,A 90,B 1,C 0}");
    options.largest_shift_mm = 10;  // the base is not fitted to what is off
    for (int j = 0; j < 6; ++j) options.limits.emplace_back(-350 * kDegree, 350 * kDegree);
  }

  /// As the controller computes it.
  [[nodiscard]] Isometry3d told(const Angles& angles) const {
    return options.base->inverse() *
           forward_kinematics(robot.specified, {angles.begin(), angles.end()}) * options.flange *
           *options.tool;
  }

  [[nodiscard]] std::string e6pos(const std::string& name, const Angles& angles) const {
    const Isometry3d at = told(angles);
    const auto abc = identify::abc_of(at.linear());
    const auto arm = identify::WristArm::of(robot.specified);
    const auto posture = arm->posture(angles);
    return fmt::format(
        "DECL E6POS {}={{X {:.9f},Y {:.9f},Z {:.9f},A {:.9f},B {:.9f},C {:.9f},S {},T {},E1 "
        "12.50,E2 0.0}}\r\n",
        name, at.translation().x(), at.translation().y(), at.translation().z(), abc[0] / kDegree,
        abc[1] / kDegree, abc[2] / kDegree,
        posture.overhead + 2 * posture.bent_up + 4 * posture.flipped, turn_of(angles));
  }

  [[nodiscard]] CorrectedProgram corrected(const std::string& text) const {
    return corrected_program(text, identified, controller, options);
  }

  void refuses(const std::string& text, const std::string& why) const {
    INFO(text);
    CHECK_THROWS_WITH(corrected(text), ContainsSubstring(why));
  }
};

Angles in_rad(Angles degrees) {
  for (double& angle : degrees) angle *= kDegree;
  return degrees;
}

const Angles kUsual = in_rad({20, -80, 95, 15, 40, -60});

std::vector<Angles> random_joints(std::size_t count) {
  std::mt19937 random(4);
  std::uniform_real_distribution<> anywhere(-179, 179);
  std::vector<Angles> all;
  while (all.size() < count) {
    Angles angles;
    for (double& angle : angles) angle = anywhere(random) * kDegree;
    if (std::abs(std::sin(angles[4])) > std::sin(2 * kDegree)) all.push_back(angles);
  }
  return all;
}

}  // namespace

TEST_CASE("Points of a robot as specified come back, with S and T of any joints",
          "[corrected_program]") {
  const Cell cell(false);
  std::string text;
  const auto joints = random_joints(300);
  for (std::size_t i = 0; i < joints.size(); ++i)
    text += cell.e6pos("XP" + std::to_string(i), joints[i]);
  const auto program = cell.corrected(text);
  REQUIRE(program.points.size() == joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    CHECK(program.points[i].shift_mm < 1e-6);
    for (std::size_t j = 0; j < 6; ++j)
      CHECK(program.points[i].angles_rad[j] == Approx(joints[i][j]).margin(1e-7));
    CHECK_FALSE(program.points[i].turn_bits);
  }
  const auto before = krl_aggregates(text), after = krl_aggregates(program.text);
  for (std::size_t i = 0; i < before.size(); ++i)
    for (const char* name : {"X", "Y", "Z"})
      CHECK(*after[i].find(name)->number() == Approx(*before[i].find(name)->number()).margin(2e-6));
}

TEST_CASE("A built robot reaches what was wanted by the corrected points", "[corrected_program]") {
  const Cell cell;
  auto joints = random_joints(60);
  for (auto& angles : joints) {  // off the stretched arm, and off axis 1
    angles[1] = -90 * kDegree + angles[1] / 8;
    angles[2] = 80 * kDegree + angles[2] / 4;
  }
  std::string text;
  for (std::size_t i = 0; i < joints.size(); ++i)
    text += cell.e6pos("XP" + std::to_string(i), joints[i]);
  const auto program = cell.corrected(text);
  const auto points = krl_aggregates(program.text);
  const auto arm = identify::WristArm::of(cell.robot.specified);
  double most = 0, as_is = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    // As the controller does it with the new file.
    const Isometry3d flange = *cell.options.base * krl_frame(points[i]) *
                              cell.options.tool->inverse() * cell.options.flange.inverse();
    const auto found = arm->angles_at(flange, posture_of(*points[i].find("S")->bits()));
    REQUIRE(found);
    const auto angles = turned_as(*found, *points[i].find("T")->bits());
    const auto truly = [&](const Angles& at) {
      identify::Turns turns{};
      for (std::size_t j = 0; j < 6; ++j) turns[j] = at[j] - cell.robot.arm.home_rad[j];
      return cell.identified.model.chain.target_mm(0, turns);
    };
    const auto wanted =
        cell.controller.base *
        forward_kinematics(cell.robot.specified, {joints[i].begin(), joints[i].end()}) *
        cell.robot.targets_mm[0];
    most = std::max(most, (truly(angles) - wanted).norm());
    as_is = std::max(as_is, (truly(joints[i]) - wanted).norm());
  }
  CHECK(as_is > 1);
  CHECK(most < 1e-5);
}

TEST_CASE("All but numbers of points stays to the byte", "[corrected_program]") {
  const Cell cell;
  const std::string text =
      "&ACCESS RVP\r\nDEFDAT P\r\n; gr\xF6\xDF"
      "er = {X 1}\r\n" +
      cell.e6pos("XP1", kUsual) +
      "DECL E6AXIS XHOME={A1 20.0,A2 -80.00,A3 95,A4 15.0,A5 40.0,A6 -60.0,E1 7.5} ; home\r\n"
      "DECL FRAME XOFF={X 10.0,Y 0.0,Z 0.0,A 0.0,B 0.0,C 0.0}\r\n"
      "DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,IPO_FRAME #BASE}\r\nENDDAT";
  const auto program = cell.corrected(text);
  REQUIRE(program.points.size() == 2);
  CHECK(program.points[0].shift_mm > 0.05);
  CHECK(program.points[1].angles_rad[1] ==
        Approx(program.points[0].angles_rad[1]).margin(1e-9));  // the same joints
  auto before = krl_aggregates(text);
  auto after = krl_aggregates(program.text);
  REQUIRE(after.size() == before.size());
  // Both without the numbers of the two points.
  const auto without = [](std::string bytes, const std::vector<KrlAggregate>& all) {
    for (std::size_t i = 2; i-- > 0;)
      for (std::size_t k = 6; k-- > 0;)
        bytes.erase(all[i].fields[k].at, all[i].fields[k].text.size());
    return bytes;
  };
  CHECK(without(program.text, after) == without(text, before));
  CHECK(after[0].find("X")->text.size() - after[0].find("X")->text.find('.') == 10);  // 9 decimals
  CHECK(after[1].find("A3")->text != "95");
}

TEST_CASE("A joint that passes zero changes T, and nothing else does", "[corrected_program]") {
  const Cell cell;
  Angles angles = kUsual;
  angles[3] = 0;
  const auto program = cell.corrected(cell.e6pos("XP1", angles));
  const auto& point = program.points.front();
  if (point.angles_rad[3] < 0) {
    REQUIRE(point.turn_bits);
    CHECK(point.turn_bits->second == (point.turn_bits->first | 8U));
  } else {
    CHECK_FALSE(point.turn_bits);
  }
  CHECK(std::abs(point.angles_rad[3]) < 1 * kDegree);
}

TEST_CASE("What cannot be corrected is refused with its line", "[corrected_program]") {
  const Cell cell;
  const std::string good = cell.e6pos("XP1", kUsual);
  cell.refuses("DEFDAT P\r\nENDDAT\r\n", "no point of type E6POS");
  cell.refuses("DECL FRAME F={X 1,Y 1,Z 1,A 0,B 0,C 0}", "no point of type E6POS");
  cell.refuses(good + "DECL E6POS XP2={X 1.0,Y 2.0,Z 3.0,A 0.0,B 0.0,C 0.0}",
               "line 2: XP2 has no S and T");
  cell.refuses("DECL POS XP2={X 1.0,Y 2.0,A 0.0,B 0.0,C 0.0,S 2,T 2}", "XP2: Z is missing");
  cell.refuses("DECL POS XP2={X 1.0,Y nan,Z 3,A 0.0,B 0.0,C 0.0,S 2,T 2}", "Y is no number");
  cell.refuses("DECL POS XP2={X 1e30,Y 0,Z 3,A 0.0,B 0.0,C 0.0,S 2,T 2}", "too large");
  cell.refuses("DECL POS XP2={X 1.0,Y 2.0,Z 3,A 0.0,B 0.0,C 0.0,S 2,T 99}", "none");
  cell.refuses("DECL POS XP2={X 5000,Y 0,Z 3,A 0.0,B 0.0,C 0.0,S 2,T 2}",
               "line 1: XP2 is out of the specified arm's reach with S 2");
  cell.refuses("DECL POS XP2={X 1,Y 0,Z 3,A 0.0,B 0.0,C 0.0,S 18,T 2}", "absolutely accurate");
  Angles singular = kUsual;
  singular[4] = 0.5 * kDegree;
  cell.refuses(cell.e6pos("XP1", singular), "line 1: XP1 lies in the wrist's singularity");
  auto other = cell;
  other.options.limits[1] = {-70 * kDegree, 70 * kDegree};
  other.refuses(good, "line 1: XP1 has joint 2 at -80.000 deg, beyond its limits");
  other = cell;
  other.options.largest_shift_mm = 0.01;
  other.refuses(good + good, "line 1: XP1 would be shifted by");
  other.refuses(good + good, "\nline 2: XP1");
  other.options.leave = {"XP1"};
  const auto left = other.corrected(good);
  CHECK(left.text == good);
  CHECK(left.points.front().left);
  other.options.leave = {"XP7"};
  other.refuses(good, "has no point XP7: correct --leave");
  other = cell;
  other.options.base.reset();
  other.refuses(good, "XP1 needs its base");
}

TEST_CASE("Base and tool come from the controller's configuration", "[corrected_program]") {
  const Cell cell;
  const std::string text = cell.e6pos("XP1", kUsual) +
                           "DECL FDAT FP1={TOOL_NO 3,BASE_NO 2,IPO_FRAME #BASE}\r\n" +
                           cell.e6pos("XP2", kUsual);
  const std::string config =
      fmt::format("TOOL_DATA[3]={}\r\nBASE_DATA[2]={}\r\n", krl_frame_text(*cell.options.tool),
                  krl_frame_text(*cell.options.base));
  auto by_config = cell;
  by_config.options.base.reset();
  by_config.options.tool.reset();
  by_config.options.config = krl_aggregates(config);
  by_config.refuses(text, "line 3: XP2 has no FDAT");
  by_config.options.leave = {"XP2"};
  const auto program = by_config.corrected(text);
  CHECK(program.points[0].shift_mm == Approx(cell.corrected(text).points[0].shift_mm).margin(1e-6));
  by_config.options.config = krl_aggregates(std::string_view());
  by_config.refuses(text, "BASE_DATA[2], which the file of --config has not");
}
