#include "daemon/results/change.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/text/units.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

std::string described_by(const ToldArm& told) {
  return told.describes == "arm" ? "the arm, as a device measured it" : "the controller's model";
}

void refuse_other_kinds(const ToldArm& first, const ToldArm& second) {
  const auto each = [&](const auto& what) {
    return first.file.string() + " has " + what(first) + ", " + second.file.string() + " has " +
           what(second);
  };
  if (first.describes != second.describes)
    throw std::runtime_error(each(described_by) +
                             ": they differ by how the arm was built; compare two of a kind");
  if (first.all_joints != second.all_joints)
    throw std::runtime_error(
        each([](const ToldArm& told) { return rsi::counted(told.all_joints, "joint", "joints"); }) +
        ": compare two results of one robot");
  if (first.reach.linear != second.reach.linear)
    throw std::runtime_error("the linear joints of " + first.file.string() + " and " +
                             second.file.string() +
                             " are others: compare two results of one robot");
}

std::vector<std::string> notes_on(const Change& change) {
  std::vector<std::string> notes;
  const auto add_status = [&](const char* letter, const ToldArm& told) {
    auto note = told_status(letter, told.status, told.reason);
    if (!note.empty()) notes.push_back(std::move(note));
  };
  add_status("A", change.first);
  add_status("B", change.second);
  if (!change.first.whole())
    notes.push_back(fmt::format(
        "The data leave axis {} open in one of the two. Only joints 1 to {} are compared, and what "
        "moved is the frame of joint {}.",
        change.first.joints() + 1, change.first.joints(), change.first.joints()));
  if (change.first.robot != change.second.robot)
    notes.push_back("A is of the robot " + change.first.robot + ", B of " + change.second.robot +
                    '.');
  if (change.arms.difference.isZero(0))
    notes.push_back("A and B are the same result. That nothing differs says nothing.");
  if (change.first.describes != "arm")
    notes.push_back(
        "Both are the controller's model. What happened to the arm itself does not show in it.");
  if (change.arms.height_mm)
    notes.push_back(fmt::format(
        "Nothing tells where along its first axes the arm stands. A and B agree best where B's "
        "base is {:.0f} mm {} than its frame has it. What that can take up is in U.",
        std::abs(*change.arms.height_mm), *change.arms.height_mm < 0 ? "lower" : "higher"));
  if (change.arms.height_open_mm > 0)
    notes.push_back(fmt::format(
        "The description alone tells where along its parallel first axes the arm stands. What "
        "{:.0f} mm of that would change is in U. Points in the robot's own frame (`sweepd identify "
        "--frame robot`) tell it, and make U smaller.",
        change.arms.height_open_mm));
  if (!change.arms.other_homes.empty()) {
    std::string joints;
    for (const std::size_t j : change.arms.other_homes)
      joints += (joints.empty() ? "" : ", ") + std::to_string(j + 1);
    notes.push_back("The homes are apart in joint " + joints +
                    ". What gears are off by is in U of these zeros.");
  }
  return notes;
}

/// To the joints that both tell.
void cut_alike(ToldArm& first, ToldArm& second) {
  const std::size_t both = std::min(first.joints(), second.joints());
  first.cut(both);
  second.cut(both);
}

}  // namespace

identify::ComparedArms compared(ToldArm first, ToldArm second) {
  cut_alike(first, second);
  identify::ComparedArms arms = identify::compared(first.arm, second.arm);
  const Eigen::VectorXd bend = second_order(arms, first.reach);
  arms.second_covariance += bend * bend.transpose();
  return arms;
}

Change change_between(ToldArm first, ToldArm second, double level) {
  cut_alike(first, second);
  refuse_other_kinds(first, second);
  Change change{std::move(first), std::move(second), level, {}, {}, {}, {}, {}};
  change.arms = compared(change.first, change.second);
  if (change.arms.numbers.empty())
    throw std::runtime_error(change.first.file.string() + " and " + change.second.file.string() +
                             " have no number in common that data determine: identify both again "
                             "with sweeps of every joint");
  change.test = test_change(change.arms.difference, change.arms.covariance(), level);
  const auto displacement = [&](const Eigen::VectorXd& by, const Eigen::MatrixXd& covariance) {
    return largest_displacement(change.arms, by, covariance, change.first.reach, kComparedPoses);
  };
  change.displacement = displacement(change.arms.difference, change.arms.covariance());
  if (!change.test.changes.isZero(0))
    change.changes_displacement = displacement(change.test.changes, change.test.changes_covariance);
  change.notes = notes_on(change);
  return change;
}

std::string name_of(const identify::ArmNumber& number) {
  return std::string(identify::text(number.kind)) + std::to_string(number.joint + 1);
}

std::string name_with_unit(const identify::ArmNumber& number) {
  return name_of(number) + '_' + unit_of(number);
}

double in_unit(const identify::ArmNumber& number, double value) {
  return number.length ? value : degrees(value);
}

std::string unit_of(const identify::ArmNumber& number) {
  return number.length ? "mm" : "deg";
}

}  // namespace sweepd
