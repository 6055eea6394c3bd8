#include "identify/dh/joint_order.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"

namespace identify {
namespace {

/// How far an arm may be off its description, and off the pose that is said.
constexpr double kBuilt_mm = 2;
constexpr double kBuilt_rad = 0.5 * kDegree;
constexpr double kPosed_rad = 1.5 * kDegree;
/// Where many axes are parallel, two and three of them agree with a pose by chance. The thetas that
/// they have in all have to be those of the pose, too.
constexpr double kStands_rad = 20 * kDegree;
constexpr double kStandsSigmas = 4;
/// Lines that are closer to parallel have no common normal worth comparing.
constexpr double kParallel = 0.1;  // sine
/// Orders whose chi squared differs by less are equal as far as one can tell.
constexpr double kEqualOrders = 30;
constexpr std::size_t kMostSteps = 20'000;
constexpr std::size_t kMostStepsOfMore = 100'000;  // where axes are left out
constexpr std::size_t kMostOrders = 500;

double squared(double value) {
  return value * value;
}

/// The axes as they lie at the angles `home_rad`, along positive rotation, exactly.
std::vector<Axis> axes_at(const Arm& arm, const std::vector<double>& home_rad) {
  std::vector<Axis> axes;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    axes.push_back(Axis{arm.positive[j] * frame.linear().col(2), frame.translation()});
    axes.back().linear = arm.is_linear(j);
    frame = frame * transform(arm.row_at(j, home_rad[j]));
  }
  return axes;
}

double reach_of(const Arm& arm) {
  double reach = 1;
  for (const DhRow& row : arm.rows) reach += std::abs(row.a_mm) + std::abs(row.b_mm);
  return reach;
}

double offset(const Axis& first, const Axis& second) {
  return first.direction.cross(second.point_mm - first.point_mm).norm();
}

class OrderSearch {
 public:
  /// `joints`: whose the axes are, where that is known.
  OrderSearch(const std::vector<Axis>& axes, std::size_t to_place,
              const std::vector<std::size_t>& joints, const Arm& arm,
              const std::optional<std::vector<double>>& home)
      : given_(axes),
        to_place_(to_place),
        joints_(joints),
        arm_(arm),
        home_rad_(home.value_or(arm.home_rad)),
        expected_(axes_at(arm, home_rad_)),
        posed_(home.has_value()),
        reach_(reach_of(arm)),
        taken_(axes.size(), false) {
    for (const Axis& axis : axes) {
      direction_.push_back(squared(axis.direction_sigma_rad()));
      point_.push_back(squared(axis.point_sigma_mm()));
    }
    const auto count = static_cast<double>(to_place);
    const double terms = posed_ ? count * (count - 1) * (1 + (count - 2) / 6) : 3 * (count - 1);
    bound_ = 4 * terms + 20;
  }

  JointOrders run() {
    place(0, 0);
    if (found_.undecided) found_.fitting.clear();
    std::erase_if(found_.fitting,
                  [&](const JointOrder& order) { return order.misfit > best_ + kEqualOrders; });
    std::stable_sort(found_.fitting.begin(), found_.fitting.end(),
                     [](const JointOrder& a, const JointOrder& b) { return a.misfit < b.misfit; });
    return std::move(found_);
  }

 private:
  struct Placed {
    std::size_t joint = 0;
    std::size_t given = 0;
    int sense = 1;
    Axis axis;  // along positive rotation
  };

  void place(std::size_t joint, double misfit) {
    if (found_.undecided || misfit > std::min(bound_, best_ + kEqualOrders)) return;
    if (placed_.size() == to_place_) {
      keep(misfit);
      return;
    }
    if (++steps_ > (given_.size() > to_place_ ? kMostStepsOfMore : kMostSteps) ||
        found_.fitting.size() > kMostOrders) {
      found_.undecided = true;
      return;
    }
    for (std::size_t g = 0; g < given_.size(); ++g) {
      if (taken_[g] || (!joints_.empty() && joints_[g] != joint)) continue;
      // Who turns about an axis moves along none.
      if (joints_.empty() && given_[g].linear != expected_[joint].linear) continue;
      taken_[g] = true;
      for (const int sense : {1, -1}) {
        placed_.push_back({joint, g, sense, sense > 0 ? given_[g] : given_[g].reversed()});
        place(joint + 1, misfit + misfit_of_last());
        placed_.pop_back();
      }
      taken_[g] = false;
    }
    const std::size_t left = expected_.size() - joint;
    if (left > to_place_ - placed_.size()) place(joint + 1, misfit);
  }

  void keep(double misfit) {
    if (posed_ && !stands()) return;
    best_ = std::min(best_, misfit);
    JointOrder order{std::vector<std::size_t>(given_.size(), kNoJoint),
                     std::vector<int>(given_.size(), 1), misfit};
    for (const Placed& placed : placed_) {
      order.joints[placed.given] = placed.joint;
      order.senses[placed.given] = placed.sense;
    }
    found_.fitting.push_back(std::move(order));
  }

  /// Whether the thetas of the axes as they are placed are those of the pose, as far as they are
  /// known.
  [[nodiscard]] bool stands() const {
    std::vector<std::optional<Axis>> z(arm_.joints());
    std::vector<DhRow> rows;
    for (const Placed& placed : placed_)
      z[placed.joint] = arm_.positive[placed.joint] > 0 ? placed.axis : placed.axis.reversed();
    for (std::size_t j = 0; j < arm_.joints(); ++j) rows.push_back(arm_.row_at(j, home_rad_[j]));
    const auto table = extract_dh(z, reach_, rows);
    // The first theta hangs on where the base stands, the last one on the tool.
    for (std::size_t j = 1; j + 1 < table.size(); ++j) {
      const DhNumber& theta = table[j].theta_rad;
      if (theta.knowledge != Knowledge::identified) continue;
      const double off = std::abs(wrapped(theta.value - rows[j].theta_rad));
      if (off > kStands_rad + kStandsSigmas * theta.sigma) return false;
    }
    return true;
  }

