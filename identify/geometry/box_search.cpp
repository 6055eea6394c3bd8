#include "identify/geometry/box_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>
#include <vector>

#include "identify/geometry/line.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr double kWidthRounding = 2e-16;  // of a width, relative to the size of the set
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The two points that are farthest along and against a direction.
struct Ends {
  Vector3d front;
  Vector3d back;
};

// A set of points that grows and is asked for its ends.
class Points {
 public:
  explicit Points(PointRows rows)
      : size_(rows.rows()), rows_(std::move(rows)), distances_(rows_.rows()) {}

  void add(const Vector3d& point) {
    if (size_ == rows_.rows()) {
      rows_.conservativeResize(2 * size_ + 64, Eigen::NoChange);
      distances_.resize(rows_.rows());
    }
    rows_.row(size_++) = point.transpose();
  }

  Ends ends(const Vector3d& direction) {
    auto distances = distances_.head(size_);
    distances = rows_.col(0).head(size_).array() * direction.x() +
                rows_.col(1).head(size_).array() * direction.y() +
                rows_.col(2).head(size_).array() * direction.z();
    // Two vectorised passes and two short searches are faster than one pass with indices.
    const double greatest = distances.maxCoeff();
    const double least = distances.minCoeff();
    Index front = 0;
    while (front + 1 < size_ && distances(front) < greatest) ++front;
    Index back = 0;
    while (back + 1 < size_ && distances(back) > least) ++back;
    products_ += static_cast<double>(size_);
    return {rows_.row(front).transpose(), rows_.row(back).transpose()};
  }

  [[nodiscard]] double products() const { return products_; }

 private:
  Index size_;
  PointRows rows_;
  Eigen::ArrayXd distances_;
  double products_ = 0;
};

// Many points, sorted into the cells of a grid: only cells that can hold an end are searched.
class Cloud {
 public:
  explicit Cloud(const PointRows& points) {
    constexpr int kParts = 32;
    const Eigen::Array<double, 1, 3> low = points.colwise().minCoeff();
    const Eigen::Array<double, 1, 3> high = points.colwise().maxCoeff();
    const Eigen::Array<double, 1, 3> parts = (1 - 1e-9) * kParts / (high - low).max(1e-300);
    const auto size = static_cast<std::size_t>(points.rows());
    std::vector<std::size_t> cells(size);
    std::vector<Index> ends(kParts * kParts * kParts + 1);
    for (std::size_t i = 0; i < size; ++i) {
      const Eigen::Array<Index, 1, 3> part =
          ((points.row(static_cast<Index>(i)).array() - low) * parts).cast<Index>();
      cells[i] = static_cast<std::size_t>((part.x() * kParts + part.y()) * kParts + part.z());
      ++ends[cells[i] + 1];
    }
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Index> next(ends.begin(), ends.end() - 1);
    rows_.resize(points.rows(), 3);
    for (std::size_t i = 0; i < size; ++i)
      rows_.row(next[cells[i]]++) = points.row(static_cast<Index>(i));

    for (std::size_t c = 0; c + 1 < ends.size(); ++c)
      if (ends[c] < ends[c + 1]) begins_.push_back(ends[c]);
    begins_.push_back(points.rows());
    middles_.resize(static_cast<Index>(begins_.size()) - 1, 3);
    halves_.resizeLike(middles_);
    for (Index c = 0; c < middles_.rows(); ++c) {
      const auto inside = cell(c);
      middles_.row(c) = (inside.colwise().maxCoeff() + inside.colwise().minCoeff()) / 2;
      halves_.row(c) = (inside.colwise().maxCoeff() - inside.colwise().minCoeff()) / 2;
    }
  }

  Ends ends(const Vector3d& direction) {
    const Eigen::ArrayXd middle = middles_ * direction;
    const Eigen::ArrayXd half = halves_ * direction.cwiseAbs();
    products_ += static_cast<double>(2 * middle.size());
    return {farthest(direction, half + middle), farthest(-direction, half - middle)};
  }

  [[nodiscard]] double products() const { return products_; }

 private:
  [[nodiscard]] Eigen::Block<const PointRows> cell(Index c) const {
    const auto at = static_cast<std::size_t>(c);
    return rows_.block(begins_[at], 0, begins_[at + 1] - begins_[at], 3);
  }

