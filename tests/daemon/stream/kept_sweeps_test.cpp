#include "daemon/stream/kept_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "daemon/text/units.hpp"
#include "identify/identification.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/simulation.hpp"

using identify::Sample;
using identify::Sweep;
using sweepd::KeptSweeps;

namespace {

constexpr std::size_t kSamples = 100;
constexpr std::size_t kMemory = kSamples + KeptSweeps::kOfSweep;  // of a usual sweep

struct Way {
  std::size_t joint = 0;
  double from_deg = 0;
  double to_deg = 0;
  double home_deg = 0;  ///< of all other joints
};

/// The target goes round the axis of its joint, each of which lies elsewhere.
Eigen::Vector3d place(const Way& way, double angle_deg) {
  const double angle = sweepd::radians(angle_deg);
  const double x = 500 * std::cos(angle), y = 500 * std::sin(angle);
  const double off = 1000.0 * static_cast<double>(way.joint) + 10 * way.home_deg;
  return way.joint % 2 == 0 ? Eigen::Vector3d(x, y, off) : Eigen::Vector3d(off, x, y);
}

/// Begins at second `number`: that tells it from the others.
Sweep sweep(const Way& way, int number, bool with_angles = true, std::size_t count = kSamples) {
  std::vector<Sample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    const double angle_deg = way.from_deg + share * (way.to_deg - way.from_deg);
    samples[i].time_s = number + share / 2;
    samples[i].position_mm = place(way, angle_deg);
    samples[i].has_position = true;
    if (!with_angles) continue;
    samples[i].joints = 6;
    for (std::size_t k = 0; k < 6; ++k)
      samples[i].angles_rad[k] = sweepd::radians(k == way.joint ? angle_deg : way.home_deg);
  }
  Sweep result;
  result.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  if (with_angles) result.joint = way.joint;
  if (with_angles) result.direction = way.to_deg > way.from_deg ? 1 : -1;
  result.range_rad = sweepd::radians(std::abs(way.to_deg - way.from_deg));
  return result;
}

std::vector<int> numbers(const KeptSweeps& kept) {
  std::vector<int> found;
  for (const Sweep& one : kept.sweeps())
    found.push_back(static_cast<int>(std::lround(one.first().time_s)));
  return found;
}

std::size_t memory(const KeptSweeps& kept) {
  std::size_t sum = 0;
  for (const Sweep& one : kept.sweeps()) sum += one.samples->size() + KeptSweeps::kOfSweep;
  return sum;
}

/// Runs a program over and over: sweep n is number n % its size.
void play(KeptSweeps& kept, const std::vector<Way>& program, int rounds, bool with_angles = true) {
  int number = 0;
  for (int round = 0; round < rounds; ++round)
    for (const Way& way : program) kept.keep(sweep(way, number++, with_angles));
}

/// To a start, there and back, home: of each joint.
std::vector<Way> usual_program() {
  std::vector<Way> program;
  for (std::size_t joint = 0; joint < 3; ++joint)
    program.insert(program.end(),
                   {{joint, 0, -45}, {joint, -45, 45}, {joint, 45, -45}, {joint, -45, 0}});
  return program;
}

}  // namespace

TEST_CASE("all sweeps are kept while there is memory", "[kept_sweeps]") {
  KeptSweeps kept(24 * kMemory);
  play(kept, usual_program(), 2);
  CHECK(kept.sweeps().size() == 24);
  CHECK(kept.left_out().sweeps == 0);
  CHECK_FALSE(kept.left_out().kinds);
  CHECK(kept.left_out().sample_stride == 1);
}

TEST_CASE("what a program repeats is kept in whole rounds, spread evenly over the stream",
          "[kept_sweeps][long]") {
  const auto program = usual_program();
  const auto kinds = static_cast<int>(program.size());
  constexpr int kRounds = 250;
  for (const std::size_t most : {60U, 61U, 66U, 71U, 100U}) {
    CAPTURE(most);
    KeptSweeps kept(most * kMemory);
    play(kept, program, kRounds);
    CHECK(memory(kept) <= most * kMemory);
    CHECK(kept.sweeps().size() > most / 2 - program.size());
    CHECK(kept.left_out().sweeps == program.size() * kRounds - kept.sweeps().size());
    CHECK_FALSE(kept.left_out().kinds);
    const auto found = numbers(kept);
    CHECK(found.front() == 0);
    const int gap = found.at(program.size()) / kinds;  // rounds
    CHECK((gap & (gap - 1)) == 0);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const auto round = static_cast<int>(k) / kinds;
      CHECK(found[k] == round * gap * kinds + static_cast<int>(k) % kinds);
    }
    CHECK(found.back() >= (kRounds - gap) * kinds - kinds);
  }
}

