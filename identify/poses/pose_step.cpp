#include "identify/poses/pose_step.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <Eigen/Cholesky>

#include "identify/geometry/line.hpp"
#include "identify/geometry/symmetric_eigen.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Stands before a place and behind it.
constexpr std::size_t kFewestBeside = 4;
/// Of what a move does, so much must be left when the fit has taken up what it can.
constexpr double kStepShare = 1e-3;
/// For all places that are looked at.
constexpr double kStepByChance = 1e-3;
/// A step explains at least 1.23 times as much as any smooth motion does, and a smooth motion as
/// much more than a step.
constexpr double kSudden = 1.05;

/// How what drifts goes on from the first stand, at 0, to the last, at 1: steadily, as what warms
/// up in a part of the time, or to and fro once, from any place of its way. All begin at nothing:
/// where sweeps tell the frame, too, the first poses are in it.
std::vector<std::function<double(double)>> smooth_motions() {
  std::vector<std::function<double(double)>> all{[](double at) { return at; }};
  for (const double part : {0.05, 0.1, 0.2, 0.4})
    all.emplace_back([part](double at) { return 1 - std::exp(-at / part); });
  for (const double begin : {0.0, 0.25, 0.5, 0.75})
    all.emplace_back(
        [begin](double at) { return std::cos(kPi * (2 * at + begin)) - std::cos(kPi * begin); });
  return all;
}

/// The chance of a larger chi-square.
double chance_of_larger(double square, Index degrees) {
  const double half = square / 2;
  if (degrees == 1) return std::erfc(std::sqrt(half));
  if (degrees == 6) return std::exp(-half) * (1 + half + half * half / 2);
  return std::erfc(std::sqrt(half)) + 2 * std::sqrt(half / kPi) * std::exp(-half);  // three
}

/// What is moved: the device with six numbers, turned about the middle of the poses, a target with
/// three, or a joint with one. Its columns stand side by side, in this order.
struct MovedPart {
  PoseStep::Of of;
  std::size_t which;
  Index first, count;
};

/// What moves do to poses, and what the poses' rows say of it.
struct StepScore {
  MatrixXd own;     ///< sum of B' V^-1 B
  MatrixXd common;  ///< and with the columns of the model's parameters
  VectorXd gradient;

  void add(const StepScore& other, double by = 1) {
    own += by * by * other.own;
    common += by * other.common;
    gradient += by * other.gradient;
  }
};

class StepSearch {
 public:
  StepSearch(const PoseFit& fit, const std::vector<Pose>& poses) : fit_(fit), poses_(poses) {
    for (const Pose& pose : poses)
      middle_mm_ += pose.sample.position_mm / static_cast<double>(poses.size());
    moved_.push_back({PoseStep::Of::device, 0, 0, 6});
    for (std::size_t t = 0; t < fit.model.chain.targets_mm.size(); ++t)
      moved_.push_back({PoseStep::Of::target, t, columns(), 3});
    for (std::size_t j = 0; j < fit.model.chain.axes.size(); ++j)
      moved_.push_back({PoseStep::Of::joint, j, columns(), 1});
    for (const StandRows& stand : fit.counted()) {
      from_.push_back(stand.poses.front());
      scores_.push_back(score_of(stand));
    }
  }

  [[nodiscard]] PoseStep largest() const {
    PoseStep best;
    if (scores_.size() < 2 * kFewestBeside) return best;
    double least = 0;  // chi-square less twice its degrees, of the best
    MovedPart part = moved_.front();
    StepScore behind = none();
    for (std::size_t k = scores_.size(); k-- > kFewestBeside;) {
      behind.add(scores_[k]);
      if (k > scores_.size() - kFewestBeside) continue;
      for (const MovedPart& moved : moved_) {
        const auto found = solved(behind, moved);
        if (!found || found->square - 2 * static_cast<double>(moved.count) <= least) continue;
        least = found->square - 2 * static_cast<double>(moved.count);
        best.of = moved.of;
        best.which = moved.which;
        best.turned = moved.of == PoseStep::Of::joint ? found->by(0) : 0;
        best.from = from_[k];
        best.chi_squared = found->square;
        best.bias = (fit_.covariance * found->common.transpose() * found->by)
                        .head(fit_.model.fixed_parameters());
        best.moved_mm = moved_mm(moved, *found, k);
        const double places = static_cast<double>(scores_.size() * moved_.size());
        best.seen = chance_of_larger(found->square, moved.count) * places < kStepByChance &&
                    best.moved_mm > 0;
        part = moved;
      }
    }
    if (best.seen) best.sudden = best.chi_squared > kSudden * drifting(part);
    return best;
  }

