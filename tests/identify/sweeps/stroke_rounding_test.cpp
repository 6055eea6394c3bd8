#include "identify/sweeps/stroke_rounding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/QR>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/sweeps/stroke_moments.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Coordinates = StrokeRounding::Coordinates;

namespace {

constexpr double kStep_mm = 0.1;
constexpr double kStep_rad = 0.1 * kDegree;
constexpr double kWhole_rad2 = kStep_rad * kStep_rad / 12;

/// Variances in that of all rounding. The target turns about Z by 60 degrees and is lifted by so
/// many steps a radian; A, B and C go on by so many steps a sample, from beside the middle of one.
/// The target shakes along its arc by so many steps of an angle.
std::array<Coordinates, 3> shifts(const std::array<double, 3>& steps_a_sample, double radius_mm,
                                  int samples, double shakes = 0, double lifted_steps = 0) {
  test::Random random(3);
  auto all = std::make_shared<std::vector<Sample>>();
  const auto printed = [](double value, double step) { return std::round(value / step) * step; };
  for (int i = 0; i < samples; ++i) {
    const double turn = kPi / 3 * i / (samples - 1);
    Sample sample;
    sample.time_s = 0.004 * i;
    sample.has_position = sample.has_orientation = true;
    const double there = turn + random.normal(shakes * kStep_rad);
    sample.position_mm = {printed(radius_mm * std::cos(there), kStep_mm),
                          printed(radius_mm * std::sin(there), kStep_mm),
                          printed(300.13 + lifted_steps * kStep_mm * turn, kStep_mm)};
    for (std::size_t k = 0; k < 3; ++k)
      sample.abc_rad[k] = printed((0.3 + steps_a_sample[k] * i) * kStep_rad, kStep_rad);
    all->push_back(sample);
  }
  Sweep sweep;
  sweep.samples = all;
  const auto stroke = moments_of(sweep, {0, 0, true, false, {kStep_mm, kStep_rad}});
  REQUIRE(stroke);
  auto found = stroke->rounding.shifts(kStep_mm, kStep_rad);
  for (Coordinates& variances : found) {
    variances.head<3>() /= kStep_mm * kStep_mm / 12;
    variances.tail<3>() /= kWhole_rad2;
  }
  return found;
}

}  // namespace

TEST_CASE("a coordinate that stays is shifted by all that rounding takes away",
          "[stroke_rounding]") {
  const auto [level, growth, bend] = shifts({0, 0.618, 0}, 500, 400);
  for (const int stays : {2, 3, 5}) {
    CHECK(level(stays) == Approx(1));
    // It may move within the step: three tenths of what a saw tooth of one period has.
    CHECK(growth(stays) == Approx(0.18));
    CHECK(bend(stays) == Approx(0.42));
  }
  // Those that pass many steps unevenly are not.
  for (const int passes : {0, 1, 4}) {
    CHECK(level(passes) < 0.01);
    CHECK(growth(passes) < 0.01);
    CHECK(bend(passes) < 0.01);
  }
}

TEST_CASE("a coordinate that goes on by a whole number of steps, nearly, is shifted and tilted",
          "[stroke_rounding]") {
  const auto [level, growth, bend] = shifts({1.001, 2.002, 0.37}, 500, 400);
  for (const int even : {3, 4}) {
    CHECK(level(even) > 0.7);
    CHECK(growth(even) > 0.4);
  }
  CHECK(level(5) < 0.01);
}