TEST_CASE("what goes stays as sums, and a copy that was taken does not change", "[kept_sweeps]") {
  constexpr int kRounds = 200;
  const auto program = usual_program();
  KeptSweeps kept(60 * kMemory);
  play(kept, program, kRounds / 2);
  const auto strokes = [](const std::vector<Sweep>& sweeps) {
    std::size_t sum = sweeps.size();
    for (const Sweep& one : sweeps)
      if (one.repeats) sum += one.repeats->strokes;
    return sum;
  };
  const auto before = kept.sweeps();
  CHECK(strokes(before) == program.size() * kRounds / 2);
  play(kept, program, kRounds / 2);
  CHECK(strokes(before) == program.size() * kRounds / 2);
  CHECK(strokes(kept.sweeps()) == program.size() * kRounds);
  for (const Sweep& one : kept.sweeps())
    if (one.repeats) {
      CHECK(one.first().time_s < static_cast<double>(program.size()));
      CHECK(one.repeats->samples == one.repeats->strokes * kSamples);
      CHECK_FALSE(one.repeats->squares);
    }
}

TEST_CASE("with memory for an eighth of the sweeps the numbers are as certain as with all",
          "[kept_sweeps][long]") {
  simulation::World world;
  world.noise.range_mm = world.noise.across_mm = 0.02;
  world.home.sigma_deg = GENERATE(0.0, 0.001);
  world.angles = GENERATE(false, true);
  CAPTURE(world.home.sigma_deg, world.angles);
  simulation::Strokes often;
  often.repeats = 16;
  often.samples = 200;
  const simulation::Simulation campaign(simulation::kr5(1), often, world, 7);
  const auto sweeps = campaign.sweeps();
  const auto identified = [&](std::size_t share) {
    KeptSweeps kept(sweeps.size() * (200 + KeptSweeps::kOfSweep) / share);
    for (const Sweep& one : sweeps) kept.keep(one);
    CHECK(kept.sweeps().size() <= sweeps.size() / share);
    auto found = identify::identify(kept.sweeps(), campaign.campaign());
    REQUIRE(found.chain);
    if (world.home.sigma_deg == 0)
      CHECK(found.chain->summed == sweeps.size() - kept.sweeps().size());
    return found;
  };
  const auto whole = identified(1);
  const auto eighth = identified(8);
  CHECK(eighth.chain->samples > whole.chain->samples / 2);
  REQUIRE(eighth.dh_covariance.rows() == whole.dh_covariance.rows());
  double ratios = 0, numbers = 0;
  for (Eigen::Index k = 0; k < whole.dh_covariance.rows(); ++k) {
    const double all = whole.dh_covariance(k, k);
    if (all == 0) continue;
    ratios += std::sqrt(eighth.dh_covariance(k, k) / all);
    ++numbers;
  }
  CHECK(numbers >= 18);
  // Without the sums it is 2.8. Whether errors of whole strokes average out no sum tells.
  CHECK(ratios / numbers < (world.home.sigma_deg > 0 ? 2.8 : 1.2));
  CHECK(ratios / numbers > 0.8);
}

TEST_CASE("no kind is lost because of its place in the program", "[kept_sweeps]") {
  // Every second, fourth or eighth sweep of a joint has another home, or goes the other way.
  for (const int period : {2, 4, 8}) {
    std::vector<Way> program;
    for (int k = 0; k < period; ++k) {
      program.push_back({0, 0, 60, 5.0 * k});
      program.push_back({1, 0, k % 2 == 0 ? 60.0 : -60.0, 5});
    }
    KeptSweeps kept(64 * kMemory);
    play(kept, program, 150);
    std::set<long> homes;
    std::set<int> directions;
    for (const Sweep& one : kept.sweeps()) {
      if (one.joint == 0U) homes.insert(std::lround(sweepd::degrees(one.first().angles_rad[1])));
      if (one.joint == 1U) directions.insert(one.direction);
    }
    CHECK(homes.size() == static_cast<std::size_t>(period));
    CHECK(directions.size() == 2);
  }
}

