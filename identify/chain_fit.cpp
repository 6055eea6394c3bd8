#include "identify/chain_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A step this small in standard uncertainties is none.
constexpr double kSmallStep = 1e-7;
constexpr double kCloseStep = 1e-3;
/// Eigenvalues of the normal matrix, scaled to a unit diagonal, below this carry no information.
constexpr double kNoInformation = 1e-9;

/// The normal equations N x = g of one linearisation.
struct NormalEquations {
  MatrixXd normal;
  VectorXd gradient;
  double cost = 0;
};

template <int Size>
class Problem {
 public:
  /// The weights are those of `chain`, and stay: what is minimised must not move. `shape`: effects
  /// that are zero there get no columns.
  Problem(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise, const ChainEffects& shape)
      : nodes_(nodes),
        noise_(noise),
        shape_(shape),
        columns_(shape, nodes),
        variances_(variances_of(shape, nodes, columns_)),
        weights_(nodes.observations.size()),
        swept_(nodes.observations.size()),
        ranges_(nodes.home_of.size()) {
    ChainPose pose(chain);
    for (std::size_t i = 0; i < nodes_.observations.size(); ++i) {
      const ChainObservation& seen = nodes_.observations[i];
      pose.set(seen.target, turns_of(chain, seen, noise), false);
      weights_[i] = ChainResidual<Size>::base_weight(chain, seen, noise, pose);
      swept_[i] = seen.turns[seen.joint];
    }
    for (std::size_t u = 0; u < nodes.units.size(); ++u)
      for (const std::size_t s : nodes.units[u])
        for (std::size_t n = 0; n < nodes.strokes[s].nodes.size(); ++n) {
          Range& range = ranges_[nodes.group[u]];
          range.from = std::min(range.from, swept_[nodes.first[s] + n]);
          range.to = std::max(range.to, swept_[nodes.first[s] + n]);
        }
  }

  /// Of the chain's parameters; behind them, where they are estimated, one a joint for where its
  /// angle is zero.
  [[nodiscard]] static Index count(const Chain& chain) {
    return ChainParameters{chain.axes.size(), chain.targets_mm.size()}.count(Size == 6);
  }
  [[nodiscard]] Index with_zeros(const Chain& chain) const {
    return count(chain) + static_cast<Index>(shape_.zero_rad.size());
  }

  /// The free angles go along to where the last linearisation put them.
  void follow() {
    for (std::size_t i = 0; i < swept_.size(); ++i)
      nodes_.observations[i].turns[nodes_.observations[i].joint] = swept_[i];
  }

  NormalEquations linearised(const Chain& chain) {
    const auto all = eliminate(products(chain), nodes_.home_of, variances_, with_zeros(chain));
    NormalEquations equations{all.normal, all.gradient, all.squares / 2};
    const VectorXd known = prior(chain);
    equations.normal.diagonal() += known;
    for (std::size_t j = 0; j < chain.zero_rad.size(); ++j) {
      const Index at = count(chain) + static_cast<Index>(j);
      const double zero = chain.zero_rad[j];
      equations.gradient(at) -= known(at) * zero;
      equations.cost += known(at) * zero * zero / 2;
    }
    return equations;
  }

  /// What is known of each parameter beforehand: one over its variance.
  [[nodiscard]] VectorXd prior(const Chain& chain) const {
    VectorXd known = VectorXd::Zero(with_zeros(chain));
    for (std::size_t j = 0; j < shape_.zero_rad.size(); ++j)
      if (shape_.zero_rad[j] > 0)
        known(count(chain) + static_cast<Index>(j)) = 1 / (shape_.zero_rad[j] * shape_.zero_rad[j]);
    return known;
  }

  std::vector<StrokeProducts> products(const Chain& chain) {
    std::vector<StrokeProducts> found;
    ChainPose pose(chain);
    for (std::size_t u = 0; u < nodes_.units.size(); ++u) found.push_back(unit(chain, u, pose));
    return found;
  }

 private:
  struct Range {
    double from = std::numeric_limits<double>::infinity();
    double to = -std::numeric_limits<double>::infinity();
    /// From -1 to 1.
    [[nodiscard]] double place(double turn) const {
      return to > from ? std::clamp((2 * turn - from - to) / (to - from), -1.0, 1.0) : 0;
    }
  };