TEST_CASE("what is said of a coordinate that passes few steps is what rounding does to it",
          "[stroke_rounding]") {
  const double least_steps = GENERATE(1.0, 3.0, 10.0, 30.0);
  constexpr int kStrokes = 60, kSamples = 300;
  test::Random random(5);
  Eigen::Array3d does = Eigen::Array3d::Zero(), said = does;  // variances by order
  for (int stroke = 0; stroke < kStrokes; ++stroke) {
    const double steps = least_steps + random.uniform(0, 1), begins = random.uniform(0, 1);
    Eigen::MatrixX3d orders(kSamples, 3);
    Eigen::VectorXd off(kSamples);
    auto all = std::make_shared<std::vector<Sample>>();
    for (int i = 0; i < kSamples; ++i) {
      const double place = 2.0 * i / (kSamples - 1) - 1;
      const double z = begins + steps * (place + 1) / 2;
      orders.row(i) << 1, place, 1.5 * place * place - 0.5;
      off(i) = std::round(z) - z;
      Sample sample;
      sample.time_s = 0.004 * i;
      sample.has_position = true;
      sample.position_mm = {500 * std::cos(place), 500 * std::sin(place), kStep_mm * std::round(z)};
      all->push_back(sample);
    }
    Sweep sweep;
    sweep.samples = all;
    const auto moments = moments_of(sweep, {0, 0, false, false, {kStep_mm, 0}});
    REQUIRE(moments);
    const auto shifts = moments->rounding.shifts(kStep_mm, 0);
    const Eigen::Vector3d found = orders.colPivHouseholderQr().solve(off);
    for (int order = 0; order < 3; ++order) {
      does(order) += found(order) * found(order);
      said(order) += shifts[static_cast<std::size_t>(order)](2) / (kStep_mm * kStep_mm);
    }
  }
  for (int order = 1; order < 3; ++order) {
    CAPTURE(least_steps, order, does(order), said(order));
    // The noise of the samples, which rounding is, too, has so much of its own.
    const double noise = kStrokes * (2.0 * order + 1) / 12 / kSamples;
    CHECK(said(order) + noise > 0.8 * does(order));
    CHECK(said(order) < 8 * does(order) + noise);
  }
  CHECK(said(0) > does(0));  // where an arc turns back, more is left
}

TEST_CASE("a target that shakes along its arc does not hide that its orientation is printed alike",
          "[stroke_rounding][issue12]") {
  // As a joint far away makes one that is close to the axis shake; the orientation does not.
  const double shakes = GENERATE(0.1, 0.4, 0.8);
  const auto level = shifts({1, 0, 0.37}, 500, 400, shakes)[0];
  CHECK(level(3) > 0.7);
  CHECK(level(4) > 0.7);
}

TEST_CASE("what is said of a swept angle is what rounding does to it along the stroke",
          "[stroke_rounding]") {
  constexpr int kStrokes = 40, kSamples = 600;
  // From sample to sample, in steps: what rounding does goes once along the stroke, where it gains
  // a whole step or half of one; stays where it is; and has no order.
  const double rate = GENERATE(600.0 / 599, 300.0 / 599, 1.0, 0.618034);
  test::Random random(7);
  Eigen::Array3d does = Eigen::Array3d::Zero(), said = does;  // variances by order, in steps
  for (int stroke = 0; stroke < kStrokes; ++stroke) {
    const double begins = random.uniform(0, 1);
    Eigen::MatrixX3d orders(kSamples, 3);
    Eigen::VectorXd off(kSamples);
    auto all = std::make_shared<std::vector<Sample>>();
    for (int i = 0; i < kSamples; ++i) {
      const double place = 2.0 * i / (kSamples - 1) - 1;
      orders.row(i) << 1, place, 1.5 * place * place - 0.5;
      const double steps = begins + rate * i, turn = steps * kStep_rad;
      off(i) = std::round(steps) - steps;
      Sample sample;
      sample.time_s = 0.004 * i;
      sample.has_position = true;
      sample.position_mm = {500 * std::cos(turn), 500 * std::sin(turn), 300};
      sample.joints = 1;
      sample.angles_rad[0] = std::round(steps) * kStep_rad;
      all->push_back(sample);
    }
    Sweep sweep;
    sweep.samples = all;
    const auto moments = moments_of(sweep, {0, 1, false, false, {0, kStep_rad}});
    REQUIRE(moments);
    const auto shifts = moments->rounding.told_shifts(kStep_rad);
    const Eigen::Vector3d found = orders.colPivHouseholderQr().solve(off);
    for (int order = 0; order < 3; ++order) {
      does(order) += found(order) * found(order) / kStrokes;
      said(order) += shifts[static_cast<std::size_t>(order)] / (kStep_rad * kStep_rad) / kStrokes;
    }
  }
  for (int order = 0; order < 3; ++order) {
    CAPTURE(rate, order, does(order), said(order));
    // The noise of the samples, which rounding is, too, has so much of its own.
    const double noise = (2.0 * order + 1) / 12 / kSamples;
    CHECK(said(order) + noise > 0.8 * does(order));
    // A level may be said that a whole wave does not have.
    if (order > 0) CHECK(said(order) < 2 * does(order) + noise);
  }
}