  Vector3d farthest(const Vector3d& direction, const Eigen::ArrayXd& bounds) {
    double greatest = -kInfinity;
    Vector3d end;
    const auto search = [&](Index c) {
      const auto inside = cell(c);
      Index row = 0;
      const double distance = (inside * direction).maxCoeff(&row);
      products_ += static_cast<double>(inside.rows());
      if (distance <= greatest) return;
      greatest = distance;
      end = inside.row(row).transpose();
    };
    Index most = 0;
    bounds.maxCoeff(&most);
    search(most);
    for (Index c = 0; c < bounds.size(); ++c)
      if (bounds(c) > greatest && c != most) search(c);
    return end;
  }

  PointRows rows_;
  std::vector<Index> begins_;  // of the cells that hold points, and the end of the last
  PointRows middles_;
  PointRows halves_;
  double products_ = 0;
};

// A box of Rodrigues vectors (rotation axis times the tangent of half the angle).
struct Cell {
  Vector3d centre;
  Vector3d half;
  double bound = -kInfinity;  // no orientation in the cell has a smaller log volume
  int split = 0;              // the coordinate that loosens the bound most
};

struct HigherBound {
  bool operator()(const Cell& a, const Cell& b) const { return a.bound > b.bound; }
};

class BoundedSearch {
 public:
  BoundedSearch(const PointRows& points, int rank, double least_width, double tolerance,
                double max_products)
      : rank_(rank),
        log_least_width_(std::log(least_width)),
        tolerance_(std::max(tolerance, kWidthRounding / least_width)),
        max_products_(max_products),
        all_(points),
        core_(PointRows(0, 3)) {
    for (const double x : {-1.0, 0.0, 1.0}) {
      for (const double y : {-1.0, 0.0, 1.0}) {
        add_to_core(all_.ends(Vector3d(x, y, 1)));
      }
    }
    for (const auto& [x, y] : {std::array{1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {1.0, -1.0}}) {
      add_to_core(all_.ends(Vector3d(x, y, 0)));
    }
  }

  BoxSearch run() {
    // A box does not change when its axes are renamed or reversed. Of the 24 rotations that are
    // the same box, the one with the smallest angle has its Rodrigues vector in a cube with cut-off
    // corners: |x|, |y|, |z| <= tan(45 deg / 2), |x| + |y| + |z| <= 1.
    Cell root;
    root.centre.setZero();
    root.half.setConstant(std::numbers::sqrt2 - 1);
    if (rank_ == 2) root.half.head<2>().setZero();
    evaluate(root);

    std::priority_queue<Cell, std::vector<Cell>, HigherBound> open;
    open.push(root);
    while (!open.empty()) {
      const Cell cell = open.top();
      result_.gap = log_volume_ - cell.bound;
      if (result_.gap <= tolerance_ || all_.products() + core_.products() > max_products_) break;
      open.pop();
      const double half = cell.half(cell.split) / 2;
      if (half < std::numeric_limits<double>::epsilon() / 8) continue;  // a single orientation
      for (const double shift : {-half, half}) {
        Cell child = cell;
        child.half(cell.split) = half;
        child.centre(cell.split) += shift;
        if ((child.centre.cwiseAbs() - child.half).cwiseMax(0).sum() > 1 + 1e-12) continue;
        evaluate(child);
        if (child.bound < log_volume_ - tolerance_) open.push(child);
      }
    }
    result_.gap = open.empty() ? tolerance_ : std::max(tolerance_, result_.gap);
    return result_;
  }

 private:
  void add_to_core(const Ends& ends) {
    core_.add(ends.front);
    core_.add(ends.back);
  }

  // Keeps the cell's middle if it is the smallest box so far, and bounds the volume in the cell.
  void evaluate(Cell& cell) {
    ++result_.cells;
    const double scale = 1 / (1 + cell.centre.squaredNorm());
    const Matrix3d cross = cross_matrix(cell.centre);
    const Matrix3d axes = Matrix3d::Identity() + 2 * scale * (cross + cross * cross);

    // Column i: from the rear end to the front end along axis i, in the axes. A few points (the
    // core) give no more than the true widths, which is all a lower bound needs. Only where they
    // promise a box that halves the gap are all points asked, and the core learns from their
    // answer.
    Matrix3d spans = Matrix3d::Identity();
    Vector3d logs;  // of the widths
    const auto add_logs = [&] {
      for (int i = 0; i < 3; ++i)
        logs(i) = std::log(std::max(spans(i, i), std::numeric_limits<double>::min()));
      return logs(0) + (logs(1) + logs(2));
    };
    for (int i = 0; i < rank_; ++i) {
      const Ends ends = core_.ends(axes.col(i));
      spans.col(i) = axes.transpose() * (ends.front - ends.back);
    }
    double log_volume = add_logs();
    if (log_volume < log_volume_ - std::max(tolerance_, result_.gap) / 2) {
      for (int i = 0; i < rank_; ++i) {
        const Ends ends = all_.ends(axes.col(i));
        const Vector3d span = axes.transpose() * (ends.front - ends.back);
        if (span(i) > spans(i, i)) {
          spans.col(i) = span;
          add_to_core(ends);
        }
      }
      log_volume = add_logs();
      if (log_volume < log_volume_) {
        log_volume_ = log_volume;
        result_.axes = axes;
      }
    }
    bound(cell, cross, scale, spans, logs, log_volume);
  }

  // Seen from the middle c of the cell, its rotations have the Rodrigues vectors
  //   q = J h / (1 + c.h / (1 + c.c)),  J = (I - [c]x) / (1 + c.c),  |h| <= half.
  // The ends that gave the spans d stay in the set, so width i is at least
  //   d.(R(q) e_i) = d_i + 2 / (1 + q.q) (q_l d_j - q_j d_l
  //                                       + q_i (q_j d_j + q_l d_l) - d_i (q_j q_j + q_l q_l))
  // with i, j, l cyclic. The terms linear in q are summed over the widths before they are bounded:
  // near a smooth minimum they cancel, and the bound is good to second order.
  void bound(Cell& cell, const Matrix3d& cross, double scale, const Matrix3d& spans,
             const Vector3d& logs, double log_volume) const {
    const double least_divisor = 1 - scale * cell.centre.cwiseAbs().dot(cell.half);
    const Matrix3d steps = scale * (Matrix3d::Identity() - cross) * cell.half.asDiagonal();
    const Vector3d reach = steps.cwiseAbs().rowwise().sum() / least_divisor;  // of |q|

    Eigen::RowVector3d linear = Eigen::RowVector3d::Zero();
    Eigen::RowVector3d cost = steps.colwise().squaredNorm();
    double bound = log_volume;
    for (int i = 0; i < rank_; ++i) {
      const int j = (i + 1) % 3;
      const int l = (i + 2) % 3;
      const double width = std::max(spans(i, i), std::numeric_limits<double>::min());
      const double across_j = spans(j, i) / width;
      const double across_l = spans(l, i) / width;
      // Relative change of the width by each coordinate of the cell, and by all the rest.
      const Eigen::RowVector3d slopes = 2 * (steps.row(l) * across_j - steps.row(j) * across_l);
      const double rest =
          2 * (reach(i) * (reach(j) * std::abs(across_j) + reach(l) * std::abs(across_l)) +
               reach(j) * reach(j) + reach(l) * reach(l));
      const double change = slopes.cwiseAbs().sum() / least_divisor + rest;
      // log(1 + t) >= t + change + log(1 - change) for |t| <= change < 1
      const double curved = change < 1 ? -std::log1p(-change) - change : kInfinity;
      const double to_least_width = logs(i) - log_least_width_;
      if (change + curved < to_least_width) {
        linear += slopes;
        bound -= rest + curved;
      } else {
        bound -= to_least_width;
      }
      cost += slopes.cwiseAbs2();
    }
    bound -= linear.cwiseAbs().sum() / least_divisor;
    cell.bound = std::max(cell.bound, bound);
    cost += linear.cwiseAbs();
    cost.maxCoeff(&cell.split);
  }

  int rank_;
  double log_least_width_;
  double tolerance_;
  double max_products_;
  Cloud all_;
  Points core_;
  double log_volume_ = kInfinity;  // of the smallest box so far
  BoxSearch result_;
};

}  // namespace

BoxSearch search_box(const PointRows& points, int rank, double least_width, double tolerance,
                     double max_products) {
  return BoundedSearch(points, rank, least_width, tolerance, max_products).run();
}

}  // namespace identify
