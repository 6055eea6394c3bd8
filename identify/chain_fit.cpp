#include "identify/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A step this small in standard uncertainties is none.
constexpr double kSmallStep = 1e-7;
constexpr double kCloseStep = 1e-3;
/// Eigenvalues of the normal matrix, scaled to a unit diagonal, below this carry no information.
constexpr double kNoInformation = 1e-9;

/// The normal equations N x = g of one linearisation.
struct NormalEquations {
  MatrixXd normal;  // lower half
  VectorXd gradient;
  double cost = 0;
};

template <int Size>
class Problem {
 public:
  /// The weights are those of `chain`, and stay: what is minimised must not move.
  Problem(const Chain& chain, std::vector<ChainObservation>& samples, const ChainNoise& noise)
      : samples_(samples), noise_(noise), weights_(samples.size()), toward_(samples.size()) {
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      pose_.set(chain, samples_[i].target, samples_[i].turns, false);
      weights_[i] = ChainResidual<Size>::base_weight(chain, samples_[i], noise, pose_);
    }
  }

  /// Half the weighted sum of squares at `chain`; remembers where the free angles want to go.
  double cost(const Chain& chain) {
    double sum = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      pose_.set(chain, samples_[i].target, samples_[i].turns, false);
      residual_.set(chain, samples_[i], pose_, weights_[i], free(samples_[i]));
      toward_[i] = residual_.toward;
      sum += samples_[i].weight * residual_.squared();
    }
    return sum / 2;
  }

  /// The free angles go where the last evaluation wants them.
  void follow() {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      if (free(samples_[i])) samples_[i].turns[samples_[i].joint] += toward_[i];
  }

  NormalEquations linearised(const Chain& chain) {
    const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
    const Index count = parameters.count(Size == 6);
    const Index shared = parameters.target(0);
    NormalEquations equations{MatrixXd::Zero(count, count), VectorXd::Zero(count), 0};
    // Rows of J and J W are gathered, so that the products run over long rows.
    constexpr Index kGathered = 64 * Size;
    MatrixXd rows = MatrixXd::Zero(count, kGathered);
    MatrixXd weighted = MatrixXd::Zero(count, kGathered);
    VectorXd errors(kGathered);
    Index filled = 0;
    const auto add = [&] {
      equations.normal.triangularView<Eigen::Lower>() +=
          rows.leftCols(filled) * weighted.leftCols(filled).transpose();
      equations.gradient.noalias() += weighted.leftCols(filled) * errors.head(filled);
      rows.bottomRows(count - shared).setZero();
      weighted.bottomRows(count - shared).setZero();
      filled = 0;
    };
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const ChainObservation& sample = samples_[i];
      if (sample.weight == 0) continue;
      pose_.set(chain, sample.target, sample.turns, true);
      residual_.set(chain, sample, pose_, weights_[i], free(sample));
      equations.cost += sample.weight * residual_.squared() / 2;
      const Eigen::Matrix<double, Size, Size> weight = sample.weight * residual_.weight;
      const auto gather = [&](Index from, const auto& columns) {
        auto place = rows.middleCols<Size>(filled).middleRows(from, columns.cols());
        place = columns.template topRows<Size>().transpose();
        weighted.middleCols<Size>(filled).middleRows(from, columns.cols()) =
            place.lazyProduct(weight);
      };
      gather(0, pose_.by_parameter.leftCols(shared));
      const Index target = parameters.target(sample.target);
      gather(target, pose_.by_parameter.middleCols<3>(target));
      if constexpr (Size == 6) gather(parameters.tool(), pose_.by_parameter.rightCols<3>());
      errors.segment<Size>(filled) = residual_.error;
      filled += Size;
      if (filled == kGathered) add();
    }
    if (filled > 0) add();
    return equations;
  }

 private:
  [[nodiscard]] bool free(const ChainObservation& sample) const {
    return std::isinf(noise_.swept_rad[sample.joint]);
  }

  std::vector<ChainObservation>& samples_;
  const ChainNoise& noise_;
  std::vector<typename ChainResidual<Size>::Square> weights_;
  std::vector<double> toward_;
  ChainPose pose_;
  ChainResidual<Size> residual_;
};

/// A normal matrix, scaled to a unit diagonal, by its eigenvectors.
class Information {
 public:
  explicit Information(const MatrixXd& normal) : scale_(normal.rows()) {
    for (Index i = 0; i < scale_.size(); ++i)
      scale_(i) = normal(i, i) > 0 ? 1 / std::sqrt(normal(i, i)) : 0;
    MatrixXd scaled = normal.selfadjointView<Eigen::Lower>();
    scaled = scale_.asDiagonal() * scaled * scale_.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
    values_ = solver.eigenvalues();
    vectors_ = scale_.asDiagonal() * solver.eigenvectors();
  }

