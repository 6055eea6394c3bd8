#include "identify/target_distances.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "identify/identification.hpp"
#include "identify/sweeps/sample.hpp"
#include "tests/catch.hpp"

using namespace identify;
using Catch::Matchers::ContainsSubstring;
using Eigen::Vector3d;

namespace {

using Places = std::array<Vector3d, 3>;
const Places kPlaces{Vector3d(0, 0, 0), Vector3d(60, 10, 0), Vector3d(-20, 45, 30)};

/// Six joints turn the body one after the other, there and back, seen in noise of 0.1 mm.
/// `places_at`: where the targets are on it in each stroke, of twelve.
template <class PlacesAt>
Identification seen(const PlacesAt& places_at, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<> noise(0, 0.1);
  Identification found;
  found.joints.resize(6);
  double time_s = 0;
  for (std::size_t stroke = 0; stroke < 12; ++stroke) {
    Vector3d axis;
    for (double& coordinate : axis) coordinate = noise(random);
    axis.normalize();
    std::array<std::vector<Sample>, 3> samples;
    for (int k = 0; k < 60; ++k, time_s += 0.02)
      for (std::size_t t = 0; t < 3; ++t) {
        Sample sample;
        sample.time_s = time_s;
        sample.has_position = true;
        sample.position_mm =
            Eigen::AngleAxisd(0.02 * k, axis) * (Vector3d(500, 200, 100) + places_at(stroke)[t]);
        for (double& coordinate : sample.position_mm) coordinate += noise(random);
        samples[t].push_back(sample);
      }
    for (std::size_t t = 0; t < 3; ++t) {
      Sweep sweep;
      sweep.joint = stroke / 2;
      sweep.target = t;
      sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples[t]));
      found.joints[stroke / 2].sweeps.push_back(sweep);
    }
  }
  return found;
}

Places with(std::size_t target, const Vector3d& by) {
  Places places = kPlaces;
  places[target] += by;
  return places;
}

}  // namespace

TEST_CASE("targets that stay where they are on the tool change no distance", "[target_distances]") {
  for (std::uint32_t seed = 1; seed <= 20; ++seed)
    CHECK_FALSE(changed_distances(seen([](std::size_t) { return kPlaces; }, seed)));
}

TEST_CASE("a target that slips on the tool is told, and from which sweep on",
          "[target_distances]") {
  const std::size_t slips = GENERATE(0U, 1U, 2U);
  const auto doubt = changed_distances(seen(
      [&](std::size_t stroke) {
        return stroke < 6 ? kPlaces : with(slips, {3, 2, 3});
      },
      7));
  REQUIRE(doubt);
  CHECK(doubt->code == "target_moved");
  CHECK(doubt->joint == 3U);
  CHECK_THAT(doubt->message,
             ContainsSubstring("target " + std::to_string(slips + 1) + " was moved"));
}

TEST_CASE("targets that have exchanged their names are told", "[target_distances]") {
  const auto doubt = changed_distances(seen(
      [&](std::size_t stroke) {
        Places places = kPlaces;
        if (stroke >= 5) std::swap(places[0], places[2]);
        return places;
      },
      8));
  REQUIRE(doubt);
  CHECK(doubt->joint == 2U);
  CHECK_THAT(doubt->message, ContainsSubstring("target 1 and target 3 have exchanged their names"));
}

TEST_CASE("targets that change places for one sweep have not moved", "[target_distances]") {
  CHECK_FALSE(changed_distances(seen(
      [](std::size_t stroke) {
        return stroke == 5 ? with(1, {5, 5, 5}) : kPlaces;
      },
      9)));
}
