#include "identify/circle_estimator.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "identify/axis_senses.hpp"
#include "identify/dh_comparison.hpp"
#include "identify/home.hpp"
#include "identify/number_text.hpp"
#include "identify/points.hpp"

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

  Identification run() {
    assign();
    result_.home_rad = find_home(sweeps_, campaign_.joints, campaign_.resolution);
    mark_positioning(sweeps_, result_.home_rad, campaign_.resolution);
    const bool told = std::any_of(sweeps_.begin(), sweeps_.end(),
                                  [](const Sweep& sweep) { return sweep.first().joints > 0; });
    if (!told && home_declared_ && campaign_.declared_home_rad.size() == campaign_.joints)
      result_.home_rad.assign(campaign_.declared_home_rad.begin(),
                              campaign_.declared_home_rad.end());
    for (std::size_t j = 0; j < campaign_.joints; ++j) fit(j);
    judge_axes();
    extract();
    summarise();
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
      result_.warnings = std::move(assigned.warnings);
    }
    std::erase_if(sweeps_, [&](const Sweep& sweep) {
      return sweep.joint && *sweep.joint >= campaign_.joints;
    });
  }

  void fit(std::size_t j) {
    JointResult& joint = result_.joints[j];
    SweepDefect worst = SweepDefect::none;
    std::size_t elsewhere = 0;
    for (const Sweep& sweep : sweeps_) {
      if (sweep.joint != j) continue;
      if (sweep.defect != SweepDefect::none) {
        worst = sweep.defect;
        continue;
      }
      const bool home = at_home(sweep, result_.home_rad, campaign_.resolution);
      if (!home) ++elsewhere;
      joint.sweeps.push_back(sweep);
      joint.used.push_back(home && !sweep.positioning);
    }
    if (std::find(joint.used.begin(), joint.used.end(), true) == joint.used.end()) {
      if (elsewhere > 0)
        warn("off_home", j,
             joint_name(j) +
                 ": the other joints stood elsewhere than in the other "
                 "sweeps: lock them at one common home pose");
      else if (worst != SweepDefect::none)
        warn(code(worst), j, joint_name(j) + ": " + std::string(remedy(worst)));
      else
        warn("joint_never_moved", j, joint_name(j) + " was never swept alone");
      return;
    }
    std::size_t first_target = kNoTarget;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      if (!joint.used[s]) continue;
      first_target = std::min(first_target, joint.sweeps[s].target);
    }
    joint.circle_target = first_target;
    const Matrix3Xd points = used_points(j, first_target);
    if (points.cols() == 0) {
      positions_missing_ = true;
      return;
    }
    joint.circle = fit_circle(points);
    if (!joint.circle) {
      warn("not_an_arc", j, joint_name(j) + ": " + std::string(remedy(SweepDefect::not_an_arc)));
      return;
    }
    orient(j);
  }

  static constexpr std::size_t kNoTarget = static_cast<std::size_t>(-1);

  /// Positions of the used sweeps of one target, or of all.
  Matrix3Xd used_points(std::size_t j, std::size_t target = kNoTarget) const {
    const JointResult& joint = result_.joints[j];
    const auto wanted = [&](std::size_t s) {
      return joint.used[s] && (target == kNoTarget || joint.sweeps[s].target == target);
    };
    Eigen::Index count = 0;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      if (wanted(s)) count += static_cast<Eigen::Index>(joint.sweeps[s].samples->size());
    Matrix3Xd points(3, count);
    count = 0;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      if (wanted(s))
        for (const Sample& sample : *joint.sweeps[s].samples)
          if (sample.has_position) points.col(count++) = sample.position_mm;
    points.conservativeResize(3, count);
    return points;
  }

  /// Turns the normal to positive rotation of the joint: pooled strokes run both ways, and so may
  /// one. Where angles are told, what was swept as they rose counts against what was as they fell;
  /// where not, a stroke's direction.
  void orient(std::size_t j) {
    JointResult& joint = result_.joints[j];
    Vector3d by_angles = Vector3d::Zero(), by_direction = Vector3d::Zero(),
             by_motion = by_direction;
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      const Sweep& sweep = joint.sweeps[s];
      if (!joint.used[s] || sweep.target != joint.circle_target) continue;
      const Sample* before = nullptr;
      for (const Sample& sample : *sweep.samples) {
        if (!sample.has_position) continue;
        if (before != nullptr) {
          const Vector3d swept = (before->position_mm - joint.circle->center_mm)
                                     .cross(sample.position_mm - before->position_mm);
          if (sample.joints > j && before->joints > j)
            by_angles += (sample.angles_rad[j] - before->angles_rad[j]) * swept;
          by_direction += sweep.direction * swept;
          if (s == first_used(joint)) by_motion += swept;
        }
        before = &sample;
      }
    }
    joint.sense_by = !by_angles.isZero(0)      ? SenseBy::angles
                     : !by_direction.isZero(0) ? (senses_told() ? SenseBy::plan : SenseBy::nothing)
                                               : SenseBy::nothing;
    const Vector3d& turned = !by_angles.isZero(0)      ? by_angles
                             : !by_direction.isZero(0) ? by_direction
                                                       : by_motion;
    if (turned.dot(joint.circle->normal) < 0) joint.circle->normal = -joint.circle->normal;
  }

  [[nodiscard]] bool senses_told() const { return !directions_assigned_ || senses_found_; }

  [[nodiscard]] static std::size_t first_used(const JointResult& joint) {
    return static_cast<std::size_t>(std::find(joint.used.begin(), joint.used.end(), true) -
                                    joint.used.begin());
  }

  /// The noise of a joint's fit is not below that of its neighbours: a target near an axis leaves
  /// small residuals and a wrong normal.
  double usual_noise(double CircleFit::*rms) const {
    std::vector<double> all;
    for (const JointResult& joint : result_.joints)
      if (joint.circle) all.push_back((*joint.circle).*rms);
    if (all.empty()) return 0;
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                     all.end());
    return all[all.size() / 2];
  }

  void judge_axes() {
    const double plane = usual_noise(&CircleFit::plane_rms_mm);
    const double radial = usual_noise(&CircleFit::radial_rms_mm);
    const double quantum = campaign_.resolution.position_mm / std::sqrt(12.0);
    for (std::size_t j = 0; j < campaign_.joints; ++j) {
      JointResult& joint = result_.joints[j];
      if (!joint.circle) continue;
      const CircleFit& circle = *joint.circle;
      Axis axis{circle.normal, circle.center_mm,
                axis_covariance(circle, used_points(j, joint.circle_target),
                                std::max({circle.plane_rms_mm, plane, quantum}),
                                std::max({circle.radial_rms_mm, radial, quantum}))};
      if (axis.direction_sigma_rad() < kWorstDirection_rad) joint.axis = std::move(axis);
    }
  }

  /// Where the robot's own size matters, an upper estimate from the points will do.
  double size_mm() const {
    std::vector<Vector3d> places;
    for (const JointResult& joint : result_.joints) {
      if (!joint.circle) continue;
      places.push_back(joint.circle->center_mm);
      places.push_back(joint.circle->center_mm +
                       joint.circle->radius_mm * joint.circle->normal.unitOrthogonal());
    }
    double size = 1;
    for (const auto& a : places)
      for (const auto& b : places) size = std::max(size, (a - b).norm());
    return size;
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
    if (campaign_.specified) settle_senses(positive, turned);
    const auto z = turned(positive);
    result_.dh = extract_dh(z, size_mm(), result_.specified);
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
      const auto table = extract_dh(turned(with(senses.senses)), size_mm(), result_.specified);
      const auto other = extract_dh(turned(with(senses.other)), size_mm(), result_.specified);
      std::string joints;
      for (const std::size_t j : senses.ambiguous)
        joints += (joints.empty() ? "" : ", ") + std::to_string(j + 1);
      result_.doubt = "nothing tells which way joint" +
                      std::string(senses.ambiguous.size() > 1 ? "s " : " ") + joints +
                      (senses.ambiguous.size() > 1 ? " turn" : " turns");
      warn("direction_ambiguous", senses.ambiguous.front(),
           result_.doubt + ": " + differing_numbers(table, other) +
               "; record joint angles, or give the plan that was run and the home pose");
    }
    for (const std::size_t j : senses.against)
      warn("plan_contradicted", j,
           joint_name(j) +
               ": it turned against the plan, as the robot description tells: check that the plan "
               "is the one that was run");
    positive = with(senses.senses);
    for (std::size_t j = 0; j < campaign_.joints; ++j) result_.joints[j].axis = positive[j];
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
        result_.specified[j].theta_rad =
            wrapped(result_.specified[j].theta_rad +
                    campaign_.specified->positive[j] *
                        (*result_.home_rad[j] - campaign_.specified->home_rad[j]));
  }

  void summarise() {
    std::vector<Matrix3Xd> points;
    Eigen::Index count = 0;
    std::size_t axes = 0;
    std::string missing;
    for (std::size_t j = 0; j < campaign_.joints; ++j) {
      if (!result_.joints[j].axis) {
        missing += (missing.empty() ? "" : ", ") + std::to_string(j + 1);
        continue;
      }
      ++axes;
      points.push_back(used_points(j));
      result_.joints[j].box = minimum_bounding_box(points.back());
      count += points.back().cols();
    }
    Matrix3Xd all(3, count);
    count = 0;
    for (const auto& some : points) {
      all.middleCols(count, some.cols()) = some;
      count += some.cols();
    }
    if (all.cols() > 0) result_.bounding_box = minimum_bounding_box(all);
    if (positions_missing_) {
      // Strokes that angles alone tell are something: partial, not failed.
      result_.status = Status::partial;
      result_.reason =
          "the data carry no positions: on a KUKA controller, add DEF_RIst to the SEND list of the "
          "Ethernet file";
      warn("no_positions", {}, result_.reason);
    } else if (axes == campaign_.joints) {
      result_.status = Status::complete;
    } else {
      result_.status = axes > 0 ? Status::partial : Status::failed;
      result_.reason =
          sweeps_.empty() ? "no sweep of a single joint was seen" : "no axis for joint " + missing;
    }
  }

  const Campaign& campaign_;
  std::vector<Sweep> sweeps_;
  Identification result_;
  bool home_declared_ = true;         // nothing contradicts the declared home
  bool directions_assigned_ = false;  // by assign_joints
  bool senses_found_ = false;         // by it
  bool positions_missing_ = false;
};

}  // namespace

Identification identify_by_circles(std::vector<Sweep> sweeps, const Campaign& campaign) {
  return Circles(std::move(sweeps), campaign).run();
}

}  // namespace identify