  StrokeProducts unit(const Chain& chain, std::size_t u, ChainPose& pose) {
    StrokeProducts result;
    result.group = nodes_.group[u];
    result.parameters = active(chain, nodes_.units[u]);
    Index nodes = 0;
    for (const std::size_t s : nodes_.units[u])
      nodes += static_cast<Index>(nodes_.strokes[s].nodes.size());
    const auto parameters = static_cast<Index>(result.parameters.size());
    const Index shared = columns_.own;
    const Index at_home = shared + columns_.shared();
    const Index first = at_home + columns_.home;
    const Index last = first + parameters;
    rows_.setZero(last + 1, Size * nodes);
    weighted_.resize(last + 1, Size * nodes);
    const Range& range = ranges_[result.group];
    Index column = 0;
    for (const std::size_t s : nodes_.units[u]) {
      const StrokeMoments& stroke = nodes_.strokes[s];
      for (std::size_t n = 0; n < stroke.nodes.size(); ++n, column += Size) {
        const std::size_t i = nodes_.first[s] + n;
        const ChainObservation& seen = nodes_.observations[i];
        settle(chain, i, pose);
        auto block = rows_.template middleCols<Size>(column);
        for (std::size_t k = 0; k < chain.axes.size(); ++k) {
          if (k == seen.joint || !nodes_.known[k]) continue;
          const auto row = static_cast<Index>(k);
          const auto turned = pose.by_turn[k].template head<Size>().transpose();
          if (columns_.own > 0) block.row(row) = turned;
          if (columns_.home > 0) block.row(at_home + row) = turned;
        }
        if (columns_.own > 0) {
          block.template middleRows<3>(shared - 6).template leftCols<3>().setIdentity();
          const Range own{stroke.from_rad, stroke.to_rad};
          block.template middleRows<3>(shared - 3)
              .template leftCols<3>()
              .diagonal()
              .setConstant(own.place(stroke.nodes[n].turn_rad));
        }
        const auto here = polynomials(range.place(seen.turns[seen.joint]));
        if (columns_.figure > 0) {
          // Radial and axial, nothing where the joint stands at its home's turn.
          const auto home =
              polynomials(range.place(nodes_.homes[nodes_.home_of[result.group]][seen.joint]));
          const Vector3d from = seen.position_mm - stroke.circle.center_mm;
          const Vector3d& axial = stroke.circle.normal;
          const Vector3d radial = (from - axial.dot(from) * axial).normalized();
          const Index at = shared + columns_.figure * static_cast<Index>(seen.target);
          for (Index m = 0; m < kFigureOrders; ++m) {
            const double value = here(m + 1) - home(m + 1);
            block.row(at + m).template head<3>() = value * radial.transpose();
            block.row(at + kFigureOrders + m).template head<3>() = value * axial.transpose();
          }
        }
        if (columns_.told > 0 && !free(seen))
          block.middleRows(at_home - columns_.told, columns_.told) =
              here.template head<kFigureOrders>() * residual_.by_swept.transpose();
        for (Index a = 0; a < parameters; ++a) {
          const Index at = result.parameters[static_cast<std::size_t>(a)];
          auto row = block.row(first + a);
          if (of_another_target(chain, at, seen.target)) continue;
          if (at < count(chain))
            row = pose.by_parameter.col(at).template head<Size>().transpose();
          else
            row = residual_.by_swept.transpose();
        }
        block.row(last) = residual_.error.transpose();
        weighted_.template middleCols<Size>(column).noalias() =
            block * (seen.weight / stroke.correlation * residual_.weight);
      }
    }
    result.products.noalias() = weighted_ * rows_.transpose();
    return result;
  }

  /// The residual at a node, a free angle where it fits best.
  void settle(const Chain& chain, std::size_t i, ChainPose& pose) {
    const ChainObservation& seen = nodes_.observations[i];
    pose.set(seen.target, turns_of(chain, seen, noise_), true);
    residual_.set(chain, seen, pose, weights_[i], free(seen));
    if (!free(seen)) return;
    swept_[i] = seen.turns[seen.joint] + residual_.toward;
    // Along the tangent is along the circle, unless it is far.
    constexpr double kBend = 1e-10;  // standard deviations
    if (residual_.toward * residual_.toward <= kBend * residual_.toward_sigma) return;
    Turns turns = seen.turns;
    turns[seen.joint] = swept_[i];
    pose.set(seen.target, turns, true);
    residual_.set(chain, seen, pose, weights_[i], true);
  }

