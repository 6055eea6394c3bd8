#include "identify/circle/circle_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "identify/circle/circle_target.hpp"
#include "identify/circle/joint_motion.hpp"
#include "identify/dh/axis_senses.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/home.hpp"
#include "identify/sweeps/joint_assignment.hpp"
#include "identify/sweeps/linear_joint.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// One identification under way.
class Circles {
 public:
  Circles(std::vector<Sweep> sweeps, const Campaign& campaign)
      : campaign_(campaign), sweeps_(std::move(sweeps)) {
    result_.joints.resize(campaign.joints);
  }

  CircleEstimate run() {
    assign();
    result_.home_rad = find_home(sweeps_, campaign_.joints, campaign_.resolution);
    mark_positioning(sweeps_, result_.home_rad, campaign_.resolution);
    const bool told = std::any_of(sweeps_.begin(), sweeps_.end(),
                                  [](const Sweep& sweep) { return sweep.first().joints > 0; });
    if (!told && home_declared_ && campaign_.declared_home_rad.size() == campaign_.joints)
      result_.home_rad.assign(campaign_.declared_home_rad.begin(),
                              campaign_.declared_home_rad.end());
    for (std::size_t j = 0; j < campaign_.joints; ++j) fit(j);
    set_circle_axes(result_, campaign_.resolution);
    extract();
    measure_boxes(result_);
    return std::move(result_);
  }

 private:
  void warn(std::string_view code, std::optional<std::size_t> joint, std::string message) {
    result_.warnings.push_back({std::string(code), joint, std::move(message)});
  }

  void assign() {
    const auto without_joint = [](const Sweep& sweep) { return !sweep.joint; };
    if (std::any_of(sweeps_.begin(), sweeps_.end(), without_joint)) {
      JointAssignment assigned = assign_joints(sweeps_, campaign_);
      senses_found_ = assigned.senses_known;
      directions_assigned_ = true;
      home_declared_ = assigned.home_holds;
      result_.doubt = std::move(assigned.doubt);
      for (const std::size_t j : assigned.against_plan) result_.joints[j].against_plan = true;
      result_.warnings = std::move(assigned.warnings);
    }
    std::erase_if(sweeps_, [&](const Sweep& sweep) {
      return sweep.joint && *sweep.joint >= campaign_.joints;
    });
    result_.any_sweep = !sweeps_.empty();
  }

  void fit(std::size_t j) {
    JointResult& joint = result_.joints[j];
    joint.linear = campaign_.specified && campaign_.specified->is_linear(j);
    SweepDefect worst = SweepDefect::none;
    for (const Sweep& given : sweeps_) {
      if (given.joint != j) continue;
      const Sweep sweep = judged_as_line(given, joint.linear);
      if (sweep.defect != SweepDefect::none)
        worst = sweep.defect;
      else
        joint.sweeps.push_back(sweep);
    }
    choose_sweeps(joint);
    if (std::find(joint.used.begin(), joint.used.end(), true) == joint.used.end()) {
      if (joint.off_home_rad)
        warn("off_home", j,
             joint_name(j) +
                 ": the other joints stood elsewhere than in the other "
                 "sweeps: lock them at one common home pose");
      else if (auto mistake = mistold_of(j))
        result_.warnings.push_back(*std::move(mistake));
      else if (worst != SweepDefect::none)
        warn(code(worst), j, joint_name(j) + ": " + std::string(remedy(worst, joint.linear)));
      else
        warn("joint_never_moved", j,
             !directions_assigned_
                 ? joint_name(j) + " was never swept alone: sweep it while all others rest"
             : !joint.linear ? "no sweep was told to be of " + joint_name(j)
                             : joint_name(j) +
                                   " moves along a line, which is not looked for without angles: "
                                   "send joint angles (AIPos), or name the joint of each point");
      return;
    }
    if (joint.off_home_rad)
      warn(
          "off_home", j,
          joint_name(j) + ": in all of its sweeps other joints stood off the common home, by " +
              fixed(*joint.off_home_rad / kDegree, 3) +
              "° or more. The chain allows for that, and the circles do not: lock the other joints "
              "at one home pose");
    joint.circle_target = circle_target(joint);
    const Matrix3Xd points = used_points(joint, joint.circle_target);
    if (points.cols() == 0) {
      result_.no_positions = true;
      return;
    }
    if (fit_as_line(j, points)) return;
    const auto usual = fit_usual_circle(points);
    if (!usual)
      return warn("not_an_arc", j,
                  joint_name(j) + ": " + std::string(remedy(SweepDefect::not_an_arc, false)));
    joint.circle = usual->circle;
    const CircleFit& circle = *joint.circle;
    const auto along = [&](const Vector3d& from, const Vector3d& way) -> double {
      return circle.normal.dot((from - circle.center_mm).cross(way));
    };
    const bool against = orient(j, along, [&](const Vector3d& point) {
      const CircleResidual off = residual(circle, point);
      return std::hypot(off.plane_mm, off.radial_mm) > usual->within_mm;
    });
    if (against) joint.circle->normal = -joint.circle->normal;
  }

