#include "tests/simulation/level_oracle.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace simulation {
namespace {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using identify::PlacedArm;
using identify::Pose;

/// Of each number: what the poses hardly tell stays as it is.
constexpr double kKnown = 1e-5;

Matrix4d about(int axis, double angle) {
  Matrix4d m = Matrix4d::Identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  m(i, i) = m(j, j) = std::cos(angle);
  m(j, i) = std::sin(angle);
  m(i, j) = -m(j, i);
  return m;
}

Matrix4d along(double x, double y, double z) {
  Matrix4d m = Matrix4d::Identity();
  m.col(3) << x, y, z, 1;
  return m;
}

/// Numbers: 6 of the base, 3 of the target, then theta, (b, a), (alpha, beta) of each row: mm, and
/// rad times 1000. By convention b of parallel axes stays, and beta of others.
class Oracle {
 public:
  explicit Oracle(const PlacedArm& start) : start_(start) {}

  [[nodiscard]] Index count(std::size_t level) const {
    const auto joints = static_cast<Index>(start_.arm.joints());
    return 9 + (level > 2 ? 5 : level > 1 ? 3 : level > 0 ? 1 : 0) * joints;
  }

  [[nodiscard]] bool by_convention(Index number) const {
    const auto joints = static_cast<Index>(start_.arm.joints());
    const Index at = number - 9 - joints;
    if (at < 0 || at % 2 != (at < 2 * joints ? 0 : 1)) return false;
    const double twist = start_.arm.rows[static_cast<std::size_t>(at / 2 % joints)].alpha_rad;
    const bool parallel = std::abs(std::sin(twist)) < 0.01;
    return at < 2 * joints ? parallel : !parallel;
  }

  [[nodiscard]] VectorXd off(const VectorXd& x, const std::vector<Pose>& poses) const {
    VectorXd off(static_cast<Index>(3 * poses.size()));
    const auto joints = static_cast<Index>(start_.arm.joints());
    const auto number = [&](Index at) { return at < x.size() ? x(at) : 0.0; };
    const Matrix4d base = along(x(0), x(1), x(2)) * start_.base.matrix() * about(0, x(3) / 1000) *
                          about(1, x(4) / 1000) * about(2, x(5) / 1000);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Matrix4d frame = base;
      for (Index j = 0; j < joints; ++j) {
        const auto joint = static_cast<std::size_t>(j);
        const identify::DhRow& row = start_.arm.rows[joint];
        const double turn = start_.arm.positive[joint] *
                            (poses[i].sample.angles_rad[joint] - start_.arm.home_rad[joint]);
        frame = frame * about(2, row.theta_rad + turn + number(9 + j) / 1000) *
                along(row.a_mm + number(9 + joints + 2 * j + 1), 0,
                      row.b_mm + number(9 + joints + 2 * j)) *
                about(0, row.alpha_rad + number(9 + 3 * joints + 2 * j) / 1000) *
                about(1, row.beta_rad + number(9 + 3 * joints + 2 * j + 1) / 1000);
      }
      Eigen::Vector4d target;
      target << start_.targets_mm.front() + x.segment<3>(6), 1;
      off.segment<3>(static_cast<Index>(3 * i)) =
          poses[i].sample.position_mm - (frame * target).head<3>();
    }
    return off;
  }

  /// From `x`, with the numbers of `level` let go.
  [[nodiscard]] VectorXd fitted(VectorXd x, std::size_t level,
                                const std::vector<Pose>& poses) const {
    x.conservativeResizeLike(VectorXd::Zero(count(level)));
    VectorXd left = off(x, poses);
    double damping = 1e-3;
    for (int step = 0; step < 60 && damping < 1e8; ++step) {
      MatrixXd slopes(left.size(), x.size());
      for (Index k = 0; k < x.size(); ++k) {
        slopes.col(k).setZero();
        if (by_convention(k)) continue;
        VectorXd aside = x;
        aside(k) += 1e-3;
        slopes.col(k) = (left - off(aside, poses)) / 1e-3;
      }
      MatrixXd normal = slopes.transpose() * slopes;
      normal.diagonal() *= 1 + damping;
      normal.diagonal().array() += kKnown;
      const VectorXd by = normal.ldlt().solve(slopes.transpose() * left - kKnown * x);
      const VectorXd next = off(x + by, poses);
      const double gain = left.squaredNorm() + kKnown * x.squaredNorm() - next.squaredNorm() -
                          kKnown * (x + by).squaredNorm();
      if (gain > 0) {
        const bool done = gain < 1e-12 * left.squaredNorm();
        x += by;
        left = next;
        damping /= 10;
        if (done) break;
      } else {
        damping *= 10;
      }
    }
    return x;
  }

 private:
  const PlacedArm& start_;
};

}  // namespace

std::array<identify::Left, identify::kFreedoms> levels_by_differences(
    const PlacedArm& start, const std::vector<Pose>& fitted, const std::vector<Pose>& judged) {
  const Oracle oracle(start);
  std::array<identify::Left, identify::kFreedoms> left;
  VectorXd x = VectorXd::Zero(oracle.count(0));
  for (std::size_t level = 0; level < left.size(); ++level) {
    x = oracle.fitted(x, level, fitted);
    const VectorXd off = oracle.off(x, judged);
    VectorXd distances(off.size() / 3);
    for (Index i = 0; i < distances.size(); ++i) distances(i) = off.segment<3>(3 * i).norm();
    left[level] = {distances.mean(), distances.norm() / std::sqrt(distances.size()),
                   distances.maxCoeff()};
  }
  return left;
}

}  // namespace simulation
