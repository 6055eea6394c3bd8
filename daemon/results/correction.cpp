#include "daemon/results/correction.hpp"

#include <spdlog/fmt/fmt.h>

#include "daemon/krl/krl_position.hpp"
#include "identify/correction/combined_poses.hpp"
#include "identify/geometry/line.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using identify::ControllerLevel;
using identify::ControllerNumber;
using identify::Pose;

/// Nearer to 90 degrees, A and C of a frame are not to be compared one by one.
constexpr double kGimbal_deg = 1;
constexpr double kFarTool_mm = 50;

ControllerLevel controller_level(CorrectionLevel level) {
  switch (level) {
    case CorrectionLevel::mastering:
      return ControllerLevel::mastering;
    case CorrectionLevel::machine_data:
      return ControllerLevel::machine_data;
    case CorrectionLevel::frames:
    case CorrectionLevel::targets:
      return ControllerLevel::frames;
  }
  return ControllerLevel::frames;
}

/// Of the poses that count, the distances between two of: seen, by the controller, identified.
template <typename First, typename Second>
identify::Left between(const Correctable& of, const First& first, const Second& second) {
  std::vector<double> off;
  for (std::size_t i = 0; i < of.poses.size(); ++i)
    if (of.weights(static_cast<Index>(i)) > 0)
      off.push_back((first(of.poses[i]) - second(of.poses[i])).norm());
  return identify::left_of(
      Eigen::Map<const Eigen::VectorXd>(off.data(), static_cast<Index>(off.size())));
}

Vector3d seen(const Pose& pose) {
  return pose.sample.position_mm;
}

identify::Left left_by(const identify::PlacedArm& arm, const Correctable& of) {
  return between(of, seen,
                 [&](const Pose& pose) { return arm.position_mm(pose.target, pose.sample); });
}

/// What the controller's numbers are fitted to: the identified arm. Where its axes are not all
/// known, the poses themselves.
struct Basis {
  std::vector<Pose> poses;
  Eigen::VectorXd weights;
  identify::ModelUncertainty identified;
};

Basis basis_of(const Correctable& of) {
  if (!of.open.empty()) return {of.poses, of.weights, {}};
  const identify::PoseFit& fit = of.identified.fit;
  auto poses = combined_poses(fit.model, of.poses, of.weights);
  auto rows = by_parameter(fit.model, poses);
  const auto count = static_cast<Index>(poses.size());
  return {std::move(poses),
          Eigen::VectorXd::Constant(count, of.weights.sum() / static_cast<double>(count)),
          {std::move(rows), fit.covariance}};
}

void warn_of_program(const Correction& correction, std::vector<std::string>& warnings) {
  const auto& points = correction.program->points;
  std::string outside, far, turned;
  for (const CorrectedPoint& point : points) {
    const auto add = [&](std::string& names) { names += (names.empty() ? "" : ", ") + point.name; };
    if (point.outside) add(outside);
    if (point.from_target_mm > kFarTool_mm) add(far);
    if (point.turn_bits) add(turned);
  }
  if (!outside.empty())
    warnings.push_back("Joints stand beyond what the poses covered at " + outside +
                       ": there the correction is extrapolated.");
  if (!far.empty())
    warnings.push_back(
        fmt::format("The tool is more than {:.0f} mm from the measured target at {}. Check --tool "
                    "and --flange. If they are right: what is expected to be left there leaves "
                    "out that the tool's turn about the last axis is not known.",
                    kFarTool_mm, far));
  if (!turned.empty())
    warnings.push_back("T has changed at " + turned +
                       ", since a joint passes zero there. T is the sign of the angle.");
  warnings.emplace_back(
      "Run the program in T1 first, with the points one by one. Points that the program computes, "
      "and those of other files, are not corrected.");
  warnings.emplace_back(
      "Correct the targets or the controller, not both: after a change of mastering or machine "
      "data measure again and correct the original program anew.");
}

}  // namespace

const char* text(CorrectionLevel level) noexcept {
  switch (level) {
    case CorrectionLevel::mastering:
      return "mastering";
    case CorrectionLevel::frames:
      return "frames";
    case CorrectionLevel::machine_data:
      return "machine-data";
    case CorrectionLevel::targets:
      return "targets";
  }
  return "";
}