  /// Uses those at home. Where there are none, those that are nearest, if that is close: the angles
  /// tell how close.
  void choose_sweeps(JointResult& joint) {
    std::vector<double> off;
    double least = std::numeric_limits<double>::infinity();
    bool any_home = false;
    for (const Sweep& sweep : joint.sweeps) {
      const bool home = at_home(sweep, result_.home_rad, campaign_.resolution);
      off.push_back(home ? 0 : off_home_rad(sweep, result_.home_rad));
      joint.used.push_back(home && !sweep.positioning);
      any_home = any_home || joint.used.back();
      if (!sweep.positioning) least = std::min(least, off.back());
    }
    if (any_home || !std::isfinite(least)) return;
    joint.off_home_rad = least;
    if (least > kSameHome_rad) return;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      joint.used[s] = off[s] == least && !joint.sweeps[s].positioning;
  }

  /// Of a linear joint. Without a line there is none, or it is described so and turns.
  bool fit_as_line(std::size_t j, const Matrix3Xd& points) {
    JointResult& joint = result_.joints[j];
    LinearVerdict verdict = linear_verdict(
        points, used_sweeps(joint), j,
        campaign_.specified ? std::optional(campaign_.specified->is_linear(j)) : std::nullopt);
    if (!verdict.contradiction.empty())
      result_.doubts.push_back({"joint_type_contradicted", j, std::move(verdict.contradiction)});
    joint.linear = verdict.line.has_value();
    if (!joint.linear) return false;
    joint.line = std::move(verdict.line);
    Vector3d& along = joint.line->direction;
    const auto go = [&](const Vector3d&, const Vector3d& way) { return along.dot(way); };
    if (orient(j, go, [](const Vector3d&) { return false; })) along = -along;
    return true;
  }

