// Streams in which several joints also moved at once: what looks like an arc may be no joint's.

#include <algorithm>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "identify/sweeps/joint_assignment.hpp"
#include "identify/sweeps/position_segmentation.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;

namespace {

/// A campaign that is told stroke by stroke what the joints did.
struct Run {
  test::Campaign campaign;
  identify::Campaign known;
  struct Move {
    double begin_s, end_s;
    std::size_t joint;
  };
  std::vector<Move> alone;  // moves of one joint

  explicit Run(std::uint32_t seed)
      : campaign(test::kr5_arc(), {.position_mm = 0.05, .seed = seed}) {
    known.specified = test::kr5_arc();
    known.declared_home_rad = known.specified->home_rad;
    known.device_frame = true;
  }

  [[nodiscard]] double home_deg(std::size_t joint) const {
    return known.declared_home_rad[joint] / kDegree;
  }
  [[nodiscard]] double now_s() const {
    return 0.004 * static_cast<double>(campaign.samples().size());
  }
  void move(std::size_t joint, double to_deg, double speed_deg_s = 20) {
    const double begin_s = now_s();
    campaign.move(joint, to_deg, speed_deg_s);
    alone.push_back({begin_s, now_s(), joint});
    campaign.rest(0.7);
  }
  void move_all(const std::vector<double>& from_home_deg, double speed_deg_s = 40) {
    std::vector<test::Campaign::Target> targets;
    for (std::size_t j = 0; j < 6; ++j) targets.push_back({j, home_deg(j) + from_home_deg[j]});
    campaign.move_all(targets, speed_deg_s);
    campaign.rest(0.7);
  }
  void declare(std::size_t joint, const std::vector<double>& strokes_deg) {
    DeclaredJoint turn{joint, strokes_deg.front() > 0 ? 1 : -1};
    for (const double stroke : strokes_deg) turn.strokes_rad.push_back(stroke * kDegree);
    known.order.push_back(turn);
  }
  void sweep(std::size_t joint, double half_deg = 40) {
    const double home = home_deg(joint);
    move(joint, home - half_deg, 40);
    move(joint, home + half_deg);
    move(joint, home, 40);
    declare(joint, {-half_deg, 2 * half_deg, -half_deg});
  }

  [[nodiscard]] std::vector<Sweep> strokes() const {
    PositionSegmenter segmenter;
    std::vector<Sweep> found;
    const auto take = [&](std::vector<Sweep> ended) {
      std::move(ended.begin(), ended.end(), std::back_inserter(found));
    };
    double next_s = 0;
    for (const Sample& sample : test::without_angles(campaign.samples())) {
      if (sample.time_s < next_s) continue;
      next_s += 1 / 120.0;
      take(segmenter.push({{0, sample}}));
    }
    take(segmenter.finish());
    return found;
  }

