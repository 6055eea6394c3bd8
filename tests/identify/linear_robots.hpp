#pragma once

// Arms with linear joints for tests: a SCARA (R R P R), a KR 5 arc on a linear unit
// (P R R R R R R), upright joints on a lift (P R R R), a gantry (P P P R). Their true tables are of
// the form that a result has, so that each number can be compared: a of a linear joint's row and b
// of the next as specified, b zero and beta present where axes are parallel.

#include <cmath>
#include <cstdint>
#include <random>

#include <Eigen/Geometry>

#include "tests/identify/simulated_campaign.hpp"

namespace identify::test {

inline Arm scara() {
  Arm arm;
  arm.rows = {{0, 20 * kDegree, 250, 0},
              {0, 60 * kDegree, 300, 0},
              {-120, 15 * kDegree, 0, 0},
              {0, 0, 0, 0}};
  arm.home_rad = {20 * kDegree, 60 * kDegree, 100 * kDegree, -30 * kDegree};
  arm.positive = {1, 1, -1, 1};
  arm.linear = {false, false, true, false};
  arm.tool_mm = {150, 60, 0};  // level with the frame behind the last row
  return arm;
}

inline Arm on_linear_unit() {
  const Arm above = kr5_arc();
  Arm arm;
  arm.rows = {{700, 80 * kDegree, 30, -90 * kDegree}};
  arm.home_rad = {600 * kDegree};
  arm.positive = {1};
  arm.linear = {true};
  for (std::size_t j = 0; j < above.joints(); ++j) {
    arm.rows.push_back(above.rows[j]);
    arm.home_rad.push_back(above.home_rad[j]);
    arm.positive.push_back(above.positive[j]);
    arm.linear.push_back(false);
  }
  arm.tool_mm = above.tool_mm;
  return arm;
}

inline Arm on_lift() {
  Arm arm;
  arm.rows = {{900, 0, 0, 0}, {0, 30 * kDegree, 350, 0}, {0, -35 * kDegree, 300, 0}, {0, 0, 0, 0}};
  arm.home_rad = {900 * kDegree, 30 * kDegree, -35 * kDegree, 0};
  arm.positive = {1, 1, 1, 1};
  arm.linear = {true, false, false, false};
  arm.tool_mm = {120, 40, 0};
  return arm;
}

/// A cylindrical robot: it turns, lifts along that axis, reaches out, and has a wrist (R P P R R
/// R).
inline Arm cylindrical() {
  Arm arm;
  arm.rows = {
      {300, 10 * kDegree, 0, 0},          {300, 0, 0, -90 * kDegree},          {500, 0, 0, 0},
      {0, 20 * kDegree, 0, 90 * kDegree}, {0, 50 * kDegree, 0, -90 * kDegree}, {0, 0, 0, 0}};
  arm.home_rad = {10 * kDegree, 300 * kDegree, 500 * kDegree, 20 * kDegree, 50 * kDegree, 0};
  arm.positive = {1, 1, 1, 1, 1, 1};
  arm.linear = {false, true, true, false, false, false};
  arm.tool_mm = {120, 50, 80};
  return arm;
}

/// Three linear joints, the last upright, and a joint that turns about that.
inline Arm gantry() {
  Arm arm;
  arm.rows = {{1000, 0, 0, -90 * kDegree},
              {800, -90 * kDegree, 0, -90 * kDegree},
              {300, 0, 0, 0},
              {0, 30 * kDegree, 0, 0}};
  arm.home_rad = {1000 * kDegree, 800 * kDegree, 300 * kDegree, 30 * kDegree};
  arm.positive = {1, 1, 1, 1};
  arm.linear = {true, true, true, false};
  arm.tool_mm = {120, 40, 0};
  return arm;
}

/// As built: what a result can tell is off by tenths of a millimetre and hundredths of a degree.
inline Arm as_built(Arm arm, std::uint32_t seed) {
  std::mt19937 random(1000 + seed);
  std::normal_distribution<> normal;
  for (std::size_t i = 0; i + 1 < arm.rows.size(); ++i) {
    DhRow& row = arm.rows[i];
    const bool linear = arm.is_linear(i);
    const bool placed = i > 0 && arm.is_linear(i - 1);
    const bool parallel = std::abs(std::sin(row.alpha_rad)) < 0.1;
    if (!linear) row.a_mm += 0.3 * normal(random);
    if (!placed && !parallel) row.b_mm += 0.3 * normal(random);
    if (!(linear && parallel)) row.theta_rad += 0.02 * kDegree * normal(random);
    row.alpha_rad += 0.02 * kDegree * normal(random);
    if (parallel) row.beta_rad += 0.02 * kDegree * normal(random);
  }
  return arm;
}

inline identify::Campaign for_arm(const Arm& arm) {
  identify::Campaign campaign;
  campaign.joints = arm.joints();
  campaign.specified = arm;
  return campaign;
}

/// Sweeps of the SCARA; of its linear joint, from the first to the second, mm.
inline std::vector<Sweep> scara_sweeps(const Arm& arm, Noise noise, double from_mm = 20,
                                       double to_mm = 180) {
  Campaign campaign(arm, noise);
  campaign.rest().sweep(0, -25, 65).sweep(1, 15, 105).sweep(2, from_mm, to_mm).sweep(3, -75, 15);
  return segment(campaign.samples(), {}, arm.joints());
}

/// The same there and back.
inline std::vector<Sweep> scara_sweeps_both_ways(const Arm& arm, Noise noise) {
  Campaign campaign(arm, noise);
  campaign.rest()
      .sweep(0, -25, 65)
      .sweep(0, 65, -25)
      .sweep(1, 15, 105)
      .sweep(1, 105, 15)
      .sweep(2, 20, 180)
      .sweep(2, 180, 20)
      .sweep(3, -75, 15)
      .sweep(3, 15, -75);
  return segment(campaign.samples(), {}, arm.joints());
}

inline std::vector<Sweep> cylindrical_sweeps(const Arm& arm, Noise noise) {
  Campaign campaign(arm, noise);
  campaign.rest()
      .sweep(0, -35, 55)
      .sweep(1, 100, 500)
      .sweep(2, 300, 700)
      .sweep(3, -25, 65)
      .sweep(4, 5, 95)
      .sweep(5, -45, 45);
  return segment(campaign.samples(), {}, arm.joints());
}

/// Of each joint, home in the middle: 90 degrees, or 500 mm.
inline std::vector<Sweep> sweeps_about_home(const Arm& arm, Noise noise) {
  Campaign campaign(arm, noise);
  campaign.rest();
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    const double home = arm.home_rad[j] / kDegree, half = arm.is_linear(j) ? 250 : 45;
    campaign.sweep(j, home - half, home + half);
  }
  return segment(campaign.samples(), {}, arm.joints());
}

/// The paper's ranges, and one of the linear unit.
inline std::vector<Sweep> linear_unit_sweeps(const Arm& arm, Noise noise) {
  Campaign campaign(arm, noise);
  campaign.rest()
      .move(0, 100, 400)
      .rest()
      .move(0, 1100, 200)
      .rest()
      .move(0, 600, 400)
      .rest()
      .sweep(1, 45, 135)
      .sweep(2, -60, -130)
      .sweep(3, 120, 30)
      .sweep(4, 90, -40)
      .sweep(5, 90, 10)
      .sweep(6, -40, 90);
  return segment(campaign.samples(), {}, arm.joints());
}

}  // namespace identify::test
