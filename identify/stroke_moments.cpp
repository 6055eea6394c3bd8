#include "identify/stroke_moments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "identify/angle.hpp"
#include "identify/points.hpp"
#include "identify/robust_circle.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;



double wrapped_angle(double angle) {
  return std::remainder(angle, 2 * kPi);
}

Matrix3d rotation_of(const Sample& sample) {
  const auto [a, b, c] = sample.abc_rad;
  return (Eigen::AngleAxisd(a, Vector3d::UnitZ()) * Eigen::AngleAxisd(b, Vector3d::UnitY()) *
          Eigen::AngleAxisd(c, Vector3d::UnitX()))
      .toRotationMatrix();
}

Vector3d rotation_vector(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// Chebyshev nodes over a section of the turn, and the Lagrange polynomials through them by the
/// second barycentric formula (Berrut & Trefethen 2004, eqs. 4.2 and 5.3).
class Lagrange {
 public:
  static constexpr std::size_t kNodes = 12;
  using Values = std::array<double, kNodes>;

  Lagrange(double from, double to) {
    for (std::size_t k = 0; k < kNodes; ++k) {
      const double angle = (2 * static_cast<double>(k) + 1) * kPi / (2 * kNodes);
      nodes_[k] = (from + to) / 2 + (to - from) / 2 * std::cos(angle);
      factors_[k] = (k % 2 == 0 ? 1 : -1) * std::sin(angle);
    }
  }
  [[nodiscard]] double node(std::size_t k) const { return nodes_[k]; }
  void at(double x, Values& values) const {
    double sum = 0;
    for (std::size_t k = 0; k < kNodes; ++k) {
      const double apart = x - nodes_[k];
      if (apart == 0) {
        values.fill(0);
        values[k] = 1;
        return;
      }
      values[k] = factors_[k] / apart;
      sum += values[k];
    }
    for (double& value : values) value /= sum;
  }

 private:
  Values nodes_{}, factors_{};
};

/// Longer strokes are cut: twelve nodes hold what a model says over so much.
constexpr double kSection_rad = kPi / 4;

/// The samples as they are worked on.
struct Seen {
  std::vector<const Sample*> samples;
  std::vector<double> turns;            // x
  Eigen::Matrix<double, 6, Eigen::Dynamic> errors;  // e
  VectorXd weights;
};

/// The stroke's own smooth curve: least squares by Chebyshev polynomials of the turn.
class Curve {
 public:
  Curve(const std::vector<double>& turns, double from, double to, Index orders)
      : basis_(orders, static_cast<Index>(turns.size())) {
    for (Index i = 0; i < basis_.cols(); ++i) {
      const double x = to > from ? (2 * turns[static_cast<std::size_t>(i)] - from - to) / (to - from) : 0;
      double before = 1, value = x;
      for (Index m = 0; m < orders; ++m) {
        basis_(m, i) = m == 0 ? 1 : value;
        if (m > 0) before = std::exchange(value, 2 * x * value - before);
      }
    }
  }
  /// What the curve leaves of `errors`, one a column.
  [[nodiscard]] MatrixXd left(const MatrixXd& errors, const VectorXd& weights) const {
    const MatrixXd weighted = basis_ * weights.asDiagonal();
    MatrixXd normal = weighted * basis_.transpose();
    normal.diagonal() *= 1 + 1e-12;
    const MatrixXd found = normal.ldlt().solve(weighted * errors.transpose());
    return errors - found.transpose() * basis_;
  }

 private:
  MatrixXd basis_;
};

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The distance that a good sample hardly passes.
constexpr double kPlateau = 2.5;

/// Redescending weights by the distance in standard deviations of the median sample.
VectorXd weights_of(const MatrixXd& left) {
  const auto directions = static_cast<double>(left.rows());
  VectorXd squares = VectorXd::Zero(left.cols());
  for (Index d = 0; d < left.rows(); ++d) {
    std::vector<double> sizes(static_cast<std::size_t>(left.cols()));
    for (Index i = 0; i < left.cols(); ++i) sizes[static_cast<std::size_t>(i)] = std::abs(left(d, i));
    constexpr double kMedianOfNormal = 0.6745;
    const double sigma = std::max(1e-10, median_of(std::move(sizes)) / kMedianOfNormal);
    squares += (left.row(d).transpose() / sigma).array().square().matrix();
  }
  VectorXd weights(left.cols());
  const double plateau = std::sqrt(directions) + kPlateau;
  for (Index i = 0; i < weights.size(); ++i) {
    const double share = std::clamp(2 - std::sqrt(squares(i)) / plateau, 0.0, 1.0);
    weights(i) = share * share;
  }
  return weights;
}

}  // namespace

Matrix3d StrokeMoments::directions(double turn_rad) const {
  const Vector3d outward =
      Eigen::AngleAxisd(sense * (turn_rad - zero_rad), circle.normal) * arm;
  Matrix3d rows;
  rows.row(0) = outward.transpose();
  rows.row(1) = circle.normal.transpose();
  rows.row(2) = circle.normal.cross(outward).transpose();
  return rows;
}

