#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh.hpp"

namespace simulation {

/// What a joint carries: a point mass, in the frame behind the joint's row.
struct Link {
  double mass_kg = 0;
  Eigen::Vector3d center_mm = Eigen::Vector3d::Zero();
};

/// An arm as it is, beside what its maker specifies; both with their thetas at the same home. The
/// base's Z points up.
struct Robot {
  identify::Arm specified;
  identify::Arm arm;                        ///< the truth
  std::vector<Eigen::Vector3d> targets_mm;  ///< in the frame behind the last row
  std::vector<Link> links;                  ///< one a joint; empty: weightless
  std::vector<std::size_t> elastic;         ///< the joints that bend under load, counted from 0
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< in the base: how the robot is mounted
};

/// KR 5 arc, by the paper's table at the paper's home. One target or three. The masses are guesses.
[[nodiscard]] Robot kr5(std::size_t targets = 1);
/// Seven axes, each meeting the next at a right angle, of the sizes of an LBR iiwa 14, slightly
/// bent.
[[nodiscard]] Robot iiwa(std::size_t targets = 1);
/// Four axes: an upright one, two that are level and parallel, and an upright flange. It has no
/// weights.
[[nodiscard]] Robot palletizer();
/// A KR 5 arc that stands on a linear unit, its first joint.
[[nodiscard]] Robot kr5_on_rail();

/// As arms are built: every length off by 0.5 mm, every angle by 0.05 degrees, sigma; and with
/// weights that no drawing shows: half more or less, 80 mm off in each direction.
[[nodiscard]] Robot built(Robot robot, std::uint32_t seed);

/// The same robot with another home, one angle a joint.
[[nodiscard]] Robot at_home(Robot robot, const std::vector<double>& home_rad);
/// At a home that is no round number: up to 35 degrees off in each joint. Every target stays at
/// least 80 mm away from every axis, and no joint's axis comes to lie on that of the next but one.
[[nodiscard]] Robot at_random_home(const Robot& robot, std::uint32_t seed);

/// Whether it is so with this chain at its home.
[[nodiscard]] bool fit_for_sweeps(const identify::Chain& chain);

/// The true arm at home, along positive rotation, in the base, with the robot's targets.
[[nodiscard]] identify::Chain chain_of(const Robot& robot);

}  // namespace simulation
