#include "identify/sweeps/joint_assignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <numeric>
#include <random>
#include <string>

#include "daemon/settings/robot_description.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/identification.hpp"
#include "identify/sweeps/position_segmentation.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using identify::kDegree;
using identify::Sweep;

namespace {

using Order = std::vector<std::size_t>;

struct SweptRange {
  double start_deg;
  double end_deg;
};
constexpr std::array<SweptRange, 6> kWide{
    {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}}};
constexpr std::array<SweptRange, 6> kNarrow{
    {{-15, 15}, {-60, -90}, {120, 90}, {90, 60}, {90, 60}, {0, 30}}};

/// A campaign of an arm seen by its positions alone: the strokes of each joint.
struct Seen {
  identify::Arm arm;
  std::array<SweptRange, 6> ranges;
  std::vector<std::vector<Sweep>> strokes;  // one a joint, with their joint and direction
};

Seen seen(const identify::Arm& arm, const std::array<SweptRange, 6>& ranges,
          const std::vector<double>& home_rad,
          identify::test::Noise noise = {.position_mm = 0.02}) {
  Seen result{arm, ranges, std::vector<std::vector<Sweep>>(6)};
  identify::Arm posed = arm;  // as the simulation begins at its home
  for (std::size_t j = 0; j < 6; ++j) {
    posed.rows[j].theta_rad += arm.positive[j] * (home_rad[j] - arm.home_rad[j]);
    posed.home_rad[j] = home_rad[j];
  }
  identify::test::Campaign campaign(posed, noise);
  campaign.rest();
  for (std::size_t j = 0; j < 6; ++j) campaign.sweep(j, ranges[j].start_deg, ranges[j].end_deg);
  for (Sweep& sweep : identify::test::segment(campaign.samples())) {
    sweep.samples = std::make_shared<const std::vector<identify::Sample>>(
        identify::test::without_angles(*sweep.samples));
    sweep.range_rad = identify::fit_circle(identify::positions(*sweep.samples)).value().arc_rad;
    result.strokes[*sweep.joint].push_back(std::move(sweep));
  }
  return result;
}

/// The strokes without their joints, in an order of joints, one after the other.
std::vector<Sweep> in_order(const Seen& seen, const Order& order) {
  std::vector<Sweep> strokes;
  double end_s = 0;
  for (const std::size_t joint : order)
    for (Sweep stroke : seen.strokes[joint]) {
      stroke.joint.reset();
      stroke.direction = 0;
      std::vector<identify::Sample> samples = *stroke.samples;
      const double later_s = end_s + 1 - samples.front().time_s;
      for (identify::Sample& sample : samples) sample.time_s += later_s;
      end_s = samples.back().time_s;
      stroke.samples = std::make_shared<const std::vector<identify::Sample>>(std::move(samples));
      strokes.push_back(std::move(stroke));
    }
  return strokes;
}

/// The plan that runs the joints 1 to 6.
void declare(identify::Campaign& campaign, const Seen& seen, const std::vector<double>& home_rad) {
  campaign.declared_home_rad = home_rad;
  for (std::size_t j = 0; j < 6; ++j) {
    const double home = home_rad[j] / kDegree;
    identify::DeclaredJoint turn{j, 0};
    for (const double move :
         {seen.ranges[j].start_deg - home, seen.ranges[j].end_deg - seen.ranges[j].start_deg,
          home - seen.ranges[j].end_deg})
      if (move != 0) turn.strokes_rad.push_back(move * kDegree);
    turn.first_direction = turn.strokes_rad.front() > 0 ? 1 : -1;
    campaign.order.push_back(turn);
  }
}

/// The campaign of that plan, with the description.
identify::Campaign described(const Seen& seen, const std::vector<double>& home_rad) {
  identify::Campaign campaign;
  campaign.specified = seen.arm;
  declare(campaign, seen, home_rad);
  return campaign;
}

/// Whether every stroke has its own joint, and its own direction where that is said to be known.
bool is_right(const std::vector<Sweep>& assigned, const Seen& seen, const Order& order,
              bool with_directions) {
  auto stroke = assigned.begin();
  for (const std::size_t joint : order)
    for (const Sweep& truth : seen.strokes[joint]) {
      if (stroke->joint != joint) return false;
      if (with_directions && stroke->direction != truth.direction) return false;
      ++stroke;
    }
  return true;
}

