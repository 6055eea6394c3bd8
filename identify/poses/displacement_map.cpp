#include "identify/poses/displacement_map.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/line.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/observability.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kStepsAcross = 11;
constexpr double kRound_mm = 25;

struct Reached {
  Vector3d at_mm;
  Pose pose;  ///< its position: where the identified arm has it
};

/// How the specified arm's target moves with base (shift, turn in mm at a metre) and tool.
using ByFrames = Eigen::Matrix<double, 3, 9>;

/// The last whole number of steps from zero up to `at_mm`, and the first from there on.
int steps_below(double at_mm, double step_mm) {
  return static_cast<int>(std::floor(at_mm / step_mm));
}
int steps_above(double at_mm, double step_mm) {
  return static_cast<int>(std::ceil(at_mm / step_mm));
}

class Map {
 public:
  Map(const PoseFit& identified, const PlacedArm& specified, const JointRanges& ranges)
      : identified_(identified), specified_(specified), reach_(in_base(specified), ranges) {}

  DisplacementMap drawn() {
    DisplacementMap map;
    const auto box = reach_.box();
    const Vector3d &low = box[0], &high = box[1];
    map.step_mm = kRound_mm * std::ceil((high - low).maxCoeff() / kStepsAcross / kRound_mm);
    std::vector<Reached> grid;
    const auto from = [&](Index k) { return steps_below(low(k), map.step_mm); };
    const auto to = [&](Index k) { return steps_above(high(k), map.step_mm); };
    for (int x = from(0); x <= to(0); ++x)
      for (int y = from(1); y <= to(1); ++y)
        for (int z = from(2); z <= to(2); ++z) reach(map.step_mm * Vector3d(x, y, z), grid);
    if (grid.empty()) return map;
    fit_frames(grid);
    for (const Reached& one : grid) map.grid.push_back(displaced(one));
    const Arm arm = in_base(specified_);
    const Vector3d home = forward_kinematics(arm, arm.home_rad) * arm.tool_mm;
    for (std::size_t across = 0; across < 3; ++across)
      map.slices[across] = slice(across, home, low, high, map.step_mm / 2);
    return map;
  }

 private:
  static Arm in_base(const PlacedArm& placed) {
    Arm arm = placed.arm;
    arm.tool_mm = placed.targets_mm.front();
    return arm;
  }

  void reach(const Vector3d& at_mm, std::vector<Reached>& into) const {
    const auto angles = reach_.angles_at(at_mm);
    if (!angles) return;
    Reached one{at_mm, {}};
    std::copy(angles->begin(), angles->end(), one.pose.sample.angles_rad.begin());
    one.pose.sample.joints = static_cast<std::uint8_t>(angles->size());
    one.pose.sample.has_position = true;
    one.pose.sample.position_mm = identified_.model.position_mm(one.pose);
    into.push_back(one);
  }

  [[nodiscard]] DisplacementSlice slice(std::size_t across, const Vector3d& through,
                                        const Vector3d& low, const Vector3d& high, double step) {
    const auto axis = static_cast<Index>(across);
    const Index u = across == 0 ? 1 : 0, v = across == 2 ? 1 : 2;
    DisplacementSlice slice{across, std::round(through(axis)), {}};
    std::vector<Reached> points;
    for (int a = steps_below(low(u), step); a <= steps_above(high(u), step); ++a)
      for (int b = steps_below(low(v), step); b <= steps_above(high(v), step); ++b) {
        Vector3d at;
        at(axis) = slice.at_mm;
        at(u) = step * a;
        at(v) = step * b;
        reach(at, points);
      }
    for (const Reached& one : points) slice.points.push_back(displaced(one));
    return slice;
  }

  [[nodiscard]] ByFrames by_frames(const Pose& pose) const {
    Eigen::Isometry3d frame = specified_.base;
    for (std::size_t j = 0; j < specified_.arm.joints(); ++j)
      frame = frame * transform(specified_.arm.row_at(j, pose.sample.angles_rad[j]));
    ByFrames columns;
    columns << Eigen::Matrix3d::Identity(),
        -cross_matrix(frame * specified_.targets_mm.front() - specified_.base.translation()) /
            kMetre_mm,
        frame.linear();
    return columns;
  }

  [[nodiscard]] MatrixXd by_parameters(const Pose& pose) const {
    return pose_row(identified_.model, pose, false).by_parameter;
  }

  void fit_frames(const std::vector<Reached>& grid) {
    std::vector<Pose> poses;
    poses.reserve(grid.size());
    for (const Reached& one : grid) poses.push_back(one.pose);
    specified_ = fitted(specified_, Freedom::frames, poses,
                        Eigen::VectorXd::Ones(static_cast<Index>(poses.size())));
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    MatrixXd mixed = MatrixXd::Zero(9, identified_.covariance.rows());
    for (const Pose& pose : poses) {
      const ByFrames frames = by_frames(pose);
      normal += frames.transpose() * frames;
      mixed += frames.transpose() * by_parameters(pose);
    }
    taken_up_ = least_norm(normal, mixed);
  }

  [[nodiscard]] DisplacedPoint displaced(const Reached& one) const {
    const Vector3d by = one.pose.sample.position_mm - specified_.position_mm(0, one.pose.sample);
    const MatrixXd left = by_parameters(one.pose) - by_frames(one.pose) * taken_up_;
    const Eigen::VectorXd along = left.transpose() * by.stableNormalized();
    return {
        one.at_mm, specified_.base.linear().transpose() * by,
        kSigmasOf95Percent * std::sqrt(std::max(0.0, along.dot(identified_.covariance * along)))};
  }

  const PoseFit& identified_;
  PlacedArm specified_;
  ArmReach reach_;
  MatrixXd taken_up_;  // of the identified parameters by base and tool
};

}  // namespace

DisplacementMap displacement_map(const PoseFit& identified, const PlacedArm& specified,
                                 const JointRanges& ranges) {
  return Map(identified, specified, ranges).drawn();
}

}  // namespace identify