double StrokeMoments::angle_about(const Vector3d& point_mm) const {
  const Vector3d from = point_mm - circle.center_mm;
  return std::atan2(circle.normal.dot(arm.cross(from)), arm.dot(from));
}

Vector3d StrokeMoments::departure(const Vector3d& point_mm, double turn_rad) const {
  const Vector3d from = point_mm - circle.center_mm;
  const double height = circle.normal.dot(from);
  const double off = (from - height * circle.normal).norm();
  const double along = wrapped_angle(angle_about(point_mm) - sense * (turn_rad - zero_rad));
  return {off - circle.radius_mm, height, circle.radius_mm * along};
}

Vector3d StrokeMoments::departure(const Matrix3d& tool, double turn_rad) const {
  const Matrix3d there =
      Eigen::AngleAxisd(sense * (turn_rad - zero_rad), circle.normal) * orientation;
  return directions(turn_rad) * rotation_vector(tool * there.transpose());
}

namespace {

/// Which way x goes about the circle, where it is zero, and whether what is told follows the arc.
void set_turns(StrokeMoments& stroke, Seen& seen) {
  const std::size_t count = seen.samples.size();
  std::vector<double> about(count);
  // Unwrapped along the motion.
  double last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = stroke.angle_about(seen.samples[i]->position_mm);
    last += wrapped_angle(angle - last);
    about[i] = last;
  }
  if (stroke.content.joints > 0) {
    const auto told = [&](std::size_t i) {
      return seen.samples[i]->angles_rad[stroke.content.joint];
    };
    double mean_told = 0, mean_about = 0;
    for (std::size_t i = 0; i < count; ++i) {
      mean_told += told(i) / static_cast<double>(count);
      mean_about += about[i] / static_cast<double>(count);
    }
    double together = 0;
    for (std::size_t i = 0; i < count; ++i)
      together += (told(i) - mean_told) * (about[i] - mean_about);
    stroke.sense = together < 0 ? -1 : 1;
    std::vector<double> apart(count);
    for (std::size_t i = 0; i < count; ++i)
      apart[i] = about[i] - mean_about - stroke.sense * (told(i) - mean_told);
    const double middle = median_of(apart);
    for (double& one : apart) one = std::abs(one - middle);
    constexpr double kFollows_rad = 0.1;
    stroke.told = median_of(apart) < kFollows_rad;
    if (stroke.told) {
      stroke.zero_rad = mean_told;
      const double there = mean_about + middle;
      stroke.arm = Eigen::AngleAxisd(there, stroke.circle.normal) * stroke.arm;
      seen.turns.resize(count);
      for (std::size_t i = 0; i < count; ++i) seen.turns[i] = told(i);
      return;
    }
    stroke.sense = 1;
  }
  seen.turns = std::move(about);
}

void set_errors(StrokeMoments& stroke, Seen& seen) {
  const auto count = static_cast<Index>(seen.samples.size());
  if (stroke.content.orientation) {
    // The reference orientation: the mean of what each sample says, from the middle one.
    const auto said = [&](std::size_t i) {
      return Matrix3d(Eigen::AngleAxisd(-stroke.sense * (seen.turns[i] - stroke.zero_rad),
                                        stroke.circle.normal) *
                      rotation_of(*seen.samples[i]));
    };
    const Matrix3d start = said(seen.samples.size() / 2);
    std::vector<Vector3d> off(seen.samples.size());
    for (std::size_t i = 0; i < off.size(); ++i) off[i] = rotation_vector(said(i) * start.transpose());
    const Vector3d middle = median(off);
    stroke.orientation = Eigen::AngleAxisd(middle.norm(), middle.stableNormalized()) * start;
  }
  seen.errors.setZero(6, count);
  for (Index i = 0; i < count; ++i) {
    const Sample& sample = *seen.samples[static_cast<std::size_t>(i)];
    const double turn = seen.turns[static_cast<std::size_t>(i)];
    seen.errors.col(i).head<3>() = stroke.departure(sample.position_mm, turn);
    if (!stroke.told) seen.errors(2, i) = 0;
    if (stroke.content.orientation)
      seen.errors.col(i).tail<3>() = stroke.departure(rotation_of(sample), turn);
  }
}

/// Orders of the stroke's own curve.
Index curve_orders(Index samples) {
  return std::clamp<Index>(samples / 8, 1, 8);
}

void set_weights(StrokeMoments& stroke, Seen& seen) {
  const auto count = static_cast<Index>(seen.samples.size());
  const Index directions = stroke.told ? 3 : 2;
  const MatrixXd errors = seen.errors.topRows(directions);
  const Curve curve(seen.turns, stroke.from_rad, stroke.to_rad, curve_orders(count));
  seen.weights = weights_of(errors.topRows(2));  // the circle is robust; what is told may be off
  MatrixXd left;
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    left = curve.left(errors, seen.weights);
    seen.weights = weights_of(left);
  }
  stroke.blocks.curve_orders = static_cast<std::size_t>(curve_orders(count));
  stroke.blocks.directions = static_cast<std::size_t>(directions);
  const MatrixXd weighed = left * seen.weights.cwiseSqrt().asDiagonal();
  for (Index block = 1; block * 8 <= count || block == 1; block *= 2) {
    double sum = 0;
    const Index blocks = count / block;
    for (Index b = 0; b < blocks; ++b)
      sum += weighed.middleCols(b * block, block).rowwise().sum().squaredNorm();
    stroke.blocks.variance_mm2.push_back(
        sum / static_cast<double>(blocks * block * directions));
  }
}