/// All exchanges of two joints, some other orders, and none.
std::vector<Order> orders() {
  Order order(6);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<Order> all{order};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = a + 1; b < 6; ++b) {
      all.push_back(order);
      std::swap(all.back()[a], all.back()[b]);
    }
  std::mt19937 random(22);
  for (int k = 0; k < 5; ++k) {
    std::shuffle(order.begin(), order.end(), random);
    all.push_back(order);
  }
  return all;
}

std::string text_of(const Order& order) {
  std::string text;
  for (const std::size_t joint : order) text += std::to_string(joint + 1);
  return text;
}

bool warns(const identify::JointAssignment& found, const std::string& code) {
  return std::any_of(found.warnings.begin(), found.warnings.end(),
                     [&](const identify::Warning& warning) { return warning.code == code; });
}

}  // namespace

TEST_CASE("joints that swept in any order are told by the description, or the order is in doubt",
          "[joint_assignment][issue11][point_22][long]") {
  const auto permutations = orders();
  for (const auto& file : std::filesystem::directory_iterator(SWEEPD_SOURCE_DIR "/config/robots")) {
    const auto robot = sweepd::load_robot(file.path());
    for (const auto& ranges : {kWide, kNarrow}) {
      const Seen campaign = seen(*robot.arm, ranges, robot.arm->home_rad);
      for (const Order& order : permutations)
        for (const bool with_plan : {false, true})
          for (const bool with_description : {false, true}) {
            // One order in five is enough where nothing but the plan tells it.
            if (!with_description && order.front() + order.back() != 5) continue;
            INFO(robot.name << ", order " << text_of(order) << ", plan " << with_plan
                            << ", description " << with_description);
            identify::Campaign known;
            if (with_plan) declare(known, campaign, robot.arm->home_rad);
            if (with_description) known.specified = robot.arm;
            auto strokes = in_order(campaign, order);
            const auto found = assign_joints(strokes, known);
            CHECK(found.doubt.empty() == with_description);
            CHECK(warns(found, "order_assumed") == !with_description);
            if (with_description) {
              CHECK(is_right(strokes, campaign, order, true));
              CHECK(found.senses_known);
              CHECK(warns(found, with_plan ? "order_differs" : "order_found") ==
                    (order != permutations.front()));
            }
          }
    }
  }
}

TEST_CASE(
    "an arm that stood elsewhere than at its home is told by what does not depend on the pose",
    "[joint_assignment][issue11][point_22][long]") {
  const auto arm = identify::test::kr5_arc();
  std::vector<double> elsewhere;
  for (const double angle : {80, -75, 100, 25, 55, 10}) elsewhere.push_back(angle * kDegree);
  constexpr std::array<SweptRange, 6> kRanges{
      {{40, 120}, {-110, -40}, {60, 140}, {0, 80}, {20, 90}, {10, 100}}};
  const Seen campaign = seen(arm, kRanges, elsewhere);
  for (const Order& order : orders())
    for (const bool with_plan : {false, true}) {
      INFO("order " << text_of(order) << ", plan " << with_plan);
      identify::Campaign known;
      known.specified = arm;
      if (with_plan) declare(known, campaign, arm.home_rad);  // of another pose
      auto strokes = in_order(campaign, order);
      const auto found = assign_joints(strokes, known);
      CHECK(found.home_holds != with_plan);
      CHECK(warns(found, "home_contradicted") == with_plan);
      CHECK(found.doubt.empty());
      CHECK(is_right(strokes, campaign, order, false));
    }
}

TEST_CASE("an arm as it is built, near its home, is still the one that is described",
          "[joint_assignment][issue11][point_22][long]") {
  std::mt19937 random(23);
  std::uniform_real_distribution<> uniform(-1, 1);
  const auto described = identify::test::kr5_arc();
  for (int run = 0; run < 20; ++run) {
    auto built = described;
    auto home = described.home_rad;
    for (auto& row : built.rows) {
      row.a_mm += 1.5 * uniform(random);
      row.b_mm += 1.5 * uniform(random);
      row.alpha_rad += 0.3 * kDegree * uniform(random);
    }
    for (double& angle : home) angle += 0.5 * kDegree * uniform(random);
    const Seen campaign = seen(built, kNarrow, home);
    const Order order{0, 2, 1, 3, 5, 4};
    identify::Campaign known;
    known.specified = described;
    auto strokes = in_order(campaign, order);
    INFO("run " << run);
    CHECK(assign_joints(strokes, known).doubt.empty());
    CHECK(is_right(strokes, campaign, order, true));
  }
}