  /// What the axis placed last adds.
  [[nodiscard]] double misfit_of_last() const {
    const Placed& last = placed_.back();
    double sum = 0;
    for (std::size_t k = 0; k + 1 < placed_.size(); ++k)
      if (posed_ || placed_[k].joint + 1 == last.joint) sum += misfit_of(placed_[k], last);
    for (std::size_t k = 1; posed_ && k + 1 < placed_.size(); ++k)
      for (std::size_t i = 0; i < k; ++i) sum += misfit_of(placed_[i], placed_[k], last);
    if (!posed_ && last.joint >= 2 && placed_.size() >= 3) {
      const Placed& middle = placed_[placed_.size() - 2];
      const Placed& first = placed_[placed_.size() - 3];
      if (middle.joint + 1 == last.joint && first.joint + 2 == last.joint)
        sum += misfit_along(first, middle, last);
    }
    return sum;
  }

  /// A linear joint's axis has a direction only.
  [[nodiscard]] bool placeless(const Placed& one) const {
    return one.axis.linear || expected_[one.joint].linear;
  }

  /// Angle and distance of two lines.
  [[nodiscard]] double misfit_of(const Placed& first, const Placed& second) const {
    const Axis& wanted_first = expected_[first.joint];
    const Axis& wanted_second = expected_[second.joint];
    const LinePair seen = relate(first.axis.line(), second.axis.line());
    const LinePair wanted = relate(wanted_first.line(), wanted_second.line());
    // How neighbours lie to each other does not depend on the pose.
    const bool neighbours = first.joint + 1 == second.joint;
    const double direction =
        direction_[first.given] + direction_[second.given] + (neighbours ? 0 : squared(kPosed_rad));
    const double point = point_[first.given] + point_[second.given];
    double sum = squared(seen.angle_rad - wanted.angle_rad) / (squared(kBuilt_rad) + direction);
    if (placeless(first) || placeless(second)) return sum;
    const double room = squared(kBuilt_mm) + point + squared(reach_) * direction;
    if (wanted.sine < kParallel)
      sum += squared(offset(first.axis, second.axis) - offset(wanted_first, wanted_second)) / room;
    else if (seen.sine >= kParallel)
      sum += squared(seen.distance_mm - wanted.distance_mm) / room;
    return sum;
  }

  /// Handedness of three directions: lines that agree two by two may be all turned round.
  [[nodiscard]] double misfit_of(const Placed& first, const Placed& second,
                                 const Placed& third) const {
    const auto volume = [](const Axis& a, const Axis& b, const Axis& c) {
      return a.direction.dot(b.direction.cross(c.direction));
    };
    const double off =
        volume(first.axis, second.axis, third.axis) -
        volume(expected_[first.joint], expected_[second.joint], expected_[third.joint]);
    double room = squared(kBuilt_rad) + squared(kPosed_rad);
    for (const Placed* placed : {&first, &second, &third}) room += direction_[placed->given];
    return squared(off) / room;
  }

  /// The distance of two common normals along the axis between them: b.
  [[nodiscard]] double misfit_along(const Placed& first, const Placed& middle,
                                    const Placed& last) const {
    double least_sine = 1;
    const auto along = [&](const Axis& a, const Axis& b, const Axis& c) {
      const LinePair before = relate(a.line(), b.line());
      const LinePair after = relate(b.line(), c.line());
      least_sine = std::min({least_sine, before.sine, after.sine});
      return (after.first_foot_mm - before.second_foot_mm).dot(b.direction);
    };
    const double seen = along(first.axis, middle.axis, last.axis);
    const double wanted =
        along(expected_[first.joint], expected_[middle.joint], expected_[last.joint]);
    if (least_sine < kParallel || placeless(first) || placeless(middle) || placeless(last))
      return 0;
    double direction = squared(kBuilt_rad);
    double point = 2 * squared(kBuilt_mm);
    for (const Placed* placed : {&first, &middle, &last}) {
      direction += direction_[placed->given];
      point += point_[placed->given];
    }
    return squared(seen - wanted) / (point + squared(reach_ / least_sine) * direction);
  }

  const std::vector<Axis>& given_;
  std::size_t to_place_;
  const std::vector<std::size_t>& joints_;
  const Arm& arm_;
  std::vector<double> home_rad_;
  std::vector<Axis> expected_;
  bool posed_;
  double reach_;
  std::vector<double> direction_;  // variances, one a given axis
  std::vector<double> point_;
  double bound_ = 0;
  double best_ = 1e300;
  std::size_t steps_ = 0;
  std::vector<bool> taken_;
  std::vector<Placed> placed_;
  JointOrders found_;
};

}  // namespace

JointOrders orders_that_fit(const std::vector<Axis>& axes, std::size_t count, const Arm& arm,
                            const std::optional<std::vector<double>>& home_rad) {
  if (count == 0 || count > axes.size() || count > arm.joints()) return {};
  const std::vector<std::size_t> any;
  return OrderSearch(axes, count, any, arm, home_rad).run();
}

JointOrders senses_that_fit(const std::vector<Axis>& axes, const std::vector<std::size_t>& joints,
                            const Arm& arm, const std::optional<std::vector<double>>& home_rad) {
  if (axes.empty() || axes.size() > arm.joints()) return {};
  return OrderSearch(axes, axes.size(), joints, arm, home_rad).run();
}

}  // namespace identify
