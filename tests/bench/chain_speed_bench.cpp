// How fast the chain is fitted, beside Ceres on the same residuals with automatic derivatives: six
// sweeps of the KR 5 arc, from the robust circles to convergence, both on one thread.
//
//  - angles believed: the position of each sample, weighted by the noise of positions and angles at
//    the start, over all axes and the target;
//  - angles free: the position of each sample, whose angle is unknown too; Ceres eliminates the
//    angles first (DENSE_SCHUR). With the other joints at home only the sweeping axis and the
//    target are its parameters;
//  - circles: the same optimum, with the angles eliminated by hand for Ceres: its residuals are the
//    distances from the circle, (axial, radial).
//
// Ceres' time is that of Solve alone, what does not change from one evaluation to the next is
// computed before. Ours is that of the strokes' moments, for which it needs the samples, and of
// fit_chain on them. Ours gives samples far off less weight, so that the optimum is the same up to
// what a few samples of normal noise change. Costs are those of all samples, by Ceres' residuals.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <ceres/autodiff_cost_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "daemon/text/numbers.hpp"
#include "identify/chain/chain_fit.hpp"
#include "identify/chain/chain_nodes.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/circle/circle_estimator.hpp"
#include "identify/geometry/angle.hpp"
#include "tests/bench/accuracy_campaign.hpp"
#include "tests/bench/table.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace {

using Eigen::Vector3d;
using identify::Chain;
using identify::ChainAxis;
using identify::ChainNoise;
using identify::ChainObservation;

constexpr std::size_t kJoints = 6;
constexpr int kParameters = 4 * kJoints + 3;
constexpr double kMostCostDifference = 1e-6;
constexpr double kMostSigmas = 0.05;
constexpr double kRatioWanted = 20;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// An axis from where it starts, by its four parameters.
template <class T>
struct MovedAxis {
  Vector3<T> direction;
  Vector3<T> point;

  MovedAxis(const ChainAxis& start, const Eigen::Matrix<double, 3, 2>& basis, const T* by) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      direction(k) = by[0] * basis(k, 0) + by[1] * basis(k, 1) + start.direction(k);
      point(k) = by[2] * basis(k, 0) + by[3] * basis(k, 1) + start.point_mm(k);
    }
    direction.normalize();
  }
  template <class S>
  [[nodiscard]] Vector3<T> turned(const Vector3<T>& place, const S& sine, const S& cosine) const {
    const Vector3<T> arm = place - point;
    const Vector3<T> across = direction.cross(arm);
    const T along = direction.dot(arm) * (1.0 - cosine);
    Vector3<T> result;
    for (Eigen::Index k = 0; k < 3; ++k)
      result(k) = point(k) + arm(k) * cosine + across(k) * sine + direction(k) * along;
    return result;
  }
};

template <class T>
Vector3<T> at(const Vector3d& start, const T* by) {
  Vector3<T> place;
  for (Eigen::Index k = 0; k < 3; ++k) place(k) = by[k] + start(k);
  return place;
}

/// Where all start from, shared by the residuals.
struct Start {
  explicit Start(const Chain& at) : chain(at) {
    for (const ChainAxis& axis : chain.axes) bases.push_back(identify::across(axis.direction));
  }
  Chain chain;
  std::vector<Eigen::Matrix<double, 3, 2>> bases;
};

/// Whitened error of the position.
class Believed {
 public:
  Believed(const Start& start, const ChainObservation& seen, const ChainNoise& noise)
      : start_(start), seen_(seen.position_mm) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      sines_[j] = std::sin(seen.turns[j]);
      cosines_[j] = std::cos(seen.turns[j]);
    }
    identify::ChainPose pose(start.chain);
    pose.set(0, seen.turns, false);
    root_ = identify::ChainResidual<3>::base_weight(start.chain, seen, noise, pose).llt().matrixU();
  }

  template <class T>
  bool operator()(const T* j1, const T* j2, const T* j3, const T* j4, const T* j5, const T* j6,
                  const T* target, T* residuals) const {
    const std::array<const T*, kJoints> by{j1, j2, j3, j4, j5, j6};
    Vector3<T> place = at(start_.chain.targets_mm[0], target);
    for (std::size_t j = kJoints; j-- > 0;)
      place = MovedAxis<T>(start_.chain.axes[j], start_.bases[j], by[j])
                  .turned(place, sines_[j], cosines_[j]);
    for (Eigen::Index k = 0; k < 3; ++k) place(k) = seen_(k) - place(k);
    for (Eigen::Index k = 0; k < 3; ++k) {
      residuals[k] = place(2) * root_(k, 2);
      for (Eigen::Index l = k; l < 2; ++l) residuals[k] += place(l) * root_(k, l);
    }
    return true;
  }

 private:
  const Start& start_;
  Vector3d seen_;
  std::array<double, kJoints> sines_{};
  std::array<double, kJoints> cosines_{};
  Eigen::Matrix3d root_;
};