TEST_CASE("repeated turns, lone strokes and joints left out do not make a wrong order certain",
          "[joint_assignment][issue11][point_22]") {
  const auto arm = identify::test::kr5_arc();
  const Seen campaign = seen(arm, kNarrow, arm.home_rad);
  identify::Campaign known = described(campaign, arm.home_rad);
  SECTION("the whole plan twice") {
    const Order order{0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5};
    auto strokes = in_order(campaign, order);
    const auto found = assign_joints(strokes, known);
    CHECK(found.doubt.empty());
    CHECK(found.warnings.empty());
    CHECK(is_right(strokes, campaign, order, true));
  }
  SECTION("a joint left out") {
    for (std::size_t missing = 0; missing < 6; ++missing)
      for (const bool exchanged : {false, true}) {
        Order order;
        for (std::size_t j = 0; j < 6; ++j)
          if (j != missing) order.push_back(j);
        if (exchanged) std::swap(order[1], order[2]);
        INFO("order " << text_of(order));
        auto strokes = in_order(campaign, order);
        const auto found = assign_joints(strokes, known);
        CHECK(warns(found, "order_mismatch"));
        CHECK((!found.doubt.empty() || is_right(strokes, campaign, order, true)));
      }
  }
  SECTION("the sweeps alone, without the ways to and from them") {
    Seen alone = campaign;
    for (auto& strokes : alone.strokes)
      if (strokes.size() > 2) strokes = {strokes[1]};
    for (const Order& order : orders()) {
      INFO("order " << text_of(order));
      auto strokes = in_order(alone, order);
      const auto found = assign_joints(strokes, known);
      CHECK(found.doubt.empty());
      CHECK(is_right(strokes, alone, order, true));
    }
  }
}

namespace {

/// A KR 5 whose axes 4 and 6 are one line at home, and what its joints sweep there.
struct StraightWrist {
  identify::Arm arm = identify::test::kr5_arc();
  std::vector<double> home_rad = arm.home_rad;
  std::array<SweptRange, 6> ranges = kNarrow;
};

StraightWrist straight_wrist() {
  StraightWrist wrist;
  wrist.home_rad[4] = 0;
  wrist.ranges[4] = {20, -20};
  return wrist;
}

}  // namespace

TEST_CASE("joints whose axes are one line at home stay apart, and which is which is in doubt",
          "[joint_assignment][issue11][point_22]") {
  const auto [arm, home, ranges] = straight_wrist();
  const Seen campaign = seen(arm, ranges, home);
  identify::Campaign known = described(campaign, home);
  const Order order{0, 1, 2, 3, 4, 5};
  auto strokes = in_order(campaign, order);
  auto found = assign_joints(strokes, known);
  CHECK(is_right(strokes, campaign, order, true));
  // Their strokes differ: 90, -30, -60 and 30, -30.
  CHECK(found.doubt.empty());
  known.order.clear();
  strokes = in_order(campaign, order);
  found = assign_joints(strokes, known);
  CHECK(warns(found, "order_ambiguous"));
  CHECK(found.doubt.find("1, 2, 3, 4, 5, 6 or 1, 2, 3, 6, 5, 4") != std::string::npos);
}

TEST_CASE("joints of one axis at home that sweep one after the other are parted as the plan says",
          "[joint_assignment]") {
  auto [arm, home, ranges] = straight_wrist();
  const bool alike = GENERATE(false, true);
  CAPTURE(alike);
  if (alike) ranges[3] = ranges[5] = {-40, 40};
  const Seen campaign = seen(arm, ranges, home);
  identify::Campaign known = described(campaign, home);
  std::swap(known.order[4], known.order[5]);
  const Order order{0, 1, 2, 3, 5, 4};
  auto strokes = in_order(campaign, order);
  SECTION("with the description") {
    const auto found = assign_joints(strokes, known);
    CHECK(is_right(strokes, campaign, order, true));
    CHECK(found.doubt.empty() != alike);  // the order of sweeps alone tells no joint
    CHECK(warns(found, "order_ambiguous") == alike);
    CHECK(found.warnings.size() == (alike ? 1 : 0));
  }
  SECTION("without it, as assumed") {
    known.specified.reset();
    const auto found = assign_joints(strokes, known);
    CHECK(is_right(strokes, campaign, order, false));
    CHECK_FALSE(warns(found, "order_mismatch"));
  }
  SECTION("and without the plan they are no joint's sweeps") {
    known.order.clear();
    const auto found = assign_joints(strokes, known);
    CHECK(warns(found, "order_ambiguous"));
    CHECK(found.doubt.find("is left out") != std::string::npos);
    std::size_t place = 0;
    for (const std::size_t joint : order)
      for (std::size_t k = 0; k < campaign.strokes[joint].size(); ++k) {
        const auto& told = strokes[place++].joint;
        CHECK((joint == 3 || joint == 5 ? !told : told == joint));
      }
  }
}