  [[nodiscard]] static bool of_another_target(const Chain& chain, Index parameter,
                                              std::size_t target) {
    const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
    return parameter >= parameters.target(0) && parameter < parameters.tool() &&
           (parameter - parameters.target(0)) / 3 != static_cast<Index>(target);
  }

  using Orders = Eigen::Matrix<double, kFigureOrders + 1, 1>;
  /// Chebyshev polynomials.
  static Orders polynomials(double x) {
    Orders values;
    double before = x, value = 1;
    for (double& order : values) {
      order = value;
      before = std::exchange(value, 2 * x * value - before);
    }
    return values;
  }

  /// What a unit depends on: joints that did not turn change nothing.
  std::vector<Index> active(const Chain& chain, const std::vector<std::size_t>& strokes) const {
    const ChainParameters parameters{chain.axes.size(), chain.targets_mm.size()};
    std::set<Index> found;
    const auto add = [&](Index from, Index count) {
      for (Index k = 0; k < count; ++k) found.insert(from + k);
    };
    for (const std::size_t s : strokes) {
      const std::size_t begin = nodes_.first[s];
      const std::size_t end = begin + nodes_.strokes[s].nodes.size();
      const ChainObservation& first = nodes_.observations[begin];
      for (std::size_t j = 0; j < parameters.joints; ++j) {
        bool turned = j == first.joint;
        for (std::size_t i = begin; i < end && !turned; ++i)
          turned = nodes_.observations[i].turns[j] != 0;
        if (turned) add(parameters.axis(j), 4);
      }
      add(parameters.target(first.target), 3);
      if constexpr (Size == 6) add(parameters.tool(), 3);
      if (!shape_.zero_rad.empty() && shape_.zero_rad[first.joint] > 0 && !free(first))
        add(count(chain) + static_cast<Index>(first.joint), 1);
    }
    return {found.begin(), found.end()};
  }

  [[nodiscard]] bool free(const ChainObservation& seen) const {
    return std::isinf(noise_.swept_rad[seen.joint]);
  }

  ChainNodes& nodes_;
  const ChainNoise& noise_;
  const ChainEffects& shape_;
  EffectColumns columns_;
  EffectVariances variances_;
  std::vector<typename ChainResidual<Size>::Square> weights_;
  std::vector<double> swept_;  ///< turns of the sweeping joints
  std::vector<Range> ranges_;  // of each group's turns
  MatrixXd rows_;              ///< transposed: one column a row of the model
  MatrixXd weighted_;
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