/// Error of the position at an angle that is unknown, in standard deviations.
class Freed {
 public:
  Freed(const Start& start, const ChainObservation& seen, const ChainNoise& noise)
      : axis_(start.chain.axes[seen.joint]),
        basis_(start.bases[seen.joint]),
        target_(start.chain.targets_mm[0]),
        seen_(seen.position_mm),
        certainty_(1 / noise.position_mm) {}

  template <class T>
  bool operator()(const T* angle, const T* by, const T* target, T* residuals) const {
    const Vector3<T> place =
        MovedAxis<T>(axis_, basis_, by).turned(at(target_, target), sin(*angle), cos(*angle));
    for (Eigen::Index k = 0; k < 3; ++k) residuals[k] = (seen_(k) - place(k)) * certainty_;
    return true;
  }

 private:
  ChainAxis axis_;
  Eigen::Matrix<double, 3, 2> basis_;
  Vector3d target_;
  Vector3d seen_;
  double certainty_;
};

/// Axial and radial distance from the circle, in standard deviations.
class OffCircle {
 public:
  OffCircle(const Start& start, const ChainObservation& seen, const ChainNoise& noise)
      : axis_(start.chain.axes[seen.joint]),
        basis_(start.bases[seen.joint]),
        target_(start.chain.targets_mm[0]),
        seen_(seen.position_mm),
        certainty_(1 / noise.position_mm) {}

  template <class T>
  bool operator()(const T* by, const T* target, T* residuals) const {
    const MovedAxis<T> axis(axis_, basis_, by);
    Vector3<T> seen, home = at(target_, target) - axis.point;
    for (Eigen::Index k = 0; k < 3; ++k) seen(k) = seen_(k) - axis.point(k);
    residuals[0] = certainty_ * axis.direction.dot(seen - home);
    residuals[1] =
        certainty_ * (axis.direction.cross(seen).norm() - axis.direction.cross(home).norm());
    return true;
  }

 private:
  ChainAxis axis_;
  Eigen::Matrix<double, 3, 2> basis_;
  Vector3d target_;
  Vector3d seen_;
  double certainty_;
};

enum class Angles { believed, free, circles };

struct Case {
  std::string name;
  Chain start;
  std::vector<ChainObservation> samples;
  std::vector<identify::Sweep> sweeps;  ///< the same samples
  std::vector<std::optional<double>> home_rad;
  ChainNoise noise;
  Angles angles = Angles::believed;
};

struct Optimum {
  Chain chain;
  double cost = 0;
  int iterations = 0;
  double seconds = 0;
};

/// The four parameters that lead from one axis to another.
std::array<double, 4> between(const ChainAxis& from, const ChainAxis& to) {
  const auto basis = identify::across(from.direction);
  const double ahead = from.direction.dot(to.direction);
  const Vector3d apart = to.point_mm - from.point_mm;
  const Eigen::Vector2d turn = basis.transpose() * to.direction / ahead;
  const Eigen::Vector2d shift =
      basis.transpose() * (apart - to.direction * (from.direction.dot(apart) / ahead));
  return {turn(0), turn(1), shift(0), shift(1)};
}

/// Half the sum of squares of Ceres' residuals, free angles where they fit best.
double cost_of(const Case& of, const Chain& chain) {
  const Start start(of.start);
  std::array<std::array<double, 4>, kJoints> by;
  for (std::size_t j = 0; j < kJoints; ++j) by[j] = between(of.start.axes[j], chain.axes[j]);
  const Vector3d target = chain.targets_mm[0] - of.start.targets_mm[0];
  double sum = 0;
  for (const ChainObservation& seen : of.samples) {
    Vector3d residuals = Vector3d::Zero();
    if (of.angles == Angles::believed)
      Believed(start, seen, of.noise)(by[0].data(), by[1].data(), by[2].data(), by[3].data(),
                                      by[4].data(), by[5].data(), target.data(), residuals.data());
    else
      OffCircle(start, seen, of.noise)(by[seen.joint].data(), target.data(), residuals.data());
    sum += residuals.squaredNorm() / 2;
  }
  return sum;
}