  /// Whether the fit points against the joint's positive rotation (or way), by how far each step
  /// goes along it: pooled strokes run both ways, and so may one. Where angles are told, what was
  /// swept as they rose counts against what was as they fell; where not, a stroke's direction.
  template <class Along, class Stray>
  bool orient(std::size_t j, const Along& along, const Stray& is_stray) {
    JointResult& joint = result_.joints[j];
    double by_angles = 0, by_direction = 0, by_motion = 0;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      if (!joint.used[s] || sweep.target != joint.circle_target) continue;
      const Sample* before = nullptr;
      for (const Sample& sample : *sweep.samples) {
        if (!sample.has_position || is_stray(sample.position_mm)) continue;
        if (before != nullptr) {
          const double swept = along(before->position_mm, sample.position_mm - before->position_mm);
          if (sample.joints > j && before->joints > j)
            by_angles += (sample.angles_rad[j] - before->angles_rad[j]) * swept;
          by_direction += sweep.direction * swept;
          if (s == first_used(joint)) by_motion += swept;
        }
        before = &sample;
      }
    }
    joint.sense_by = by_angles != 0      ? SenseBy::angles
                     : by_direction != 0 ? (senses_told() ? SenseBy::plan : SenseBy::nothing)
                                         : SenseBy::nothing;
    return (by_angles != 0 ? by_angles : by_direction != 0 ? by_direction : by_motion) < 0;
  }

  [[nodiscard]] bool senses_told() const { return !directions_assigned_ || senses_found_; }

  [[nodiscard]] static std::size_t first_used(const JointResult& joint) {
    return static_cast<std::size_t>(std::find(joint.used.begin(), joint.used.end(), true) -
                                    joint.used.begin());
  }

  void extract() {
    specify();
    // The DH table's Z axes: those of positive rotation, turned as the specified table has them.
    const auto turned = [&](const std::vector<std::optional<Axis>>& axes) {
      auto other = axes;
      for (std::size_t j = 0; j < campaign_.joints; ++j)
        if (other[j] && campaign_.specified && campaign_.specified->positive[j] < 0)
          other[j] = other[j]->reversed();
      return other;
    };
    std::vector<std::optional<Axis>> positive;
    for (const JointResult& joint : result_.joints) positive.push_back(joint.axis);
    if (campaign_.specified)
      settle_senses(positive, turned);
    else
      tell_unknown_senses();
    result_.circle_dh =
        placed_table(turned(positive), result_.specified, size_by_circles_mm(result_));
  }

  /// Turns axes whose sense nothing certain tells as they agree with the specified table.
  template <class Turned>
  void settle_senses(std::vector<std::optional<Axis>>& positive, const Turned& turned) {
    std::vector<SenseBy> known;
    for (const JointResult& joint : result_.joints) known.push_back(joint.sense_by);
    const auto senses =
        senses_of(positive, known, *campaign_.specified, likely_poses(), campaign_.device_frame);
    const auto with = [&](const std::vector<int>& turns) {
      auto axes = positive;
      for (std::size_t j = 0; j < axes.size(); ++j)
        if (axes[j] && turns[j] < 0) axes[j] = axes[j]->reversed();
      return axes;
    };
    if (!senses.ambiguous.empty()) {
      const auto table = [&](const std::vector<int>& turns) {
        return placed_table(turned(with(turns)), result_.specified, size_by_circles_mm(result_));
      };
      std::vector<std::vector<DhEstimate>> others;
      for (const auto& other : senses.others) others.push_back(table(other));
      result_.doubt = unknown(senses.ambiguous);
      const auto best = table(senses.senses);
      result_.by_sense = other_numbers(best, others);
      warn("direction_ambiguous", senses.ambiguous.front(),
           result_.doubt + ": " + differing_numbers(best, result_.by_sense) +
               "; record joint angles, or give the plan that was run and the home pose");
    }
    for (const std::size_t j : senses.against) result_.joints[j].against_plan = true;
    tell_against_plan();
    positive = with(senses.senses);
    for (std::size_t j = 0; j < campaign_.joints; ++j) result_.joints[j].axis = positive[j];
  }

  [[nodiscard]] std::optional<Warning> mistold_of(std::size_t j) const {
    for (const Sweep& sweep : sweeps_)
      if (sweep.joint == j)
        if (auto mistake = mistold(sweep)) return mistake;
    return std::nullopt;
  }

  [[nodiscard]] std::string unknown(const std::vector<std::size_t>& joints) const {
    return "nothing tells which way " + joints_named(joints) + ' ' + verb(joints) +
           (joints.size() > 1 ? "" : "s");
  }

  [[nodiscard]] const char* verb(const std::vector<std::size_t>& joints) const {
    const bool any_linear = std::any_of(joints.begin(), joints.end(),
                                        [&](std::size_t j) { return result_.joints[j].linear; });
    return any_linear ? "move" : "turn";
  }

  /// Without a table to agree with, which would be the wrong one the other way.
  void tell_unknown_senses() {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < result_.joints.size(); ++j)
      if (result_.joints[j].axis && result_.joints[j].sense_by == SenseBy::nothing)
        joints.push_back(j);
    if (joints.empty()) return;
    warn("direction_ambiguous", joints.front(),
         unknown(joints) + ": each is taken to " + verb(joints) +
             " the way that it moved first. The other way, b and alpha change their signs, and "
             "theta is half a turn off; record joint angles, name the robot, or give the plan that "
             "was run");
  }

  /// Plan and description tell two robots, whose axes turn one way and the other.
  void tell_against_plan() {
    std::vector<std::size_t> joints;
    for (std::size_t j = 0; j < result_.joints.size(); ++j)
      if (result_.joints[j].against_plan) joints.push_back(j);
    if (joints.empty()) return;
    const std::string why =
        joints_named(joints) + " turned against the plan, as the robot description tells";
    warn("plan_contradicted", {},
         why +
             ": check that the plan is the one that was run, and alpha_deg and positive of the "
             "description; or record joint angles");
    if (result_.doubt.empty()) result_.doubt = why;
  }

  /// Angles at which the joints may have stood: those that were found, declared or described.
  [[nodiscard]] std::vector<std::vector<double>> likely_poses() const {
    std::vector<std::vector<double>> poses;
    const Arm& arm = *campaign_.specified;
    const auto known = [](const std::optional<double>& angle) { return angle.has_value(); };
    if (std::all_of(result_.home_rad.begin(), result_.home_rad.end(), known)) {
      poses.emplace_back();
      for (const auto& angle : result_.home_rad) poses.back().push_back(*angle);
      return poses;
    }
    if (campaign_.declared_home_rad.size() == arm.joints())
      poses.push_back(campaign_.declared_home_rad);
    poses.push_back(arm.home_rad);
    return poses;
  }

  /// The specified table at the home of this campaign.
  void specify() {
    if (!campaign_.specified) return;
    result_.specified = campaign_.specified->rows;
    for (std::size_t j = 0; j < campaign_.joints; ++j)
      if (result_.home_rad[j])
        result_.specified[j] = specified_row(*campaign_.specified, j, *result_.home_rad[j]);
  }

  const Campaign& campaign_;
  std::vector<Sweep> sweeps_;
  CircleEstimate result_;
  bool home_declared_ = true;         // nothing contradicts the declared home
  bool directions_assigned_ = false;  // by assign_joints
  bool senses_found_ = false;         // by it
};

}  // namespace

CircleEstimate estimate_circles(std::vector<Sweep> sweeps, const Campaign& campaign) {
  return Circles(std::move(sweeps), campaign).run();
}

}  // namespace identify