 private:
  struct Solved {
    double square = 0;
    VectorXd by;  ///< how far it was moved
    MatrixXd covariance, common;
  };

  [[nodiscard]] Index columns() const { return moved_.back().first + moved_.back().count; }

  [[nodiscard]] StepScore none() const {
    return {MatrixXd::Zero(columns(), columns()), MatrixXd::Zero(columns(), fit_.covariance.rows()),
            VectorXd::Zero(columns())};
  }

  [[nodiscard]] MatrixXd columns_of(std::size_t i) const {
    const PoseRow& row = fit_.rows[i];
    MatrixXd all = MatrixXd::Zero(row.off.size(), columns());
    all.topLeftCorner<3, 3>().setIdentity();
    all.block<3, 3>(0, 3) = -cross_matrix(poses_[i].sample.position_mm - middle_mm_);
    if (row.off.size() == 6) all.block<3, 3>(3, 3).setIdentity();
    const std::size_t target = poses_[i].target;
    all.block(0, moved_[1 + target].first, row.off.size(), 3) =
        row.by_parameter.middleCols<3>(fit_.model.chain_parameters().target(target));
    all.rightCols(row.by_joint.cols()) = row.by_joint;
    return all;
  }

  [[nodiscard]] StepScore score_of(const StandRows& stand) const {
    MatrixXd all(stand.off.size(), columns());
    Index at = 0;
    for (const std::size_t i : stand.poses) {
      all.middleRows(at, fit_.rows[i].off.size()) = columns_of(i);
      at += fit_.rows[i].off.size();
    }
    stand.root.matrixL().solveInPlace(all);
    StepScore score = none();
    score.own = all.transpose() * all / fit_.widened;
    score.common(Eigen::all, stand.parameters) =
        all.transpose() * stand.columns.transpose() / fit_.widened;
    score.gradient = all.transpose() * stand.off / fit_.widened;
    return score;
  }

  [[nodiscard]] std::optional<Solved> solved(const StepScore& score, const MovedPart& moved) const {
    const MatrixXd own = score.own.block(moved.first, moved.first, moved.count, moved.count);
    const MatrixXd common = score.common.middleRows(moved.first, moved.count);
    const VectorXd scale = own.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const MatrixXd left = scale.asDiagonal() *
                          (own - common * fit_.covariance * common.transpose()) *
                          scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (left + left.transpose()));
    if (!(eigen.eigenvalues()(0) > kStepShare)) return std::nullopt;
    Solved found;
    found.covariance = scale.asDiagonal() * eigen.eigenvectors() *
                       eigen.eigenvalues().cwiseInverse().asDiagonal() *
                       eigen.eigenvectors().transpose() * scale.asDiagonal();
    const VectorXd gradient = score.gradient.segment(moved.first, moved.count);
    found.by = found.covariance * gradient;
    found.square = gradient.dot(found.by);
    found.common = common;
    return found;
  }

  [[nodiscard]] double moved_mm(const MovedPart& moved, const Solved& found,
                                std::size_t from) const {
    double square = 0, by_noise = 0, count = 0;
    for (std::size_t i = from_[from]; i < poses_.size(); ++i) {
      if (moved.of == PoseStep::Of::target && poses_[i].target != moved.which) continue;
      const MatrixXd columns = columns_of(i).topRows<3>().middleCols(moved.first, moved.count);
      square += (columns * found.by).squaredNorm();
      by_noise += (columns * found.covariance * columns.transpose()).trace();
      ++count;
    }
    return count > 0 ? std::sqrt(std::max(0.0, square - by_noise) / count) : 0;
  }

  /// The largest chi-square of the same that moves on smoothly.
  [[nodiscard]] double drifting(const MovedPart& moved) const {
    double largest = 0;
    for (const auto& motion : smooth_motions()) {
      StepScore all = none();
      for (std::size_t k = 0; k < scores_.size(); ++k)
        all.add(scores_[k],
                motion(static_cast<double>(k) / static_cast<double>(scores_.size() - 1)));
      if (const auto found = solved(all, moved)) largest = std::max(largest, found->square);
    }
    return largest;
  }

  const PoseFit& fit_;
  const std::vector<Pose>& poses_;
  Vector3d middle_mm_ = Vector3d::Zero();
  std::vector<MovedPart> moved_;
  std::vector<std::size_t> from_;  ///< the first pose of each stand that counts
  std::vector<StepScore> scores_;  ///< of each
};

}  // namespace

PoseStep step_in(const PoseFit& fit, const std::vector<Pose>& poses) {
  if (!fit.converged || poses.empty()) return {};
  return StepSearch(fit, poses).largest();
}

}  // namespace identify
