#include "daemon/stream/planned_turns.hpp"

#include <filesystem>

#include "daemon/results/report.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/identify/simulated_campaign.hpp"

using sweepd::PlannedTurns;
using sweepd::test::kConfig;

namespace {}  // namespace

TEST_CASE("the plan names the joint of a sweep without angles as it happens",
          "[planned_turns][issue11][point_20]") {
  const auto setup =
      sweepd::load_setup(kConfig / "robots/kr5_arc.toml", kConfig / "plans/kr5_arc_90deg.toml");
  identify::test::Campaign run(*sweepd::campaign(setup, {}).specified, {.position_mm = 0.002});
  run.rest();
  for (int repeat = 0; repeat < 2; ++repeat)
    for (const auto& sweep : setup.plan->sweeps)
      run.sweep(sweep.joint - 1, sweep.start_deg, sweep.end_deg);
  auto strokes = identify::test::segment(run.samples());
  REQUIRE(strokes.size() > 24);

  PlannedTurns turns(sweepd::campaign(setup, {}).order);
  for (auto& stroke : strokes) {
    const auto joint = stroke.joint;
    stroke.joint.reset();
    CHECK(turns.joint_of(stroke) == joint);
  }
  CHECK(sweepd::sweep_line(strokes.back(), 5).starts_with("joint 6 by the plan: sweep of "));

  strokes.front().defect = identify::SweepDefect::not_an_arc;
  CHECK_FALSE(turns.joint_of(strokes.front()));
  CHECK_FALSE(PlannedTurns().joint_of(strokes.back()));
}
