#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/results/change_test.hpp"
#include "daemon/results/told_arm.hpp"
#include "identify/change/compared_arms.hpp"
#include "identify/change/displacement.hpp"

namespace sweepd {

/// Two results side by side, and whether the second arm is another than the first.
struct Change {
  ToldArm first;
  ToldArm second;
  double level = 0;
  identify::ComparedArms arms;
  ChangeTest test;
  identify::Displacement displacement;  ///< by all differences, noise included
  /// By the numbers that have changed, where the others have not.
  std::optional<identify::Displacement> changes_displacement;
  std::vector<std::string> notes;  ///< sentences on what weakens the comparison
};

/// How many poses the displacement is looked for at.
inline constexpr std::size_t kComparedPoses = 2000;

/// The numbers of joints that both arms tell. What their difference may be beyond first order is in
/// the second covariance.
[[nodiscard]] identify::ComparedArms compared(ToldArm first, ToldArm second);

/// Throws std::runtime_error where the two are not of a kind: a controller's model and an arm, or
/// arms with other joints.
[[nodiscard]] Change change_between(ToldArm first, ToldArm second, double level);

/// As in "zero4", and with its unit "zero4_deg".
[[nodiscard]] std::string name_of(const identify::ArmNumber& number);
[[nodiscard]] std::string name_with_unit(const identify::ArmNumber& number);
/// A number in its unit, mm or degrees; and "mm" or "deg".
[[nodiscard]] double in_unit(const identify::ArmNumber& number, double value);
[[nodiscard]] std::string unit_of(const identify::ArmNumber& number);

/// What `sweepd compare` says to a person; the first sentence is the verdict.
[[nodiscard]] std::string change_text(const Change& change);

/// Schema sweepd.compare/1, as docs/compare.schema.json has it.
[[nodiscard]] std::string change_json(const Change& change);

}  // namespace sweepd