Correction correction_of(const Correctable& of, CorrectionLevel level) {
  Correction correction;
  correction.level = level;
  correction.robot = of.robot;
  correction.targets = of.identified.targets;
  for (std::size_t t = 0; t < correction.targets.size(); ++t)  // one target needs no name
    if (correction.targets[t].empty()) correction.targets[t] = std::to_string(t + 1);
  correction.poses = static_cast<std::size_t>(of.weights.sum());
  correction.specified = of.controller().arm;
  const auto basis = basis_of(of);
  const auto fitted = [&](ControllerLevel of_controller) {
    return fitted_controller(of.controller(), of_controller, basis.poses, basis.weights,
                             basis.identified);
  };
  correction.fit = fitted(controller_level(level));
  correction.left = left_by(correction.fit.arm, of);
  correction.frames = correction.fit.numbers.empty()
                          ? correction.left
                          : left_by(fitted(ControllerLevel::frames).arm, of);
  const auto identified = [&](const Pose& pose) { return of.identified.position_mm(pose); };
  correction.identified = between(of, seen, identified);
  correction.unheld = between(of, identified, [&](const Pose& pose) {
    return correction.fit.arm.position_mm(pose.target, pose.sample);
  });
  return correction;
}

Isometry3d Correction::base_frame() const {
  return fit.arm.base.inverse();
}

Isometry3d Correction::tool_frame(std::size_t target) const {
  Isometry3d frame = Isometry3d::Identity();
  frame.linear() = tool;
  frame.translation() = flange.inverse() * fit.arm.targets_mm[target];
  return frame;
}

Eigen::Matrix<double, 6, 1> Correction::base_sigma() const {
  const Matrix3d back = fit.arm.base.linear().transpose();
  MatrixXd by = MatrixXd::Zero(6, 6);
  by.topLeftCorner<3, 3>() = -back;
  by.topRightCorner<3, 3>() = -back * identify::cross_matrix(fit.arm.base.translation());
  by.bottomRightCorner<3, 3>() = -back;
  const MatrixXd covariance = by * fit.frames_covariance.topLeftCorner<6, 6>() * by.transpose();
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

Vector3d Correction::tool_sigma_mm(std::size_t target) const {
  const auto at = static_cast<Index>(6 + 3 * target);
  const Matrix3d to_flange = flange.linear().transpose();
  const Matrix3d covariance =
      to_flange * fit.frames_covariance.block<3, 3>(at, at) * to_flange.transpose();
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

double Correction::offset(const ControllerNumber& zero) const {
  return specified.positive[zero.joint] * zero.change;
}

std::vector<std::string> Correction::warnings() const {
  std::vector<std::string> all;
  if (level == CorrectionLevel::targets && program) warn_of_program(*this, all);
  if (level == CorrectionLevel::mastering)
    all.emplace_back(
        "Afterwards all taught points, and bases and tools that this robot measured, are a little "
        "elsewhere. Save an archive first, and check them in T1.");
  if (level == CorrectionLevel::frames) {
    all.emplace_back(
        "A, B and C of the tool are those that were given (none: 0): points do not tell how a tool "
        "is turned.");
    if (from_gimbal_deg(base_frame().linear()) < kGimbal_deg)
      all.emplace_back(
          "B of the base is near 90 deg, where A and C cannot be told apart: compare rotations, "
          "and not the three angles.");
  }
  if (level != CorrectionLevel::machine_data) return all;
  all.emplace_back(
      "This is a proposal. Only KUKA's service may change machine data: with wrong ones the robot "
      "moves elsewhere than it shows, and its safety functions watch another robot.");
  all.emplace_back("Save an archive first.");
  all.emplace_back("Master first (--level mastering), measure again, and only then think of this.");
  all.emplace_back("All taught points, bases and tools are invalid afterwards.");
  all.emplace_back(
      "An absolutely accurate robot has a model of its own in the controller, which takes such "
      "lengths into account already: leave its machine data.");
  return all;
}

std::string name_of(const ControllerNumber& number, const identify::Arm& arm) {
  using Kind = ControllerNumber::Kind;
  std::string joint = std::to_string(number.joint + 1);
  switch (number.kind) {
    case Kind::zero:
      return (arm.is_linear(number.joint) ? "b" : "theta") + joint;
    case Kind::b:
      return "b" + joint;
    case Kind::a:
      return "a" + joint;
    case Kind::alpha:
      return "alpha" + joint;
  }
  return joint;
}

}  // namespace sweepd
