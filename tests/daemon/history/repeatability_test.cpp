#include "daemon/history/repeatability.hpp"

#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <boost/math/distributions/fisher_f.hpp>

#include "tests/catch.hpp"

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sweepd::Repeatability;
using sweepd::Scatter;
using sweepd::Varying;

namespace {

constexpr Index kVaryingCount = 6;
const std::vector<sweepd::VaryingNumber> kVaryingNumbers = {
    {Varying::lengths, 600}, {Varying::lengths, 120}, {Varying::zeros, 0},
    {Varying::zeros, 0},     {Varying::twists, 0},    {Varying::twists, 0}};

MatrixXd fit() {
  VectorXd sigma(kVaryingCount);
  sigma << 0.01, 0.01, 1e-5, 1e-5, 1e-5, 1e-5;
  return sigma.cwiseAbs2().asDiagonal();
}

/// Campaigns of one state: the fit's noise, a common temperature, and zeros that scatter.
class Drawn {
 public:
  explicit Drawn(std::uint32_t seed) : random_(seed) {}

  VectorXd campaign(double warmer, double zeros) {
    VectorXd drawn(kVaryingCount);
    const MatrixXd covariance = fit();
    const double temperature = warmer * normal_(random_);
    for (Index k = 0; k < kVaryingCount; ++k) {
      drawn(k) = std::sqrt(covariance(k, k)) * normal_(random_);
      const auto& number = kVaryingNumbers[static_cast<std::size_t>(k)];
      drawn(k) += 1e-4 * temperature * number.length_mm;
      if (number.kind == Varying::zeros) drawn(k) += zeros * normal_(random_);
    }
    return drawn;
  }
  Scatter scatter(std::size_t count, double warmer, double zeros, VectorXd& mean) {
    std::vector<VectorXd> all;
    mean = VectorXd::Zero(kVaryingCount);
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(campaign(warmer, zeros));
      mean += all.back() / static_cast<double>(count);
    }
    Scatter scatter{MatrixXd::Zero(kVaryingCount, kVaryingCount), static_cast<double>(count) - 1};
    for (const VectorXd& one : all) scatter.products += (one - mean) * (one - mean).transpose();
    return scatter;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<> normal_;
};

/// Of unchanged campaigns against the mean of so many, how many are called changed at 5 %.
double alarms(std::size_t marked, double warmer, double zeros, int trials) {
  Drawn drawn(7);
  int called = 0;
  for (int trial = 0; trial < trials; ++trial) {
    VectorXd mean;
    const Repeatability found(fit(), kVaryingNumbers, drawn.scatter(marked, warmer, zeros, mean));
    const VectorXd off = drawn.campaign(warmer, zeros) - mean;
    const MatrixXd covariance = (1 + 1 / static_cast<double>(marked)) * found.spread().covariance;
    const boost::math::fisher_f f(kVaryingCount, found.spread().degrees);
    called += cdf(complement(f, off.dot(covariance.inverse() * off) / kVaryingCount)) < 0.05;
  }
  return static_cast<double>(called) / trials;
}

}  // namespace

TEST_CASE("many campaigns tell their covariance, whatever was assumed", "[repeatability]") {
  Drawn drawn(3);
  VectorXd mean;
  const Repeatability found(fit(), kVaryingNumbers, drawn.scatter(3000, 0.5, 5e-5, mean));
  const MatrixXd covariance = found.spread().covariance;
  CHECK(std::sqrt(covariance(0, 0)) == Approx(std::hypot(0.01, 0.03)).epsilon(0.05));
  CHECK(covariance(0, 1) == Approx(0.03 * 0.006).epsilon(0.1));
  CHECK(std::sqrt(covariance(3, 3)) == Approx(std::hypot(1e-5, 5e-5)).epsilon(0.05));
  CHECK(found.between()[static_cast<std::size_t>(Varying::expansion)] ==
        Approx(0.5e-4).epsilon(0.15));
  CHECK(found.between()[static_cast<std::size_t>(Varying::zeros)] == Approx(5e-5).epsilon(0.15));
  CHECK(found.spread().degrees > 500);
}

TEST_CASE("without campaigns the fit's own covariance is widened a little", "[repeatability]") {
  const Repeatability found(fit(), kVaryingNumbers, {});
  const MatrixXd share = found.spread().widened() * found.spread().covariance * fit().inverse();
  for (Index k = 0; k < kVaryingCount; ++k) {
    CHECK(share(k, k) > 1);
    CHECK(share(k, k) < 2.5);
  }
}

TEST_CASE("the same data again and again are no proof of repeatability", "[repeatability]") {
  const Repeatability found(fit(), kVaryingNumbers,
                            {MatrixXd::Zero(kVaryingCount, kVaryingCount), 20});
  const MatrixXd share = found.spread().covariance * fit().inverse();
  for (Index k = 0; k < kVaryingCount; ++k) CHECK(share(k, k) > 0.49);
}

TEST_CASE("false alarms are as rare as they should be, of few marked campaigns and of many",
          "[repeatability][long]") {
  const auto [marked, low, high] =
      GENERATE(table<int, double, double>({{3, 0.0, 0.16}, {6, 0.02, 0.1}, {20, 0.03, 0.08}}));
  INFO(marked << " marked");
  for (const auto& [warmer, zeros] : {std::pair(0.0, 0.0), std::pair(0.5, 5e-5)}) {
    const double share = alarms(static_cast<std::size_t>(marked), warmer, zeros, 400);
    INFO(warmer << " K, " << share);
    CHECK(share <= high);
    if (warmer > 0) CHECK(share >= low);
  }
}

TEST_CASE("a campaign is tested against the others without itself", "[repeatability]") {
  Drawn drawn(5);
  VectorXd mean;
  Scatter scatter = drawn.scatter(10, 0, 0, mean);
  const VectorXd last = drawn.campaign(0, 0);
  // One more: the mean and the scatter with it.
  const VectorXd off = last - mean;
  const VectorXd from_mean = off * (10.0 / 11);
  const Scatter with{scatter.products + 10.0 / 11 * off * off.transpose(), 10};
  const Repeatability found(fit(), kVaryingNumbers, with);
  const auto without = found.without(from_mean, 11);
  CHECK(without.degrees < found.spread().degrees);
  // Both have the same prior: what the campaign has added is taken away again.
  const Repeatability::Spread all = found.without(VectorXd::Zero(kVaryingCount), 11);
  const double ratio = all.covariance.trace() / without.covariance.trace();
  CHECK(ratio > 1);
  CHECK(without.covariance.llt().info() == Eigen::Success);
}
