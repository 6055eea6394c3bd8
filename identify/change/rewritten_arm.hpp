#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "identify/change/measured_arm.hpp"
#include "identify/dh/dh.hpp"

namespace identify {

/// What the form that two arms share takes an axis to be to the next.
struct SharedStep {
  Relation relation = Relation::skew;
  double b_mm = 0;  ///< by convention, of parallel axes; a linear joint's grows as it goes

  [[nodiscard]] bool parallel() const {
    return relation == Relation::parallel || relation == Relation::coincident;
  }
};

/// One a row: axes are parallel where one of the two takes them for it, or has them within a degree
/// of it. At the first arm's home. For arms with as many joints, of the same types.
[[nodiscard]] std::vector<SharedStep> shared_steps(const MeasuredArm& first,
                                                   const MeasuredArm& second);
/// The same at the second arm's home: linear joints stand elsewhere there.
[[nodiscard]] std::vector<SharedStep> at_home_of(const MeasuredArm& second,
                                                 const MeasuredArm& first,
                                                 std::vector<SharedStep> steps);

/// An arm's table in the form that two arms share: axes along positive rotation; parallel ones with
/// Hayati's beta; common normals that point alike; a linear joint's axis through the next one,
/// where that is parallel, at the shared step's b.
class RewrittenArm {
 public:
  /// `like`: rows that the common normals shall point as; none: as the table's own. Keeps `arm`.
  RewrittenArm(const MeasuredArm& arm, std::vector<SharedStep> steps,
               const std::vector<DhRow>& like);

  /// The last row is zero.
  [[nodiscard]] const std::vector<DhRow>& rows() const { return rows_; }
  /// Five a row: b, theta, a, alpha, beta; mm, rad.
  [[nodiscard]] Eigen::VectorXd numbers() const;
  /// The table's last frame in the last frame of these rows.
  [[nodiscard]] Eigen::Isometry3d last_frame() const;
  /// Of the numbers.
  [[nodiscard]] Eigen::MatrixXd covariance() const;

 private:
  [[nodiscard]] AxisFrame first_frame() const;
  /// With `normals` they point as these; without, they are chosen and told.
  [[nodiscard]] std::vector<DhRow> written(const Eigen::VectorXd& table,
                                           const std::vector<DhRow>& like,
                                           std::vector<Eigen::Vector3d>& normals) const;

  const MeasuredArm& arm_;
  std::vector<SharedStep> steps_;
  Eigen::VectorXd table_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<DhRow> rows_;
};

}  // namespace identify