void add_moments(StrokeMoments& stroke, const Seen& seen) {
  const Index with_errors = stroke.content.orientation ? 6 : 3;
  const auto wobbles = static_cast<Index>(stroke.content.joints);
  const Index size = 1 + with_errors + wobbles;
  const double range = stroke.to_rad - stroke.from_rad;
  const auto sections = static_cast<std::size_t>(std::max(1.0, std::ceil(range / kSection_rad)));
  std::vector<Lagrange> lagrange;
  for (std::size_t s = 0; s < sections; ++s) {
    const auto at = [&](std::size_t k) {
      return stroke.from_rad + range * static_cast<double>(k) / static_cast<double>(sections);
    };
    lagrange.emplace_back(at(s), at(s + 1));
    for (std::size_t k = 0; k < Lagrange::kNodes; ++k)
      stroke.nodes.push_back({lagrange.back().node(k), MatrixXd::Zero(size, size)});
  }
  VectorXd z(size);
  z(0) = 1;
  Lagrange::Values values;
  for (std::size_t i = 0; i < seen.samples.size(); ++i) {
    const double weight = seen.weights(static_cast<Index>(i));
    if (weight == 0) continue;
    z.segment(1, with_errors) = seen.errors.col(static_cast<Index>(i)).head(with_errors);
    for (Index k = 0; k < wobbles; ++k) {
      const auto joint = static_cast<std::size_t>(k);
      z(1 + with_errors + k) =
          joint == stroke.content.joint
              ? 0
              : seen.samples[i]->angles_rad[joint] - stroke.locked_rad[joint];
    }
    const double place = range > 0 ? (seen.turns[i] - stroke.from_rad) / range : 0;
    const auto section = std::min(
        sections - 1, static_cast<std::size_t>(std::max(0.0, place * static_cast<double>(sections))));
    lagrange[section].at(seen.turns[i], values);
    for (std::size_t k = 0; k < Lagrange::kNodes; ++k)
      stroke.nodes[section * Lagrange::kNodes + k]
          .sums.selfadjointView<Eigen::Lower>()
          .rankUpdate(z, weight * values[k]);
  }
  for (StrokeMoments::Node& node : stroke.nodes)
    node.sums.triangularView<Eigen::StrictlyUpper>() = node.sums.transpose();
}

}  // namespace

std::optional<StrokeMoments> moments_of(const Sweep& sweep, const StrokeContent& content) {
  Seen seen;
  for (const Sample& sample : *sweep.samples)
    if (sample.has_position && sample.position_mm.allFinite()) seen.samples.push_back(&sample);
  Eigen::Matrix3Xd points(3, static_cast<Index>(seen.samples.size()));
  for (std::size_t i = 0; i < seen.samples.size(); ++i)
    points.col(static_cast<Index>(i)) = seen.samples[i]->position_mm;
  const auto circle = fit_robust_circle(points);
  if (!circle) return std::nullopt;

  StrokeMoments stroke;
  stroke.content = content;
  stroke.target = sweep.target;
  stroke.falling = sweep.direction < 0;
  stroke.begin_s = sweep.first().time_s;
  stroke.end_s = sweep.last().time_s;
  stroke.samples = seen.samples.size();
  stroke.circle = *circle;
  stroke.extent_mm = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  const Vector3d from = seen.samples[stroke.samples / 2]->position_mm - circle->center_mm;
  const Vector3d across = from - circle->normal * circle->normal.dot(from);
  stroke.arm = across.norm() > 0 ? Vector3d(across.normalized()) : circle->normal.unitOrthogonal();
  for (std::size_t k = 0; k < content.joints; ++k) {
    const double first = seen.samples.front()->angles_rad[k];
    double sum = 0;
    for (const Sample* sample : seen.samples) {
      sum += sample->angles_rad[k] - first;
      stroke.dithers[k] = stroke.dithers[k] || sample->angles_rad[k] != first;
    }
    stroke.locked_rad[k] = first + sum / static_cast<double>(stroke.samples);
  }
  set_turns(stroke, seen);
  const auto [least, greatest] = std::minmax_element(seen.turns.begin(), seen.turns.end());
  stroke.from_rad = *least;
  stroke.to_rad = *greatest;
  set_errors(stroke, seen);
  set_weights(stroke, seen);
  stroke.weight = seen.weights.sum();
  stroke.outliers = static_cast<std::size_t>((seen.weights.array() < 0.5).count());
  add_moments(stroke, seen);
  return stroke;
}

}  // namespace identify
