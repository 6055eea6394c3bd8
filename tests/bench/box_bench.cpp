// How small and how fast the bounding box is, beside CGAL's oriented_bounding_box with its
// optimisation, on the points of six sweeps. CGAL's is seeded at random: its best volume of ten
// runs counts, and the time of one.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/optimal_bounding_box.h>
#include <CLI/CLI.hpp>

#include "identify/geometry/bounding_box.hpp"
#include "identify/sweeps/sample.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/bench/table.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace {

constexpr double kMostVolume = 1e-6;
constexpr double kRatioWanted = 10;
constexpr int kSeeds = 10;

Eigen::Matrix3Xd points(int arc_deg, double noise_mm, int samples) {
  accuracy::Simulated robot;
  robot.arm = identify::test::kr5_arc();
  robot.targets_mm = {{200, 0, 215}};
  robot.samples = samples;
  if (arc_deg == 90)  // Table 2 of the paper; joint 2's is 70 degrees
    robot.ranges = {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}};
  else
    robot.ranges = {{-15, 15}, {-60, -90}, {120, 90}, {90, 60}, {90, 60}, {0, 30}};
  std::vector<identify::Sample> all;
  for (const auto& sweep : sweeps_of(robot, accuracy::tracker(noise_mm), 1))
    all.insert(all.end(), sweep.samples->begin(), sweep.samples->end());
  return identify::positions(all);
}

double volume_by_cgal(const Eigen::Matrix3Xd& points) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  std::vector<Point> input;
  for (const auto& point : points.colwise()) input.emplace_back(point(0), point(1), point(2));
  std::array<Point, 8> corner;
  CGAL::oriented_bounding_box(input, corner, CGAL::parameters::use_convex_hull(true));
  // Corners 0, 1, 2, 3 are the bottom's, in turn; 5 is above 0.
  const auto length = [&](std::size_t to) {
    return std::sqrt(CGAL::squared_distance(corner[0], corner[to]));
  };
  return length(1) * length(3) * length(5);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool measure(int arc_deg, double noise_mm, int samples) {
  using bench::right;
  const auto set = points(arc_deg, noise_mm, samples);
  std::vector<double> cgal_times, times, volumes;
  double volume = 0;
  for (int k = 0; k < kSeeds; ++k) {
    cgal_times.push_back(seconds([&] { volumes.push_back(volume_by_cgal(set)); }));
    times.push_back(seconds([&] {
      const auto box = identify::minimum_bounding_box(set);
      if (!box) throw std::runtime_error("no box");
      volume = box->volume_mm3();
    }));
  }
  const auto [least, most] = std::minmax_element(volumes.begin(), volumes.end());
  const double above = volume / std::min(volume, *least) - 1;
  const double ratio = median(cgal_times) / median(times);
  std::cout << right(std::to_string(arc_deg), 4) << right(noise_mm, 2, 7)
            << right(1e3 * median(cgal_times), 1, 12) << right(1e3 * median(times), 2, 12)
            << right(ratio, 1, 9) << right(1e-6 * volume, 6, 16)
            << right(1e6 * (volume / *least - 1), 3, 16) << right(1e6 * (volume / *most - 1), 3, 16)
            << std::endl;
  return above <= kMostVolume && ratio >= kRatioWanted;
}

}  // namespace

int main(int argc, char** argv) {
  int samples = 1500;
  CLI::App app("The smallest box against CGAL's", "bench_box");
  app.add_option("--samples", samples, "In each of the six sweeps")
      ->check(CLI::Range(10, 10'000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv)
  try {
    std::cout << "bounding box of six sweeps of " << samples << " samples; CGAL's volume: of "
              << kSeeds << " seeds\n"
              << " arc  noise     CGAL ms     ours ms    ratio     volume 1e6  to its best 1e-6"
              << "  to its worst" << std::endl;
    bool good = true;
    for (const int arc : {90, 30})
      for (const double noise : {0.0, 0.02}) good = measure(arc, noise, samples) && good;
    if (!good) {
      std::cout << "not as promised: a tenth of CGAL's time, no volume above its best by 1e-6\n";
      return 1;
    }
  } catch (const std::exception& error) {
    std::cerr << "bench_box: " << error.what() << '\n';
    return 1;
  }
}