TEST_CASE("joints of one axis at home are parted where a plan has several rounds",
          "[joint_assignment]") {
  const auto [arm, home, ranges] = straight_wrist();
  const Seen campaign = seen(arm, ranges, home);
  identify::Campaign known = described(campaign, home);
  const bool in_turn = GENERATE(true, false);  // joint 5 between joints 4 and 6, or after both
  CAPTURE(in_turn);
  Order order{0, 1, 2, 3, 4, 5};
  if (!in_turn) {
    std::swap(order[4], order[5]);
    std::swap(known.order[4], known.order[5]);
  }
  for (int round = 1; round < 3; ++round)
    for (std::size_t j = 0; j < 6; ++j) {
      order.push_back(order[j]);
      known.order.push_back(known.order[j]);
    }
  SECTION("that was run") {}
  SECTION("that was run twice") {
    const Order once = order;
    order.insert(order.end(), once.begin(), once.end());
  }
  SECTION("whose last joint of the wrist did not sweep in one round") {
    order.erase(order.begin() + 5);
  }
  SECTION("without a description") {
    known.specified.reset();
    if (GENERATE(false, true)) order.insert(order.end(), order.begin(), order.begin() + 18);
    auto strokes = in_order(campaign, order);
    const auto found = assign_joints(strokes, known);
    CHECK(is_right(strokes, campaign, order, false));
    CHECK_FALSE(warns(found, "order_mismatch"));
    return;
  }
  auto strokes = in_order(campaign, order);
  const auto found = assign_joints(strokes, known);
  CHECK(found.doubt.empty());
  CHECK(found.warnings.empty());
  CHECK(is_right(strokes, campaign, order, true));
}

TEST_CASE("a plan or a description that is another's is said to be",
          "[joint_assignment][issue11][point_22]") {
  const auto arm = identify::test::kr5_arc();
  const Seen campaign = seen(arm, kNarrow, arm.home_rad);
  Seen planned = campaign;
  planned.ranges = kWide;
  identify::Campaign known;
  declare(known, planned, arm.home_rad);
  const Order order{0, 2, 1, 3, 4, 5};
  auto strokes = in_order(campaign, order);
  SECTION("with the description at hand, which tells the order and the directions") {
    known.specified = arm;
    const auto found = assign_joints(strokes, known);
    CHECK(warns(found, "plan_contradicted"));
    CHECK(warns(found, "order_differs"));
    CHECK(found.doubt.empty());
    CHECK(found.senses_known);
    CHECK(is_right(strokes, campaign, order, true));
  }
  SECTION("a description that turns two joints the other way") {
    known.order.clear();
    declare(known, campaign, arm.home_rad);
    known.specified = arm;
    for (const std::size_t joint : {1U, 4U}) known.specified->positive[joint] *= -1;
    strokes = in_order(campaign, {0, 1, 2, 3, 4, 5});
    const auto found = assign_joints(strokes, known);
    CHECK(found.against_plan == Order{1, 4});
    CHECK_FALSE(warns(found, "plan_contradicted"));  // the circles say so, of all joints at once
  }
  SECTION("without it") {
    const auto found = assign_joints(strokes, known);
    CHECK(warns(found, "plan_contradicted"));
    CHECK_FALSE(found.senses_known);
    CHECK_FALSE(found.doubt.empty());
  }
  SECTION("the description of a longer arm") {
    known.specified = arm;
    known.specified->rows[1].a_mm += 80;
    known.specified->rows[2].a_mm -= 60;
    const auto found = assign_joints(strokes, known);
    CHECK(found.doubt.find("no order agrees with the robot description") != std::string::npos);
    CHECK(warns(found, "order_assumed"));
  }
}