  /// Of the scaled-back matrix, over what has information.
  [[nodiscard]] double log_determinant() const {
    double sum = 0;
    for (Index i = 0; i < values_.size(); ++i) {
      if (informed(i)) sum += std::log(values_(i));
      if (scale_(i) > 0) sum -= 2 * std::log(scale_(i));
    }
    return sum;
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
ChainFit fit(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
             const ChainEffects& effects, int most_iterations) {
  Problem<Size> problem(start, nodes, noise, effects);
  ChainFit result;
  result.chain = start;
  result.chain.zero_rad.resize(effects.zero_rad.size());
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
    const auto after = [&](const VectorXd& change) {
      Chain there = moved(result.chain, change.head(Problem<Size>::count(result.chain)));
      for (std::size_t j = 0; j < there.zero_rad.size(); ++j)
        there.zero_rad[j] += change(Problem<Size>::count(result.chain) + static_cast<Index>(j));
      return there;
    };
    Chain next = after(information.step(equations.gradient, damping));
    NormalEquations there = problem.linearised(next);
    while (!better(there) && damping < kMostDamping) {
      damping = std::max(kFirstDamping, 10 * damping);
      next = after(information.step(equations.gradient, damping));
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

ChainFit fit_chain(const Chain& start, ChainNodes& nodes, const ChainNoise& noise,
                   const ChainEffects& effects, bool with_orientation, int most_iterations) {
  return with_orientation ? fit<6>(start, nodes, noise, effects, most_iterations)
                          : fit<3>(start, nodes, noise, effects, most_iterations);
}

LinearisedChain::LinearisedChain(const Chain& chain, ChainNodes& nodes, const ChainNoise& noise,
                                 const ChainEffects& shape, bool with_orientation)
    : nodes_(nodes), shape_(shape), columns_(shape, nodes) {
  const auto set = [&](auto&& problem) {
    strokes_ = problem.products(chain);
    prior_ = problem.prior(chain);
  };
  if (with_orientation)
    set(Problem<6>(chain, nodes, noise, shape));
  else
    set(Problem<3>(chain, nodes, noise, shape));
}

double LinearisedChain::deviance(const ChainEffects& effects) const {
  const auto all =
      eliminate(strokes_, nodes_.home_of, variances_of(effects, nodes_, columns_), prior_.size());
  // By Cholesky's factors where all is determined, which is many times faster.
  const VectorXd scale = all.normal.diagonal().cwiseSqrt().cwiseInverse();
  if (scale.allFinite()) {
    const Eigen::LLT<MatrixXd> factors(scale.asDiagonal() * all.normal * scale.asDiagonal());
    const VectorXd pivots = factors.matrixLLT().diagonal();
    if (factors.info() == Eigen::Success && pivots.minCoeff() > std::sqrt(kNoInformation)) {
      const VectorXd side = factors.matrixL().solve(scale.cwiseProduct(all.gradient));
      return all.log_determinant + 2 * (pivots.array() / scale.array()).log().sum() + all.squares -
             side.squaredNorm();
    }
  }
  const Information information(all.normal);
  const VectorXd step = information.step(all.gradient, 0);
  return all.log_determinant + information.log_determinant() + all.squares - step.dot(all.gradient);
}

std::vector<ChainEstimate::Part> LinearisedChain::parts() const {
  const EffectVariances all = variances_of(shape_, nodes_, columns_);
  const auto normal_at = [&](const EffectVariances& variances) -> MatrixXd {
    return eliminate(strokes_, nodes_.home_of, variances, prior_.size()).normal;
  };
  MatrixXd normal = normal_at(all);
  normal.diagonal() += prior_;
  const MatrixXd covariance = Information(normal).covariance();
  std::vector<ChainEstimate::Part> found;
  MatrixXd left = covariance;
  const auto add = [&](Cause cause, const MatrixXd& information) {
    found.push_back({cause, covariance * information * covariance});
    left -= found.back().covariance;
  };
  ChainEffects home, drift, figure, offset, print;
  home.home_rad = shape_.home_rad;
  drift.drift_mm = shape_.drift_mm;
  figure.figure_mm = shape_.figure_mm;
  offset.offset_rad = shape_.offset_rad;
  print.print_mm = shape_.print_mm;
  print.told_rad = shape_.told_rad;
  for (const auto& [cause, effect] : {std::pair<Cause, const ChainEffects&>(Cause::home, home),
                                      {Cause::drift, drift},
                                      {Cause::figure, figure},
                                      {Cause::offset, offset},
                                      {Cause::print, print}}) {
    // The effect's variances V add K V K^T to the covariance, K = N^-1 X^T V^-1: which is
    // -N^-1 dN/ds N^-1 where V grows by s.
    constexpr double kStep = 1e-3;
    const EffectVariances own = variances_of(effect, nodes_, columns_);
    const auto changed = [&](double by) {
      EffectVariances variances = all;
      for (std::size_t s = 0; s < all.own.size(); ++s) variances.own[s] += by * own.own[s];
      for (std::size_t g = 0; g < all.shared.size(); ++g) variances.shared[g] += by * own.shared[g];
      for (std::size_t h = 0; h < all.home.size(); ++h) variances.home[h] += by * own.home[h];
      return normal_at(variances);
    };
    MatrixXd information = (changed(-kStep) - changed(kStep)) / (2 * kStep);
    if (cause == Cause::print) information.diagonal() += prior_;
    if (!information.isZero(0)) add(cause, information);
  }
  found.push_back({Cause::noise, left});
  std::rotate(found.begin(), found.end() - 1, found.end());
  return found;
}

}  // namespace identify