  /// Whether the strokes with a joint are its own, and each joint has one.
  [[nodiscard]] bool is_right(const std::vector<Sweep>& assigned) const {
    std::vector<bool> swept(6, false);
    for (const Sweep& stroke : assigned) {
      if (!stroke.joint) continue;
      const double middle_s = (stroke.first().time_s + stroke.last().time_s) / 2;
      if (std::none_of(alone.begin(), alone.end(), [&](const Move& move) {
            return move.joint == stroke.joint && middle_s > move.begin_s && middle_s < move.end_s;
          }))
        return false;
      swept[*stroke.joint] = true;
    }
    return std::all_of(swept.begin(), swept.end(), [](bool one) { return one; });
  }
};

std::vector<double> near_home(std::mt19937& random, double most_deg) {
  std::uniform_real_distribution<> uniform(-most_deg, most_deg);
  std::vector<double> pose(6);
  for (double& angle : pose) angle = uniform(random);
  return pose;
}

void park(Run& run, std::uint32_t seed, double most_deg) {
  std::mt19937 random(seed);
  const auto pose = near_home(random, most_deg);
  run.move_all(pose, 1e6);  // there it stands when the stream begins
  run.move_all(std::vector<double>(6, 0));
  for (const std::size_t joint : {4U, 0U, 3U, 1U, 2U, 5U}) run.sweep(joint);
  run.move_all(pose);
}

bool warns(const JointAssignment& found, const std::string& code) {
  return std::any_of(found.warnings.begin(), found.warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

}  // namespace

TEST_CASE("a move of all joints from a park pose to home and back is no joint's",
          "[joint_assignment][extra_moves]") {
  const double most_deg = GENERATE(10.0, 30.0);
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(most_deg, seed);
    Run run(seed);
    park(run, seed, most_deg);
    const auto seen = run.strokes();
    {
      INFO("as description and plan tell");
      auto strokes = seen;
      CHECK(assign_joints(strokes, run.known).doubt.empty());
      CHECK(run.is_right(strokes));
      CHECK(identify::identify(seen, run.known).status == Status::complete);
    }
    {
      INFO("as the description alone tells");
      auto known = run.known;
      known.order.clear();
      auto strokes = seen;
      CHECK(assign_joints(strokes, known).doubt.empty());
      CHECK(run.is_right(strokes));
    }
    {
      INFO("as the plan alone tells");
      auto known = run.known;
      known.specified.reset();
      auto strokes = seen;
      CHECK_FALSE(warns(assign_joints(strokes, known), "plan_contradicted"));
      CHECK(run.is_right(strokes));
    }
  }
}

TEST_CASE("a plan that does not have the ways back tells a frame that is mirrored",
          "[joint_assignment][extra_moves]") {
  Run run(1);
  run.campaign.rest(1);
  for (const std::size_t joint : {4U, 0U, 3U, 1U, 2U, 5U}) {
    const double home = run.home_deg(joint);
    run.move(joint, home - 40, 40);
    run.move(joint, home + 40);
    run.move(joint, home - 40);
    run.move(joint, home, 40);
    run.declare(joint, {-40, 80, -40});
  }
  const auto seen = run.strokes();
  const auto right = identify::identify(seen, run.known);
  CHECK(right.status == Status::complete);
  CHECK(std::none_of(right.joints.begin(), right.joints.end(),
                     [](const JointResult& joint) { return joint.against_plan; }));
  const auto mirrored = test::changed(seen, [](Sweep&, std::vector<Sample>& samples) {
    for (Sample& sample : samples) sample.position_mm.y() *= -1;
  });
  const auto found = identify::identify(mirrored, run.known);
  CHECK(found.status == Status::doubtful);
  REQUIRE_FALSE(found.doubts.empty());
  CHECK(found.doubts.front().code == "frame_mirrored");
}

TEST_CASE("moves of several joints between the sweeps are no joint's",
          "[joint_assignment][extra_moves]") {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    Run run(seed);
    run.campaign.rest(1);
    for (const std::size_t joint : {5U, 2U, 0U, 1U, 4U, 3U}) {
      run.sweep(joint);
      run.move_all(near_home(random, 20));
      run.move_all(std::vector<double>(6, 0));
    }
    auto strokes = run.strokes();
    const auto found = assign_joints(strokes, run.known);
    CHECK(found.doubt.empty());
    CHECK(warns(found, "moves_left_out"));
    CHECK(run.is_right(strokes));
    CHECK(identify::identify(run.strokes(), run.known).status == Status::complete);
  }
}

TEST_CASE("two joints at once on the way from one sweep to the next are neither's",
          "[joint_assignment][extra_moves]") {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<> half(20, 45);
    Run run(seed);
    run.campaign.rest(1);
    std::vector<double> pose(6, 0);
    for (const std::size_t joint : {5U, 0U, 3U, 4U, 2U, 1U}) {
      const double half_deg = half(random);
      pose.assign(6, 0);
      pose[joint] = -half_deg;
      run.move_all(pose);
      run.move(joint, run.home_deg(joint) + half_deg);
      run.declare(joint, {-half_deg, 2 * half_deg, -half_deg});
    }
    auto strokes = run.strokes();
    const auto found = assign_joints(strokes, run.known);
    CHECK(found.doubt.empty());
    CHECK(identify::identify(run.strokes(), run.known).status == Status::complete);
  }
}