  /// The solution of N x = `gradient`, held back by `damping` (Marquardt 1963); none along
  /// directions without information.
  [[nodiscard]] VectorXd step(const VectorXd& gradient, double damping) const {
    VectorXd along = vectors_.transpose() * gradient;
    for (Index i = 0; i < along.size(); ++i)
      along(i) = informed(i) ? along(i) / (values_(i) + damping) : 0;
    return vectors_ * along;
  }

  [[nodiscard]] MatrixXd covariance() const {
    MatrixXd half = vectors_;
    for (Index i = 0; i < half.cols(); ++i)
      half.col(i) *= informed(i) ? 1 / std::sqrt(values_(i)) : 0;
    MatrixXd whole = MatrixXd::Zero(half.rows(), half.rows());
    whole.selfadjointView<Eigen::Lower>().rankUpdate(half);
    return whole.selfadjointView<Eigen::Lower>();
  }

  [[nodiscard]] double condition() const {
    double smallest = values_(values_.size() - 1);
    for (Index i = values_.size() - 1; i >= 0 && informed(i); --i) smallest = values_(i);
    return values_(values_.size() - 1) / smallest;
  }

  /// Directions without information. Parameters that nothing depends on are no loss.
  [[nodiscard]] std::size_t undetermined() const {
    std::size_t count = 0;
    for (Index i = 0; i < values_.size(); ++i)
      if (!informed(i)) ++count;
    return count - static_cast<std::size_t>((scale_.array() == 0).count());
  }

 private:
  [[nodiscard]] bool informed(Index i) const { return values_(i) > kNoInformation; }

  VectorXd scale_;
  VectorXd values_;   // rising
  MatrixXd vectors_;  // columns, scaled back
};

template <int Size>
ChainFit fit(const Chain& start, std::vector<ChainObservation>& samples, const ChainNoise& noise,
             int most_iterations) {
  Problem<Size> problem(start, samples, noise);
  ChainFit result;
  result.chain = start;
  Summary& summary = result.summary;
  // Free angles first find their place on the chain as it is.
  for (int k = 0; k < 2; ++k) {
    summary.cost = problem.cost(result.chain);
    problem.follow();
  }
  summary.ending = "no convergence";
  double previous = std::numeric_limits<double>::infinity();
  double damping = 0;
  while (true) {
    const NormalEquations equations = problem.linearised(result.chain);
    const Information information(equations.normal);
    VectorXd step = information.step(equations.gradient, 0);
    result.covariance = information.covariance();
    summary.cost = equations.cost;
    summary.condition = information.condition();
    summary.undetermined = information.undetermined();
    summary.last_step = std::sqrt(std::max(0.0, step.dot(equations.gradient)));
    if (!step.allFinite() || !std::isfinite(equations.cost)) {
      summary.ending = "numbers beyond all bounds";
      break;
    }
    if (summary.last_step < kSmallStep) {
      summary.converged = true;
      summary.ending = "converged";
      break;
    }
    // So close to the end the cost is only rounding: the steps alone tell, as long as they shrink.
    const bool close = summary.last_step < kCloseStep;
    if (close && summary.last_step > previous / 2) {
      summary.converged = true;
      summary.ending = "converged to rounding";
      break;
    }
    if (summary.iterations == most_iterations) break;
    previous = summary.last_step;
    ++summary.iterations;
    constexpr double kFirstDamping = 1e-6;
    constexpr double kMostDamping = 1e6;
    const auto better = [&](const Chain& next) {
      const double cost = problem.cost(next);
      return cost <= equations.cost || (close && std::isfinite(cost));
    };
    step = information.step(equations.gradient, damping);
    Chain next = moved(result.chain, step);
    while (!better(next) && damping < kMostDamping) {
      damping = std::max(kFirstDamping, 10 * damping);
      step = information.step(equations.gradient, damping);
      next = moved(result.chain, step);
    }
    if (damping >= kMostDamping) {
      summary.ending = "no better place found";
      break;
    }
    damping = damping > kFirstDamping ? damping / 10 : 0;
    result.chain = std::move(next);
    problem.follow();
  }
  return result;
}

}  // namespace

ChainFit fit_chain(const Chain& start, std::vector<ChainObservation>& samples,
                   const ChainNoise& noise, bool with_orientation, int most_iterations) {
  return with_orientation ? fit<6>(start, samples, noise, most_iterations)
                          : fit<3>(start, samples, noise, most_iterations);
}

}  // namespace identify
