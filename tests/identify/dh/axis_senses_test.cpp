#include "identify/dh/axis_senses.hpp"

#include <random>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/robot.hpp"

using namespace identify;

namespace {

struct Turned {
  Arm arm = simulation::kr5().specified;
  std::vector<std::optional<Axis>> axes;  ///< of an arm as built, along positive rotation

  explicit Turned(std::uint32_t seed, std::vector<double> home_rad = {}) {
    auto robot = simulation::built(simulation::kr5(), seed);
    if (!home_rad.empty()) robot = simulation::at_home(robot, home_rad);
    for (const ChainAxis& axis : simulation::chain_of(robot).axes)
      axes.emplace_back(Axis{axis.direction, axis.point_mm});
  }

  void turn(std::size_t joint) { axes[joint] = axes[joint]->reversed(); }
  [[nodiscard]] AxisSenses senses(const std::vector<SenseBy>& known, bool device = true) const {
    return senses_of(axes, known, arm, {arm.home_rad}, device);
  }
};

const std::vector<SenseBy> kNothing(6, SenseBy::nothing);

}  // namespace

TEST_CASE("At home the description tells all senses, whichever are turned", "[axis_senses]") {
  for (unsigned turned = 0; turned < 64; ++turned) {
    CAPTURE(turned);
    Turned example(turned);
    std::vector<int> expected;
    for (std::size_t j = 0; j < 6; ++j) {
      const bool round = (turned >> j & 1) != 0;
      if (round) example.turn(j);
      expected.push_back(round ? -1 : 1);
    }
    const auto found = example.senses(kNothing);
    CHECK(found.senses == expected);
    CHECK(found.ambiguous.empty());
  }
}

TEST_CASE(
    "What angles tell is not turned, and what a plan tells is turned only against all evidence",
    "[axis_senses]") {
  Turned example(7);
  example.turn(2);
  auto known = kNothing;
  known[2] = SenseBy::plan;
  const auto by_plan = example.senses(known);
  CHECK(by_plan.senses == std::vector<int>{1, 1, -1, 1, 1, 1});
  CHECK(by_plan.against == std::vector<std::size_t>{2});
  known.assign(6, SenseBy::angles);
  CHECK(example.senses(known).senses == std::vector<int>(6, 1));
}

TEST_CASE("At an unknown pose axes that meet at right angles may turn either way",
          "[axis_senses]") {
  auto home = Turned(0).arm.home_rad;
  for (std::size_t j = 0; j < 6; ++j) home[j] += (j % 2 == 0 ? 0.4 : -0.5);
  Turned example(9, home);
  const auto found = example.senses(kNothing);
  CHECK_FALSE(found.ambiguous.empty());
  // A plan that nothing contradicts tells them.
  const auto by_plan = example.senses(std::vector<SenseBy>(6, SenseBy::plan));
  CHECK(by_plan.ambiguous.empty());
  CHECK(by_plan.senses == std::vector<int>(6, 1));
}

TEST_CASE("Axes most of which are parallel tell their senses by the whole pose, or not at all",
          "[axis_senses][issue12]") {
  // Turned round all together, those of a palletizer lie to each other as before.
  const double off_deg = GENERATE(1.0, 10.0, 30.0);
  int known = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(off_deg, seed);
    const auto robot =
        simulation::at_random_home(simulation::built(simulation::palletizer(), seed), seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<> off(-off_deg * kDegree, off_deg * kDegree);
    std::vector<std::optional<Axis>> axes;
    std::vector<int> expected;
    auto pose_rad = robot.arm.home_rad;
    for (const ChainAxis& axis : simulation::chain_of(robot).axes) {
      pose_rad[axes.size()] += off(random);
      axes.emplace_back(Axis{axis.direction, axis.point_mm});
      expected.push_back(random() % 2 == 0 ? 1 : -1);
      if (expected.back() < 0) axes.back() = axes.back()->reversed();
    }
    const auto found = senses_of(axes, std::vector<SenseBy>(axes.size(), SenseBy::nothing),
                                 robot.specified, {pose_rad}, true);
    if (!found.ambiguous.empty()) continue;
    ++known;
    CHECK(found.senses == expected);
  }
  if (off_deg < 2) CHECK(known == 100);
}

TEST_CASE("An arm that is another tells nothing", "[axis_senses]") {
  Turned example(11);
  for (auto& axis : example.axes) axis->point_mm *= 2;
  example.turn(4);
  const auto found = example.senses(kNothing);
  CHECK(found.senses == std::vector<int>(6, 1));
  CHECK(found.ambiguous.empty());
}