TEST_CASE("what was swept once stays, whenever that was", "[kept_sweeps]") {
  KeptSweeps kept(60 * kMemory);
  const auto program = usual_program();
  int number = 0;
  std::vector<int> once;
  for (int round = 0; round < 300; ++round) {
    for (const Way& way : program) kept.keep(sweep(way, number++));
    if (round == 0) {
      once.push_back(number);
      kept.keep(sweep({5, 0, 90}, number++));  // a joint
    }
    if (round == 150) {
      once.push_back(number);
      kept.keep(sweep({1, -45, 45, 20}, number++));  // another home
      once.push_back(number);
      kept.keep(sweep({1, -45, 30}, number++));  // another range
      Sweep defective = sweep({1, -45, 45}, number);
      defective.defect = identify::SweepDefect::other_joint_moved;
      once.push_back(number++);
      kept.keep(defective);
      Sweep of_other_target = sweep({1, -45, 45}, number);
      of_other_target.target = 1;
      once.push_back(number++);
      kept.keep(of_other_target);
    }
  }
  const auto found = numbers(kept);
  CHECK(std::is_sorted(found.begin(), found.end()));
  for (const int one : once) CHECK(std::count(found.begin(), found.end(), one) == 1);
}

TEST_CASE("sweeps are of one kind though their ends and homes are seen a little differently",
          "[kept_sweeps]") {
  KeptSweeps kept(10 * kMemory);
  for (int k = 0; k < 200; ++k)
    kept.keep(sweep({0, 0.5 * (k % 3), 60 - 0.4 * (k % 2), 0.1 * (k % 2)}, k));
  CHECK_FALSE(kept.left_out().kinds);
  CHECK(kept.sweeps().size() > 4);
  CHECK(kept.sweeps().size() <= 10);
}

TEST_CASE("kinds without end are spread over the stream, by joint and direction", "[kept_sweeps]") {
  KeptSweeps kept(60 * kMemory);
  constexpr int kPoses = 500;
  int number = 0;
  for (int pose = 0; pose < kPoses; ++pose)
    for (std::size_t joint = 0; joint < 3; ++joint) {
      kept.keep(sweep({joint, 0, 60, 1.0 * pose}, number++));
      kept.keep(sweep({joint, 60, 0, 1.0 * pose}, number++));
    }
  CHECK(kept.left_out().kinds);
  CHECK(kept.left_out().sweeps == 6U * kPoses - kept.sweeps().size());
  CHECK(memory(kept) <= 60 * kMemory);
  std::map<int, std::vector<int>> poses;  // by joint and direction
  for (const int found : numbers(kept)) poses[found % 6].push_back(found / 6);
  CHECK(poses.size() == 6);
  for (const auto& [kind, found] : poses) {
    REQUIRE(found.size() >= 4);
    CHECK(found.front() == 0);
    for (std::size_t k = 2; k < found.size(); ++k)
      CHECK(found[k] - found[k - 1] == found[1] - found[0]);
    CHECK(found.back() + found[1] >= kPoses - 1);
  }
}

TEST_CASE("a program is kept beside kinds without end", "[kept_sweeps]") {
  KeptSweeps kept(60 * kMemory);
  const auto program = usual_program();
  int number = 0;
  std::map<int, std::size_t> of_program;
  for (int round = 0; round < 500; ++round) {
    for (const Way& way : program) kept.keep(sweep(way, number++));
    kept.keep(sweep({4, 0, 60, 1.0 + round}, number++));
  }
  for (const int found : numbers(kept)) ++of_program[found % 13];
  CHECK(of_program.size() == 13);
  for (const auto& [kind, count] : of_program) CHECK(count > 1);
}