TEST_CASE("what is printed to the last digit is not shifted", "[stroke_rounding]") {
  StrokeRounding rounding;
  rounding.samples = 100;
  CHECK(rounding.shifts(0, 0)[0].isZero());
  CHECK(rounding.shifts(0.1, 0)[0].head<3>().minCoeff() > 0);
  CHECK(rounding.shifts(0.1, 0)[0].tail<3>().isZero());
  // Noise beyond the steps takes rounding's pattern away.
  rounding.extent.setConstant(1000);
  rounding.scatter.setConstant(1);
  CHECK(rounding.shifts(0.1, 0.1)[0].maxCoeff() < 2e-4 * 0.01 / 12);
}

TEST_CASE("The mean of a locked joint's printed angles is off by what is said of it",
          "[stroke_rounding]") {
  const double wobble = GENERATE(0.0, 0.01, 0.05, 0.15);  // in steps
  test::Random random(7);
  constexpr int kJoints = 2000, kReadings = 2000;
  double off2 = 0, said2 = 0;
  for (int joint = 0; joint < kJoints; ++joint) {
    const double stands = random.uniform(0, 1);
    double sum = 0, squares = 0;
    for (int i = 0; i < kReadings; ++i) {
      const double read = std::round(stands + random.normal(wobble));
      sum += read;
      squares += read * read;
    }
    const double mean = sum / kReadings;
    const double said = unseen_zero(mean, squares / kReadings - mean * mean);
    off2 += (mean - stands) * (mean - stands);
    said2 += said * said;
  }
  // 2,000 joints tell the ratio to 3 %. Where a joint hardly ever leaves its step, its wobble does
  // not show, and too much is said, not too little.
  CHECK(off2 / said2 < 1.1);
  CHECK(off2 / said2 > (wobble < 0.05 ? 0.9 : 0.25));
}

TEST_CASE("what even angles are all off by hangs on the places that they take within a step",
          "[stroke_rounding][issue12]") {
  // Of q places in turn, a saw tooth q times as fine is left. Uneven ways leave nothing.
  const auto [steps, places] =
      GENERATE(std::pair(24.0, 1), std::pair(1.5, 2), std::pair(2.0 / 3, 3), std::pair(0.8, 5),
               std::pair(1.1, 10), std::pair(0.7236, 0));
  // Positions that are printed with as many decimals show them no better.
  const double noise = GENERATE(0.0, 0.05);
  CAPTURE(steps, noise);
  test::Random random(11);
  const Eigen::ArrayXd times = 0.004 * Eigen::ArrayXd::LinSpaced(2000, 0, 1999);
  Eigen::ArrayXd seen = kStep_rad * (Eigen::ArrayXd::LinSpaced(2000, 0, 1999 * steps) + 0.37);
  const Eigen::ArrayXd told = kStep_rad * (seen / kStep_rad).round();
  for (double& angle : seen) angle += random.normal(noise * kStep_rad);
  const double sigma = std::hypot(0.02, noise) * kStep_rad;
  const double level = told_level_rad(times, told, seen, sigma, kStep_rad) / kStep_rad;
  CHECK(level == Approx(places > 0 ? kEvenlySpread / places : 0).epsilon(0.15).margin(0.005));
}

TEST_CASE("angles that go on by whole steps are off alike, though much of the way gets to speed",
          "[stroke_rounding][issue12]") {
  // 48 steps from one to the next, as two decimals have at 40 degrees/s and 12 ms. Half of the
  // samples are those of ramps.
  constexpr Eigen::Index kSamples = 72, kRamp = 18;
  Eigen::ArrayXd times(kSamples), seen(kSamples);
  double place = 0.37;
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    times(i) = 0.012 * static_cast<double>(i);
    seen(i) = kStep_rad * place;
    const Eigen::Index ends = std::min(i, kSamples - 2 - i);
    place += 48 * std::min(1.0, (static_cast<double>(ends) + 0.5) / kRamp);
  }
  const Eigen::ArrayXd told = kStep_rad * (seen / kStep_rad).round();
  const double off = std::abs((told - seen).segment(kRamp, kSamples - 2 * kRamp).mean());
  REQUIRE(off > 0.1 * kStep_rad);
  CHECK(told_level_rad(times, told, seen, 0.02 * kStep_rad, kStep_rad) >
        0.4 * kEvenlySpread * kStep_rad);
}