template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Optimum by_ceres(const Case& of) {
  const Start start(of.start);
  std::vector<double> values(kParameters, 0.0);
  const auto axis = [&](std::size_t joint) { return values.data() + 4 * joint; };
  double* const target = axis(kJoints);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  std::vector<double> turns;
  for (const ChainObservation& seen : of.samples) turns.push_back(seen.turns[seen.joint]);
  if (of.angles == Angles::free) {
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t j = 0; j < kJoints; ++j)
      options.linear_solver_ordering->AddElementToGroup(axis(j), 1);
    options.linear_solver_ordering->AddElementToGroup(target, 1);
  }
  ceres::Problem problem;
  for (std::size_t i = 0; i < of.samples.size(); ++i) {
    const ChainObservation& seen = of.samples[i];
    switch (of.angles) {
      case Angles::believed:
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Believed, 3, 4, 4, 4, 4, 4, 4, 3>(
                                     new Believed(start, seen, of.noise)),
                                 nullptr, axis(0), axis(1), axis(2), axis(3), axis(4), axis(5),
                                 target);
        break;
      case Angles::free:
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<Freed, 3, 1, 4, 3>(new Freed(start, seen, of.noise)),
            nullptr, &turns[i], axis(seen.joint), target);
        options.linear_solver_ordering->AddElementToGroup(&turns[i], 0);
        break;
      case Angles::circles:
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OffCircle, 2, 4, 3>(
                                     new OffCircle(start, seen, of.noise)),
                                 nullptr, axis(seen.joint), target);
        break;
    }
  }
  options.num_threads = 1;
  options.max_num_iterations = 200;
  // So it needs the fewest steps that get it about as close to the optimum as the chain's: nothing
  // needs damping here, and a tolerance near the rounding of the cost would make it search in vain.
  options.initial_trust_region_radius = options.max_trust_region_radius;
  options.function_tolerance = 1e-11;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  Optimum found;
  found.seconds = seconds([&] { ceres::Solve(options, &problem, &summary); });
  if (!summary.IsSolutionUsable()) throw std::runtime_error("Ceres: " + summary.message);
  found.chain = moved(of.start, Eigen::Map<const Eigen::VectorXd>(values.data(), kParameters));
  found.cost = summary.final_cost;
  found.iterations = static_cast<int>(summary.iterations.size()) - 1;
  return found;
}

Optimum by_chain(const Case& of, Eigen::MatrixXd& covariance) {
  Optimum found;
  identify::ChainFit fit;
  found.seconds = seconds([&] {
    std::vector<identify::StrokeMoments> strokes;
    for (const identify::Sweep& sweep : of.sweeps)
      strokes.push_back(
          moments_of(sweep, {*sweep.joint, of.angles == Angles::believed ? kJoints : 0, false})
              .value());
    auto nodes = nodes_of(std::move(strokes), of.home_rad, std::vector<bool>(kJoints, true));
    if (of.angles != Angles::believed)
      (void)starting_targets(of.start, nodes.observations, 1, false);  // where on their circles
    fit = fit_chain(of.start, nodes, of.noise, {}, false);
  });
  if (!fit.summary.converged)
    throw std::runtime_error("the chain: " + std::string(fit.summary.ending));
  found.chain = fit.chain;
  found.cost = cost_of(of, fit.chain);
  found.iterations = fit.summary.iterations;
  covariance = fit.covariance;
  return found;
}

/// The largest difference of two chains, in standard uncertainties of the first.
double apart(const Chain& a, const Chain& b, const Eigen::MatrixXd& covariance) {
  Eigen::VectorXd change(kParameters);
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto by = between(a.axes[j], b.axes[j]);
    change.segment<4>(static_cast<Eigen::Index>(4 * j)) = Eigen::Vector4d(by.data());
  }
  change.tail<3>() = b.targets_mm[0] - a.targets_mm[0];
  return change.cwiseQuotient(covariance.diagonal().head(kParameters).cwiseSqrt())
      .cwiseAbs()
      .maxCoeff();
}