TEST_CASE("without angles whole turns of the program are kept, however often they repeat a sweep",
          "[kept_sweeps]") {
  std::vector<Way> program;
  for (std::size_t joint = 0; joint < 2; ++joint)
    program.insert(
        program.end(),
        {{joint, 0, -45}, {joint, -45, 45}, {joint, 45, -45}, {joint, -45, 45}, {joint, 45, 0}});
  KeptSweeps kept(64 * kMemory);
  play(kept, program, 300, false);
  const auto found = numbers(kept);
  REQUIRE(found.size() % 10 == 0);
  REQUIRE(found.size() >= 30);
  CHECK(found.size() <= 64);
  for (std::size_t k = 0; k < found.size(); ++k) {
    CHECK(found[k] % 10 == static_cast<int>(k % 10));
    CHECK(found[k] / 10 == found[k - k % 10] / 10);
  }
  CHECK(found.back() > 3000 / 2);
}

TEST_CASE("without angles the earliest of kinds without end stay", "[kept_sweeps]") {
  KeptSweeps kept(60 * kMemory);
  for (int k = 0; k < 1000; ++k)
    kept.keep(sweep({static_cast<std::size_t>(k) % 6, 0, 60, 100.0 * k}, k, false));
  CHECK(kept.left_out().kinds);
  const auto found = numbers(kept);
  REQUIRE(found.size() >= 12);
  for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k] == static_cast<int>(k));
}

TEST_CASE("sweeps lose samples before a kind is lost", "[kept_sweeps]") {
  constexpr std::size_t kLongOne = 800;
  constexpr int kPoses = 40;
  KeptSweeps kept(60 * (kLongOne + KeptSweeps::kOfSweep));
  int number = 0;
  for (int pose = 0; pose < kPoses; ++pose)
    for (std::size_t joint = 0; joint < 3; ++joint)
      kept.keep(sweep({joint, 0, 60, 1.0 * pose}, number++, true, kLongOne));
  CHECK_FALSE(kept.left_out().kinds);
  CHECK(kept.sweeps().size() == 3U * kPoses);
  CHECK(kept.left_out().sample_stride == 4);
}

TEST_CASE("long sweeps lose samples where there is no room for one of each", "[kept_sweeps]") {
  constexpr std::size_t kMost = 100'000;
  KeptSweeps kept(kMost);
  for (int k = 0; k < 40; ++k)
    kept.keep(sweep({static_cast<std::size_t>(k) % 6, 0, 60}, k, true, 20'000));
  const std::size_t stride = kept.left_out().sample_stride;
  CHECK(stride == 4);
  CHECK(kept.left_out().sweeps < 40);
  CHECK(memory(kept) <= kMost);
  for (const Sweep& one : kept.sweeps()) {
    CHECK(one.samples->size() == 20'000 / stride);
    CHECK(sweepd::degrees(one.first().angles_rad[*one.joint]) == Approx(0).margin(1e-9));
    CHECK(sweepd::degrees(one.last().angles_rad[*one.joint]) == Approx(60).margin(0.1));
  }
}

TEST_CASE("memory is never exceeded, whatever comes", "[kept_sweeps]") {
  constexpr std::size_t kMost = 20'000;
  KeptSweeps kept(kMost);
  std::uint32_t state = 1;
  const auto chance = [&](std::uint32_t below) {
    state = 1'664'525 * state + 1'013'904'223;
    return (state >> 8) % below;
  };
  std::size_t most = 0;
  for (int k = 0; k < 3000; ++k) {
    const double from = chance(4) * 10.0, to = from + 20 + chance(5) * 20;
    Sweep one = sweep({chance(6), chance(2) == 0 ? from : to, chance(2) == 0 ? to : from + 5,
                       1.0 * chance(k < 1000 ? 3 : 2000)},
                      k, chance(3) > 0, std::size_t{10} << chance(10));
    one.defect = static_cast<identify::SweepDefect>(chance(8) < 5 ? 0 : chance(5));
    kept.keep(one);
    most = std::max(most, memory(kept));
    REQUIRE(most <= kMost);
  }
  CHECK(most > kMost / 2);
  CHECK(kept.left_out().sweeps + kept.sweeps().size() == 3000);
  const auto found = numbers(kept);
  CHECK(std::is_sorted(found.begin(), found.end()));
}