TEST_CASE("a joint that swept though the plan lacks it is told by the description",
          "[joint_assignment][extra_moves]") {
  for (std::size_t missing = 0; missing < 6; ++missing) {
    CAPTURE(missing);
    Run run(1);
    run.campaign.rest(1);
    for (const std::size_t joint : {4U, 0U, 3U, 1U, 2U, 5U}) run.sweep(joint);
    std::erase_if(run.known.order,
                  [&](const DeclaredJoint& turn) { return turn.joint == missing; });
    auto strokes = run.strokes();
    const auto found = assign_joints(strokes, run.known);
    CHECK(run.is_right(strokes));
    CHECK(found.doubt.empty());
    CHECK(warns(found, "order_differs"));
  }
}

TEST_CASE("strokes that paused are those of the plan", "[joint_assignment][extra_moves]") {
  Run run(1);
  run.campaign.rest(1);
  for (const std::size_t joint : {4U, 0U, 3U, 1U, 2U, 5U}) {
    const double home = run.home_deg(joint);
    run.move(joint, home - 40, 40);
    run.move(joint, home - 10);  // and rests there
    run.move(joint, home + 40);
    run.move(joint, home, 40);
    run.declare(joint, {-40, 80, -40});
  }
  auto strokes = run.strokes();
  const auto found = assign_joints(strokes, run.known);
  CHECK(run.is_right(strokes));
  CHECK(found.warnings.empty());
}

TEST_CASE("moves on no circle are told where axes are missing", "[joint_assignment][extra_moves]") {
  Run run(1);
  run.campaign.rest(1);
  run.sweep(0);
  // As of sweeps whose ends are blended: one joint begins before the other has stopped.
  run.move_all({30, 20, 40, 0, 0, 0});
  run.move_all({0, 0, 0, 40, -40, 20}, 20);
  run.known.order.clear();  // there is no plan
  auto strokes = run.strokes();
  const auto found = assign_joints(strokes, run.known);
  CHECK(warns(found, "order_mismatch"));
  REQUIRE(warns(found, "moves_on_no_circle"));
  CHECK(found.warnings.front().code == "moves_on_no_circle");
  const std::string& message = found.warnings.front().message;
  CHECK(message.find("2 moves of the target, of up to ") == 0);
  CHECK(message.find("C_PTP") != std::string::npos);
  CHECK(message.find("rest for half a second") != std::string::npos);

  Run alone(1);
  alone.campaign.rest(1);
  alone.sweep(0);
  alone.known.order.clear();
  auto others = alone.strokes();
  CHECK_FALSE(warns(assign_joints(others, alone.known), "moves_on_no_circle"));
}

TEST_CASE("the joints that a stream has ran in the plan's order, where it began late",
          "[joint_assignment][extra_moves]") {
  Run run(1);
  run.campaign.rest(1);
  for (const std::size_t joint : {0U, 3U, 1U, 2U, 5U}) run.sweep(joint);
  const auto before = run.known.order;
  run.declare(4, {-40, 80, -40});
  std::rotate(run.known.order.begin(), run.known.order.end() - 1, run.known.order.end());
  auto strokes = run.strokes();
  const auto found = assign_joints(strokes, run.known);
  CHECK(found.doubt.empty());
  CHECK(warns(found, "order_mismatch"));
  CHECK_FALSE(warns(found, "order_differs"));
  // As if the plan had no other joint.
  run.known.order = before;
  auto same = run.strokes();
  (void)assign_joints(same, run.known);
  REQUIRE(same.size() == strokes.size());
  for (std::size_t k = 0; k < same.size(); ++k) CHECK(same[k].joint == strokes[k].joint);
}