Case case_of(Angles angles, int samples) {
  const bool free = angles != Angles::believed;
  accuracy::Simulated robot;
  robot.arm = identify::test::kr5_arc();
  robot.targets_mm = {{200, 0, 215}};
  robot.ranges = {{-45, 45}, {-60, -130}, {120, 30}, {90, 0}, {90, 0}, {0, 90}};
  robot.samples = samples;
  const simulation::World world = free ? accuracy::tracker() : accuracy::controller();
  auto campaign = campaign_of(robot, world);
  if (free) campaign.order = {{0, 1}, {1, -1}, {2, -1}, {3, -1}, {4, -1}, {5, 1}};
  const auto circles = estimate_circles(sweeps_of(robot, world, 1), campaign);
  Case made;
  made.name = !free ? "angles believed" : angles == Angles::free ? "angles free" : "circles";
  made.angles = angles;
  const auto axes = starting_axes(circles);
  made.home_rad = circles.home_rad;
  made.home_rad.resize(kJoints);
  for (const identify::ChainSweep& one : chain_sweeps(circles, axes))
    made.sweeps.push_back(*one.sweep);
  made.samples = chain_samples(circles, axes);
  for (const auto& axis : axes) made.start.axes.push_back(axis.value());
  made.start.targets_mm = starting_targets(made.start, made.samples, 1, !free);
  const double step = 1 / std::sqrt(12.0);
  made.noise.position_mm = free ? world.noise.across_mm : step * campaign.resolution.position_mm;
  const double angle = step * campaign.resolution.angle_rad;
  made.noise.locked_rad = angle;
  made.noise.swept_rad.assign(kJoints, free ? std::numeric_limits<double>::infinity() : angle);
  if (!free)
    for (ChainObservation& sample : made.samples) sample.turns[sample.joint] = sample.measured_turn;
  return made;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool measure(Angles angles, int samples, int rounds) {
  using bench::right;
  const Case of = case_of(angles, samples);
  std::vector<double> ceres, chain, ratios;
  Optimum theirs, ours;
  Eigen::MatrixXd covariance;
  for (int round = 0; round < rounds; ++round) {
    theirs = by_ceres(of);
    ours = by_chain(of, covariance);
    ceres.push_back(theirs.seconds);
    chain.push_back(ours.seconds);
    ratios.push_back(theirs.seconds / ours.seconds);
  }
  const double difference = std::abs(ours.cost - theirs.cost) / theirs.cost;
  const double off = apart(ours.chain, theirs.chain, covariance);
  const double ratio = median(ratios);
  std::cout << of.name << std::string(17 - of.name.size(), ' ') << right(1e3 * median(ceres), 2, 9)
            << right(theirs.iterations, 0, 6) << right(1e3 * median(chain), 3, 11)
            << right(ours.iterations, 0, 6) << right(ratio, 1, 9) << right(1e9 * difference, 2, 14)
            << right(off, 4, 12) << std::endl;
  return difference <= kMostCostDifference && off <= kMostSigmas &&
         (angles == Angles::circles || ratio >= kRatioWanted);
}

}  // namespace

int main(int argc, char** argv) {
  int samples = 1500;
  int rounds = 11;
  CLI::App app("The chain's fit against Ceres on the same residuals", "bench_chain_speed");
  app.add_option("--samples", samples, "In each of the six sweeps")
      ->check(CLI::Range(10, 10'000))
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Each runs both, one after the other; medians are shown")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv)
  try {
    std::cout << "six sweeps of " << samples
              << " samples, one thread each; costs differ by, parameters in their uncertainties\n"
              << "                 Ceres ms steps   chain ms steps    ratio     cost / 1e-9"
              << "  parameters" << std::endl;
    bool good = true;
    for (const Angles angles : {Angles::believed, Angles::free, Angles::circles})
      good = measure(angles, samples, rounds) && good;
    std::cout << "aim" << bench::right(kRatioWanted, 1, 55) << '\n';
    if (!good) {
      std::cout << "not as promised: a twentieth of Ceres' time, the same optimum\n";
      return 1;
    }
  } catch (const std::exception& error) {
    std::cerr << "bench_chain_speed: " << error.what() << '\n';
    return 1;
  }
}