TEST_CASE("strokes that a stream saw in pieces are those of their plan",
          "[joint_assignment][issue12]") {
  const auto arm = identify::test::kr5_arc();
  const double every_s = GENERATE(3.0, 7.0);
  CAPTURE(every_s);
  identify::test::Campaign run(arm, {.position_mm = 0.02});
  run.rest();
  for (std::size_t j = 0; j < 6; ++j) run.sweep(j, kWide[j].start_deg, kWide[j].end_deg);
  identify::PositionSegmenter segmenter;
  std::vector<Sweep> strokes;
  const auto take = [&](std::vector<Sweep> ended) {
    std::move(ended.begin(), ended.end(), std::back_inserter(strokes));
  };
  for (const auto& sample : identify::test::without_angles(run.samples()))
    if (std::fmod(sample.time_s, every_s) > 1) take(segmenter.push({{0, sample}}));
  take(segmenter.finish());
  const auto whole = [](const Sweep& stroke) { return stroke.begin_seen && stroke.end_seen; };
  CHECK(std::count_if(strokes.begin(), strokes.end(), whole) > 0);
  CHECK_FALSE(std::all_of(strokes.begin(), strokes.end(), whole));

  Seen planned{arm, kWide, {}};
  const auto assigned = [&] {
    identify::Campaign known;
    known.specified = arm;
    declare(known, planned, arm.home_rad);
    return assign_joints(strokes, known);
  };
  SECTION("as they are") {
    const auto found = assigned();
    CHECK_FALSE(warns(found, "plan_contradicted"));
    CHECK(found.doubt.empty());
    CHECK(found.senses_known);
  }
  SECTION("and not those of another's, as far as they were seen whole") {
    planned.ranges = kNarrow;
    CHECK(warns(assigned(), "plan_contradicted"));
  }
}

TEST_CASE("short strokes whose own circles noise turns are still those of the plan",
          "[joint_assignment][issue12][long]") {
  const auto arm = identify::test::kr5_arc();
  // 10 degrees from home alone tell their radius badly.
  auto ranges = kWide;
  for (std::size_t j = 0; j < 6; ++j) {
    ranges[j].start_deg = arm.home_rad[j] / kDegree + 10;
    ranges[j].end_deg = ranges[j].start_deg - 60;
  }
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    INFO("seed " << seed);
    const Seen campaign = seen(arm, ranges, arm.home_rad, {.position_mm = 0.3, .seed = seed});
    identify::Campaign known = described(campaign, arm.home_rad);
    const Order order{0, 1, 2, 3, 4, 5};
    auto strokes = in_order(campaign, order);
    const auto found = assign_joints(strokes, known);
    CHECK_FALSE(warns(found, "plan_contradicted"));
    CHECK(found.doubt.empty());
    CHECK(is_right(strokes, campaign, order, true));
  }
}

TEST_CASE("joints that have nothing but short strokes do not contradict their plan in noise",
          "[joint_assignment][issue12][long]") {
  const auto arm = identify::test::kr5_arc();
  auto ranges = kWide;
  for (std::size_t j = 0; j < 6; ++j) {
    ranges[j].start_deg = arm.home_rad[j] / kDegree;
    ranges[j].end_deg = ranges[j].start_deg + 10;
  }
  for (unsigned seed = 1; seed <= 10; ++seed) {
    INFO("seed " << seed);
    const Seen campaign = seen(arm, ranges, arm.home_rad, {.position_mm = 0.3, .seed = seed});
    identify::Campaign known = described(campaign, arm.home_rad);
    auto strokes = in_order(campaign, {0, 1, 2, 3, 4, 5});
    const auto found = assign_joints(strokes, known);
    CHECK_FALSE(warns(found, "plan_contradicted"));
  }
}

TEST_CASE("arcs about ever new axes are no campaign, and cost no more than their number",
          "[joint_assignment][issue11][point_22]") {
  std::mt19937 random(24);
  std::normal_distribution<> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  std::vector<Sweep> strokes;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d centre = 300 * vector();
    const Eigen::Vector3d x = vector().normalized();
    std::vector<identify::Sample> samples(60);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double angle = 0.02 * static_cast<double>(i);
      samples[i].position_mm =
          centre + 200 * (std::cos(angle) * x + std::sin(angle) * x.unitOrthogonal());
      samples[i].has_position = true;
    }
    Sweep& stroke = strokes.emplace_back();
    stroke.range_rad = 1.2;
    stroke.samples = std::make_shared<const std::vector<identify::Sample>>(std::move(samples));
  }
  identify::Campaign known;
  known.specified = identify::test::kr5_arc();
  const auto found = assign_joints(strokes, known);
  REQUIRE(warns(found, "order_mismatch"));
  CHECK(found.warnings[0].message.find("12 or more axes") != std::string::npos);
  CHECK_FALSE(found.doubt.empty());
}

