#include "daemon/points/declared_directions.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include "daemon/text/units.hpp"
#include "tests/catch.hpp"

using identify::Sweep;
using namespace sweepd;

namespace {

/// All strokes of the plans below, with the ways to the start and back home.
const std::vector<identify::DeclaredJoint> kOrder{{0, 1, {radians(60), radians(-40), radians(-20)}},
                                                  {1, 1, {radians(30), radians(-30)}}};

/// A joint's stroke about Z.
Sweep stroke(std::size_t joint, int from_deg, int to_deg) {
  auto samples = std::make_shared<std::vector<identify::Sample>>();
  const int step = to_deg > from_deg ? 1 : -1;
  for (int k = from_deg; k != to_deg; k += step) {
    identify::Sample sample;
    sample.position_mm = {std::cos(radians(k)), std::sin(radians(k)), 0};
    sample.has_position = true;
    samples->push_back(sample);
  }
  Sweep sweep;
  sweep.samples = samples;
  sweep.joint = joint;
  return sweep;
}

}  // namespace

TEST_CASE("a plan declares directions: of the sweeps alone, or of all that happened",
          "[declared_directions]") {
  SweepPlan plan;
  plan.home_deg = {0, 0};
  plan.sweeps = {{.joint = 1, .start_deg = 60, .end_deg = 20}, {.joint = 2, .end_deg = 30}};
  std::vector<Sweep> alone{stroke(0, 60, 20), stroke(1, 0, 30)};
  declare_directions(alone, plan, kOrder);
  CHECK(alone[0].direction == -1);
  CHECK(alone[1].direction == 1);
  std::vector<Sweep> all{stroke(0, 0, 60), stroke(0, 60, 20), stroke(0, 20, 0), stroke(1, 0, 30)};
  declare_directions(all, plan, kOrder);
  CHECK(all[0].direction == 1);
  CHECK(all[1].direction == -1);
  CHECK(all[2].direction == -1);
}

TEST_CASE("a sweep that ends at home has its direction by what was written down of other joints",
          "[declared_directions]") {
  SweepPlan plan;
  plan.home_deg = {0, 0};
  plan.sweeps = {{.joint = 1, .start_deg = 60, .end_deg = 20}, {.joint = 2, .start_deg = 30}};
  const auto directions = [&](std::vector<Sweep> sweeps) {
    declare_directions(sweeps, plan, kOrder);
    std::vector<int> found;
    for (const Sweep& sweep : sweeps) found.push_back(sweep.direction);
    return found;
  };
  // There and back, without the ways from home and to it.
  CHECK(directions({stroke(0, 60, 20), stroke(0, 20, 60), stroke(1, 30, 0), stroke(1, 0, 30)}) ==
        std::vector{-1, 1, -1, 1});
  // With them.
  CHECK(directions({stroke(0, 0, 60), stroke(0, 60, 20), stroke(0, 20, 0), stroke(1, 0, 30),
                    stroke(1, 30, 0)}) == std::vector{1, -1, -1, 1, -1});
  // Nothing tells which of the two it is.
  CHECK(directions({stroke(1, 30, 0), stroke(1, 0, 30)}) == std::vector{0, 0});
}

TEST_CASE("half a sweep is not taken for the way to its start", "[declared_directions]") {
  SweepPlan plan;
  plan.home_deg = {0};
  plan.sweeps = {{.joint = 1, .start_deg = -45, .end_deg = 45}};
  const std::vector<identify::DeclaredJoint> order{
      {0, -1, {radians(-45), radians(90), radians(-45)}}};
  std::vector<Sweep> half{stroke(0, -45, 0)};
  declare_directions(half, plan, order);
  CHECK(half[0].direction == 0);
  // With the way there it tells as much as the plan has of it.
  std::vector<Sweep> both{stroke(0, 0, -45), stroke(0, -45, 45)};
  declare_directions(both, plan, order);
  CHECK(both[0].direction == -1);
  CHECK(both[1].direction == 1);
}
