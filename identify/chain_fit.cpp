#include "identify/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

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
  explicit NormalEquations(Index count)
      : normal(MatrixXd::Zero(count, count)), gradient(VectorXd::Zero(count)) {}
  MatrixXd normal;  // lower half
  VectorXd gradient;
  double cost = 0;
};

/// Gathers rows of J and J W of samples with the same active parameters, so that the products run
/// over long rows.
template <int Size>
class Rows {
 public:
  /// The parameters to come: `active` rises, the others' columns of the Jacobian are zero.
  void activate(std::vector<Index> active, NormalEquations& equations) {
    flush(equations);
    active_ = std::move(active);
    rows_.resize(count(), kMost);
    weighted_.resize(count(), kMost);
  }

  void add(const Eigen::Matrix<double, 6, Eigen::Dynamic>& columns,
           const Eigen::Matrix<double, Size, Size>& weight,
           const Eigen::Matrix<double, Size, 1>& error, NormalEquations& equations) {
    if (filled_ == kMost) flush(equations);
    for (Index a = 0; a < count(); ++a) {
      const auto column = columns.col(active_[static_cast<std::size_t>(a)]).template head<Size>();
      rows_.row(a).template segment<Size>(filled_) = column.transpose();
      weighted_.row(a).template segment<Size>(filled_) = (weight * column).transpose();
    }
    errors_.template segment<Size>(filled_) = error;
    filled_ += Size;
  }

  void flush(NormalEquations& equations) {
    if (filled_ == 0) return;
    const auto weighted = weighted_.leftCols(filled_);
    MatrixXd normal = MatrixXd::Zero(count(), count());
    normal.triangularView<Eigen::Lower>() = weighted * rows_.leftCols(filled_).transpose();
    const VectorXd gradient = weighted * errors_.head(filled_);
    for (Index a = 0; a < count(); ++a) {
      const Index at = active_[static_cast<std::size_t>(a)];
      equations.gradient(at) += gradient(a);
      for (Index b = 0; b <= a; ++b)
        equations.normal(at, active_[static_cast<std::size_t>(b)]) += normal(a, b);
    }
    filled_ = 0;
  }

 private:
  static constexpr Index kMost = 64 * Size;
  [[nodiscard]] Index count() const { return static_cast<Index>(active_.size()); }

  std::vector<Index> active_;
  MatrixXd rows_;
  MatrixXd weighted_;
  Eigen::Matrix<double, kMost, 1> errors_;
  Index filled_ = 0;
};

template <int Size>
class Problem {
 public:
  /// The weights are those of `chain`, and stay: what is minimised must not move.
  Problem(const Chain& chain, std::vector<ChainObservation>& samples, const ChainNoise& noise)
      : samples_(samples), noise_(noise), weights_(samples.size()), swept_(samples.size()) {
    ChainPose pose(chain);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      pose.set(samples_[i].target, samples_[i].turns, false);
      weights_[i] = ChainResidual<Size>::base_weight(chain, samples_[i], noise, pose);
      swept_[i] = samples_[i].turns[samples_[i].joint];
    }
  }

  /// The free angles go along to where the last linearisation put them.
  void follow() {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      samples_[i].turns[samples_[i].joint] = swept_[i];
  }

  NormalEquations linearised(const Chain& chain) {
    const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
    NormalEquations equations(parameters.count(Size == 6));
    ChainPose pose(chain);
    std::optional<Active> active;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const ChainObservation& sample = samples_[i];
      if (sample.weight == 0 && !free(sample)) continue;
      pose.set(sample.target, sample.turns, true);
      residual_.set(chain, sample, pose, weights_[i], free(sample));
      if (free(sample)) {
        swept_[i] = sample.turns[sample.joint] + residual_.toward;
        // Along the tangent is along the circle, unless it is far.
        constexpr double kBend = 1e-10;  // standard deviations
        if (residual_.toward * residual_.toward > kBend * residual_.toward_sigma) {
          Turns turns = sample.turns;
          turns[sample.joint] = swept_[i];
          pose.set(sample.target, turns, true);
          residual_.set(chain, sample, pose, weights_[i], true);
        }
      }
      equations.cost += sample.weight * residual_.squared() / 2;
      if (const Active now{turned(sample), sample.target}; active != now) {
        active = now;
        rows_.activate(columns(parameters, now), equations);
      }
      rows_.add(pose.by_parameter, sample.weight * residual_.weight, residual_.error, equations);
    }
    rows_.flush(equations);
    return equations;
  }

 private:
  /// What a sample depends on: joints that did not turn change nothing.
  struct Active {
    unsigned joints;  ///< a bit each
    std::size_t target;
    bool operator==(const Active&) const = default;
  };
  static unsigned turned(const ChainObservation& sample) {
    unsigned joints = 1u << sample.joint;
    for (std::size_t j = 0; j < kMostJoints; ++j)
      if (sample.turns[j] != 0) joints |= 1u << j;
    return joints;
  }
  static std::vector<Index> columns(const ChainParameters& parameters, const Active& active) {
    std::vector<Index> found;
    const auto add = [&](Index from, Index count) {
      for (Index k = 0; k < count; ++k) found.push_back(from + k);
    };
    for (std::size_t j = 0; j < parameters.joints; ++j)
      if ((active.joints >> j & 1u) != 0) add(parameters.axis(j), 4);
    add(parameters.target(active.target), 3);
    if constexpr (Size == 6) add(parameters.tool(), 3);
    return found;
  }

  [[nodiscard]] bool free(const ChainObservation& sample) const {
    return std::isinf(noise_.swept_rad[sample.joint]);
  }

  std::vector<ChainObservation>& samples_;
  const ChainNoise& noise_;
  std::vector<typename ChainResidual<Size>::Square> weights_;
  std::vector<double> swept_;  ///< turns of the sweeping joints
  Rows<Size> rows_;
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
  summary.ending = "no convergence";
  double previous = std::numeric_limits<double>::infinity();
  double damping = 0;
  NormalEquations equations = problem.linearised(result.chain);
  while (true) {
    problem.follow();
    const Information information(equations.normal);
    const VectorXd step = information.step(equations.gradient, 0);
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
    const auto better = [&](const NormalEquations& there) {
      return there.cost <= equations.cost || (close && std::isfinite(there.cost));
    };
    Chain next = moved(result.chain, information.step(equations.gradient, damping));
    NormalEquations there = problem.linearised(next);
    while (!better(there) && damping < kMostDamping) {
      damping = std::max(kFirstDamping, 10 * damping);
      next = moved(result.chain, information.step(equations.gradient, damping));
      there = problem.linearised(next);
    }
    if (damping >= kMostDamping) {
      summary.ending = "no better place found";
      break;
    }
    damping = damping > kFirstDamping ? damping / 10 : 0;
    result.chain = std::move(next);
    equations = std::move(there);
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
