#include "identify/poses/pose_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "identify/geometry/information.hpp"
#include "identify/geometry/line.hpp"
#include "identify/geometry/median.hpp"
#include "identify/poses/noise_sizes.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMostSteps = 30;
constexpr int kNoiseSteps = 12;
/// A step that moves no parameter by more than this share of its standard uncertainty is the last.
constexpr double kLastStep = 1e-2;
constexpr double kNoiseSettled = 2e-3;
/// A micrometre at two metres.
constexpr double kNoGears_rad = 5e-7;

/// 1 up to kWholeWeight, 0 from kNoWeight on, and smooth between.
double weight_at(double sigmas) {
  if (sigmas <= kWholeWeight) return 1;
  if (sigmas >= kNoWeight) return 0;
  const double share = (sigmas - kWholeWeight) / (kNoWeight - kWholeWeight);
  return (1 - share * share) * (1 - share * share);
}

class Problem {
 public:
  Problem(PoseFit& fit, const std::vector<Pose>& poses, const std::optional<ChainPrior>& prior)
      : fit_(fit), poses_(poses), prior_(prior), start_(fit.noise) {}

  void linearise() {
    fit_.rows.clear();
    for (const Pose& pose : poses_)
      fit_.rows.push_back(pose_row(fit_.model, pose, fit_.with_orientation));
    step_ = VectorXd::Zero(fit_.model.parameters());
  }

  /// Half of the poses are no outliers of the start: the first step follows none of the others.
  void begin() {
    linearise();
    weigh();
  }

  /// The step to the least weighted sum of squares, and the noise that belongs to it.
  void settle() {
    for (int round = 0; round < kNoiseSteps; ++round) {
      solve();
      const PoseNoise before = fit_.noise;
      weigh();
      size_noise();
      const auto still = [](double was, double is) {
        return std::abs(is - was) <= kNoiseSettled * was;
      };
      const auto fades = [&](double was, double is) { return still(was, is) || is < kNoGears_rad; };
      if (still(before.position_mm, fit_.noise.position_mm) &&
          still(before.orientation_rad, fit_.noise.orientation_rad) &&
          // A share that fades away matters no more.
          (still(before.joint_rad, fit_.noise.joint_rad) || joint_share_ < kNoiseSettled) &&
          fades(before.gears_rad, fit_.noise.gears_rad) &&
          fades(before.weights_rad, fit_.noise.weights_rad) &&
          fades(before.play_rad, fit_.noise.play_rad))
        break;
    }
    solve();
  }

  /// The covariance as it is here.
  void state() {
    linearise();
    solve();
  }

  /// See the header.
  double deviance() {
    linearise();
    double sum = Information(equations().normal).log_determinant();
    for (const StandRows& stand : white_)
      sum += 2 * stand.root.matrixLLT().diagonal().array().log().sum() + stand.off.squaredNorm();
    if (prior_) {
      const VectorXd change = change_between(fit_.model.chain, prior_->chain);
      sum += change.dot(prior_->information * change);
    }
    each_random([&](double size, double sigma) {
      sum += 2 * std::log(sigma) + size * size / (sigma * sigma);
    });
    return sum;
  }

  /// Once the fit has come to its end: see widen() in the header.
  void widen() {
    constexpr double kMost = 3;
    state();
    double free = 0;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      free += fit_.weights(static_cast<Index>(i)) * static_cast<double>(fit_.rows[i].off.size());
    for (const StandRows& stand : white_) free -= stand.taken_up(fit_.covariance).trace();
    double lost = fit_.with_orientation ? 6 : 4;
    for (const double size : {fit_.noise.gears_rad, fit_.noise.weights_rad, fit_.noise.play_rad})
      if (size > kNoGears_rad) lost += 2;
    fit_.widened = free > lost ? std::min(kMost, free / (free - lost)) : kMost;
    solve();
    fit_.condition = information_->condition();
  }

  /// Takes the step; returns its largest share of a standard uncertainty. Random sizes do not
  /// count: where they fade away, they and what is known of them do so together, and never end.
  double take() {
    const VectorXd sigma = fit_.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    double largest = 0;
    for (Index i = 0; i < fit_.model.fixed_parameters(); ++i)
      if (sigma(i) > 0) largest = std::max(largest, std::abs(step_(i)) / sigma(i));
    fit_.model = moved(fit_.model, step_);
    return largest;
  }

 private:
  struct Equations {
    MatrixXd normal;  // its lower triangle
    VectorXd gradient;
  };

  Equations equations() {
    white_ = fit_.counted();
    const Index parameters = fit_.model.parameters();
    Equations all{MatrixXd::Zero(parameters, parameters), VectorXd::Zero(parameters)};
    for (const StandRows& stand : white_) {
      const MatrixXd own = stand.columns * stand.columns.transpose() / fit_.widened;
      for (Index c = 0; c < own.cols(); ++c) {  // parameters are in their order
        double* const column = all.normal.col(stand.parameters[static_cast<std::size_t>(c)]).data();
        for (Index r = c; r < own.rows(); ++r)
          column[stand.parameters[static_cast<std::size_t>(r)]] += own(r, c);
      }
      all.gradient(stand.parameters) += stand.columns * stand.off / fit_.widened;
    }
    if (prior_) {
      const Index count = prior_->information.rows();
      all.normal.topLeftCorner(count, count).triangularView<Eigen::Lower>() += prior_->information;
      all.gradient.head(count) +=
          prior_->information * change_between(fit_.model.chain, prior_->chain);
    }
    Index at = fit_.model.chain_parameters().count(true);
    each_random([&](double size, double sigma) {
      all.normal(at, at) += 1 / (sigma * sigma);
      all.gradient(at++) -= size / (sigma * sigma);
    });
    return all;
  }