TEST_CASE("each target tells the joints by itself, and all have to agree",
          "[joint_assignment][issue11][point_22]") {
  const auto arm = identify::test::kr5_arc();
  auto other = arm;
  other.tool_mm = {0, 150, 300};
  const Seen first = seen(arm, kNarrow, arm.home_rad);
  const Seen second = seen(other, kNarrow, arm.home_rad);
  const Order order{0, 2, 1, 3, 4, 5};
  const auto interleaved = [&](const Order& of_second) {
    const auto a = in_order(first, order);
    const auto b = in_order(second, of_second);
    std::vector<Sweep> both;
    for (std::size_t k = 0; k < a.size(); ++k) {
      both.push_back(a[k]);
      both.push_back(b[k]);
      both.back().target = 1;
    }
    return both;
  };
  identify::Campaign known;
  known.specified = arm;
  auto strokes = interleaved(order);
  CHECK(assign_joints(strokes, known).doubt.empty());
  std::vector<Sweep> of_second;
  for (const Sweep& stroke : strokes)
    if (stroke.target == 1) of_second.push_back(stroke);
  CHECK(is_right(of_second, second, order, true));
  // Of the second target joint 5 was not seen.
  auto unseen = strokes;
  for (Sweep& stroke : unseen) stroke.joint.reset();
  std::size_t place = 0;
  std::erase_if(unseen, [&](const Sweep& stroke) {
    return strokes[place++].joint == 4U && stroke.target == 1;
  });
  CHECK(assign_joints(unseen, known).doubt.empty());
  auto torn = interleaved({0, 1, 2, 3, 4, 5});
  CHECK(warns(assign_joints(torn, known), "order_ambiguous"));
}

TEST_CASE("targets that saw parts of a campaign tell its joints together", "[joint_assignment]") {
  const auto arm = identify::test::kr5_arc();
  auto other = arm;
  other.tool_mm = {0, 150, 300};
  const Seen first = seen(arm, kWide, arm.home_rad);
  const Seen second = seen(other, kWide, arm.home_rad);
  identify::Campaign known;
  known.specified = arm;
  // A marker that gets another name, or is out of sight: before, amid and behind joint 3's sweep.
  for (std::size_t cut = 0; cut <= first.strokes[2].size(); ++cut) {
    CAPTURE(cut);
    std::vector<Sweep> strokes;
    for (std::size_t j = 0; j < 6; ++j)
      for (std::size_t s = 0; s < first.strokes[j].size(); ++s) {
        const bool by_first = j < 2 || (j == 2 && s < cut) || j == 5;
        const bool by_second = j > 2 || (j == 2 && s >= cut);
        for (const bool of_second : {false, true}) {
          if (!(of_second ? by_second : by_first)) continue;
          strokes.push_back((of_second ? second : first).strokes[j][s]);
          strokes.back().target = of_second ? 1 : 0;
        }
      }
    auto assigned = strokes;
    for (Sweep& stroke : assigned) {
      stroke.joint.reset();
      stroke.direction = 0;
    }
    const auto found = assign_joints(assigned, known);
    CHECK(found.doubt == "");
    CHECK(found.warnings.empty());
    for (std::size_t s = 0; s < strokes.size(); ++s) {
      CHECK(assigned[s].joint == strokes[s].joint);
      CHECK(assigned[s].direction == strokes[s].direction);
    }
  }
}

TEST_CASE("a result whose order of joints was assumed is not complete, and says why",
          "[joint_assignment][issue11][point_22][long]") {
  const auto arm = identify::test::kr5_arc();
  const Seen campaign = seen(arm, kNarrow, arm.home_rad);
  identify::Campaign known;
  declare(known, campaign, arm.home_rad);
  const auto assumed = identify::identify(in_order(campaign, {0, 2, 1, 3, 4, 5}), known);
  CHECK(assumed.status == identify::Status::partial);
  CHECK(assumed.reason.find("is assumed") != std::string::npos);
  // Also where an axis is missing.
  const auto fewer = identify::identify(in_order(campaign, {0, 2, 1, 3, 4}), known);
  CHECK(fewer.status == identify::Status::partial);
  CHECK(fewer.reason.find("no axis for joint 6") != std::string::npos);
  CHECK(fewer.reason.find("is assumed") != std::string::npos);
  known.specified = arm;
  const auto told = identify::identify(in_order(campaign, {0, 2, 1, 3, 4, 5}), known);
  CHECK(told.status == identify::Status::complete);
  CHECK(std::abs(told.dh[1].a_mm.value - 600) < 0.2);
  CHECK(std::abs(told.dh[3].b_mm.value - 620) < 0.2);
}
