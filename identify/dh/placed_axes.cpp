#include "identify/dh/placed_axes.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Axes = std::vector<std::optional<Axis>>;

/// What is decided once, and then held while places are differentiated.
class Placement {
 public:
  Placement(const std::vector<DhRow>& specified, double size_mm)
      : specified_(specified), size_mm_(size_mm) {}

  /// Last axis first.
  void decide(Axes& z, const Vector3d& target) {
    parallel_ = std::vector<bool>(z.size());
    for (std::size_t k = z.size(); k-- > 0;) {
      if (!z[k]) continue;
      const bool has_next = k + 1 < z.size() && z[k + 1];
      if (has_next) {
        Axis here = *z[k];
        if (here.linear) {
          here.point_mm = origin(z, k + 1, target);
          here.covariance.bottomRightCorner<3, 3>() =
              z[k + 1]->covariance.bottomRightCorner<3, 3>();
        }
        const Relation relation = relation_between(here, *z[k + 1], size_mm_);
        parallel_[k] = relation != Relation::skew && relation != Relation::intersecting;
      }
      if (z[k]->linear) z[k]->point_mm = place(z, k, target);
    }
  }

  void apply(Axes& z, const Vector3d& target) const {
    for (std::size_t k = z.size(); k-- > 0;)
      if (z[k] && z[k]->linear) z[k]->point_mm = place(z, k, target);
  }

 private:
  /// Of the frame on axis k.
  [[nodiscard]] Vector3d origin(const Axes& z, std::size_t k, const Vector3d& target) const {
    const Line axis = z[k]->line();
    if (k + 1 == z.size() || !z[k + 1]) return axis.closest_mm(target);
    if (parallel_[k])
      return axis.closest_mm(origin(z, k + 1, target)) -
             (specified_.empty() ? 0 : specified_[k].b_mm) * axis.direction;
    return relate(axis, z[k + 1]->line()).first_foot_mm;
  }

  [[nodiscard]] Vector3d place(const Axes& z, std::size_t k, const Vector3d& target) const {
    if (k + 1 == z.size() || !z[k + 1]) return target;
    Vector3d next = origin(z, k + 1, target);
    if (parallel_[k] || specified_.empty()) return next;
    const Vector3d& along = z[k + 1]->direction;
    const double sense = std::sin(specified_[k].alpha_rad) < 0 ? -1 : 1;
    const Vector3d normal = sense * z[k]->direction.cross(along).normalized();
    const bool foot = k + 2 < z.size() && z[k + 2] && !parallel_[k + 1];
    return next - (foot ? specified_[k + 1].b_mm : 0) * along - specified_[k].a_mm * normal;
  }

  const std::vector<DhRow>& specified_;
  double size_mm_;
  std::vector<bool> parallel_;  // to the next axis
};

}  // namespace

bool any_linear(const Axes& axes) {
  return std::any_of(axes.begin(), axes.end(),
                     [](const auto& axis) { return axis && axis->linear; });
}

PlacedAxes placed(Axes z, const Vector3d& target, const MatrixXd& covariance,
                  const std::vector<DhRow>& specified, double size_mm) {
  Placement placement(specified, size_mm);
  placement.decide(z, target);
  const auto rows = static_cast<Index>(6 * z.size());
  PlacedAxes found{z, {}, MatrixXd::Zero(rows, rows + 3)};
  found.by_given.leftCols(rows).setIdentity();
  constexpr double kStep = 1e-6;
  constexpr double kStep_mm = 1e-3;
  for (Index p = 0; p < rows + 3; ++p) {
    const auto joint = static_cast<std::size_t>(p / 6);
    const bool of_axis = p < rows;
    if (of_axis && !z[joint]) continue;
    const double step = of_axis && p % 6 < 3 ? kStep : kStep_mm;
    const auto moved = [&](double by) {
      Axes axes = z;
      Vector3d at = target;
      if (!of_axis)
        at(p - rows) += by;
      else if (p % 6 < 3)
        axes[joint]->direction(p % 6) += by;
      else
        axes[joint]->point_mm(p % 6 - 3) += by;
      placement.apply(axes, at);
      return axes;
    };
    const Axes above = moved(step), below = moved(-step);
    for (std::size_t k = 0; k < z.size(); ++k)
      if (z[k] && z[k]->linear)
        found.by_given.block<3, 1>(static_cast<Index>(6 * k + 3), p) =
            (above[k]->point_mm - below[k]->point_mm) / (2 * step);
  }
  found.covariance =
      found.by_given.lazyProduct(MatrixXd(covariance.lazyProduct(found.by_given.transpose())));
  for (std::size_t k = 0; k < z.size(); ++k)
    if (z[k] && z[k]->linear)
      found.z[k]->covariance =
          found.covariance.block<6, 6>(static_cast<Index>(6 * k), static_cast<Index>(6 * k));
  return found;
}

void leave_to_target(std::vector<DhEstimate>& table, const Axes& z, const MatrixXd& by_target,
                     const std::vector<DhRow>& specified, double size_mm) {
  constexpr double kFollows = 0.01;  // mm a mm: less is second order
  const MatrixXd follows = dh_jacobian(z, size_mm, specified) * by_target;
  for (std::size_t i = 0; i < table.size(); ++i) {
    DhEstimate& row = table[i];
    Index at = static_cast<Index>(5 * i);
    for (DhNumber* number : {&row.b_mm, &row.theta_rad, &row.a_mm, &row.alpha_rad, &row.beta_rad}) {
      const bool length = number == &row.b_mm || number == &row.a_mm;
      if (number->knowledge == Knowledge::identified &&
          follows.row(at).norm() * (length ? 1 : size_mm) > kFollows)
        *number = {number->value, 0, Knowledge::by_convention};
      ++at;
    }
  }
}

std::vector<DhEstimate> placed_table(const Axes& z, const std::vector<DhRow>& specified,
                                     double size_mm) {
  if (!any_linear(z)) return extract_dh(z, size_mm, specified);
  Vector3d target = Vector3d::Zero();
  const auto rows = static_cast<Index>(6 * z.size());
  MatrixXd covariance = MatrixXd::Zero(rows + 3, rows + 3);
  for (std::size_t k = z.size(); k-- > 0;) {
    if (!z[k]) continue;
    if (z[k]->linear) target = z[k]->point_mm;
    const auto at = static_cast<Index>(6 * k);
    covariance.block<6, 6>(at, at) = z[k]->covariance;
  }
  const PlacedAxes all = placed(z, target, covariance, specified, size_mm);
  auto table = extract_dh(all.z, size_mm, specified, all.covariance);
  leave_to_target(table, all.z, all.by_given.rightCols<3>(), specified, size_mm);
  return table;
}

}  // namespace identify