  void solve() {
    const Equations all = equations();
    solve(all.normal.selfadjointView<Eigen::Lower>(), all.gradient);
  }

  /// Calls for the size of each effect and place, with what it was known by beforehand.
  template <typename Take>
  void each_random(const Take& take) const {
    for (const JointEffect& effect : fit_.model.effects)
      for (Index k = 0; k < effect.count(); ++k)
        take(effect.size(k), fit_.known_beforehand(effect));
    for (const JointPlace& place : fit_.model.places)
      take(place.off_rad, fit_.known_beforehand(place));
  }

  /// Places are known beforehand: they are eliminated, and what information there is shows in the
  /// other parameters.
  void solve(const MatrixXd& normal, const VectorXd& gradient) {
    const Index lasting = fit_.model.lasting_parameters(), places = gradient.size() - lasting;
    MatrixXd own = MatrixXd::Identity(places, places);  // their covariance, all else known
    if (places > 0) normal.bottomRightCorner(places, places).llt().solveInPlace(own);
    const MatrixXd by_lasting = own * normal.bottomLeftCorner(places, lasting);
    const MatrixXd left = normal.topLeftCorner(lasting, lasting) -
                          normal.topRightCorner(lasting, places) * by_lasting;
    const Information& information = information_.emplace(left);
    const auto whole = [&](const MatrixXd& of_lasting) {
      MatrixXd all(gradient.size(), of_lasting.cols());
      all << of_lasting, -by_lasting * of_lasting;
      return all;
    };
    step_ = whole(information.step(
        gradient.head(lasting) - by_lasting.transpose() * gradient.tail(places), 0));
    step_.tail(places) += own * gradient.tail(places);
    fit_.covariance = whole(whole(information.covariance()).transpose());
    fit_.covariance.bottomRightCorner(places, places) += own;
    fit_.open = whole(information.open());
  }

  /// Half of the poses are no outliers: where a step led them astray, the noise is made to fit.
  void weigh() {
    constexpr double kMostUsual = 4;  // of three normal numbers the median is 1.5
    std::vector<double> sigmas;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const PoseRow& row = fit_.rows[i];
      sigmas.push_back(sigmas_of(fit_.noise, row, row.off - row.by_parameter * step_));
    }
    const double times = std::max(1.0, median_of(sigmas) / kMostUsual);
    fit_.noise.position_mm *= times;
    fit_.noise.orientation_rad *= times;
    fit_.noise.joint_rad *= times;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      fit_.weights(static_cast<Index>(i)) = weight_at(sigmas[i] / times);
  }

  /// Each component times the root of what is seen of it over what is expected.
  void size_noise() {
    white_ = fit_.counted();
    NoiseSizes sizes(fit_, white_, step_);
    if (start_.gears_rad > 0) sizes.hold(start_);
    joint_share_ = sizes.joint_share();
    fit_.noise = sizes.next();
  }

  PoseFit& fit_;
  const std::vector<Pose>& poses_;
  const std::optional<ChainPrior>& prior_;
  const PoseNoise start_;
  std::vector<StandRows> white_;
  std::optional<Information> information_;  ///< of lasting parameters, as last solved
  VectorXd step_;
  double joint_share_ = 1;
};

}  // namespace

std::vector<StandRows> PoseFit::counted() const {
  std::vector<StandRows> all;
  for (const Stand& stand : stands) {
    all.emplace_back(noise, rows, weights, stand);
    if (all.back().poses.empty()) all.pop_back();
  }
  return all;
}

double PoseFit::sigmas_off(std::size_t pose) const {
  return sigmas_of(noise, rows[pose], rows[pose].off);
}

PoseFit fitted(const PoseModel& start, const PoseNoise& noise, const std::vector<Pose>& poses,
               bool with_orientation, const std::optional<ChainPrior>& prior) {
  PoseFit fit;
  fit.model = start;
  fit.noise = noise;
  fit.with_orientation = with_orientation;
  fit.weights = VectorXd::Ones(static_cast<Index>(poses.size()));
  fit.stands = stands_of(poses);
  Problem problem(fit, poses, prior);
  problem.begin();
  while (fit.iterations < kMostSteps && !fit.converged) {
    ++fit.iterations;
    problem.linearise();
    problem.settle();
    // Where no pose is left that counts, the fit went astray.
    fit.converged = problem.take() < kLastStep && fit.weights.sum() > 0;
  }
  problem.linearise();
  return fit;
}

void widen(PoseFit& fit, const std::vector<Pose>& poses, const std::optional<ChainPrior>& prior) {
  Problem(fit, poses, prior).widen();
}

double deviance(PoseFit fit, const VectorXd& weights, const std::vector<Pose>& poses,
                const std::optional<ChainPrior>& prior) {
  fit.weights = weights;
  return Problem(fit, poses, prior).deviance();
}

PoseFit with_noise(PoseFit fit, const PoseNoise& noise, const std::vector<Pose>& poses,
                   const std::optional<ChainPrior>& prior) {
  fit.noise = noise;
  Problem(fit, poses, prior).state();
  return fit;
}

}  // namespace identify
