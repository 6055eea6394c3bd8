#include "daemon/results/change_test.hpp"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "tests/catch.hpp"

using namespace sweepd;

namespace {

/// Numbers that are correlated as those of an arm are: some closely.
Eigen::MatrixXd some_covariance(Eigen::Index count) {
  std::mt19937 random(11);
  std::normal_distribution<> normal;
  Eigen::MatrixXd mix(count, count);
  for (double& value : mix.reshaped()) value = normal(random);
  Eigen::VectorXd sizes(count);
  for (Eigen::Index k = 0; k < count; ++k) sizes(k) = std::pow(10.0, -0.5 * static_cast<double>(k));
  return mix * sizes.asDiagonal() * mix.transpose();
}

class Draws {
 public:
  explicit Draws(const Eigen::MatrixXd& covariance) : root_(covariance.llt().matrixL()) {}
  Eigen::VectorXd next() {
    Eigen::VectorXd white(root_.rows());
    for (double& value : white) value = normal_(random_);
    return root_ * white;
  }

 private:
  Eigen::MatrixXd root_;
  std::mt19937 random_{5};
  std::normal_distribution<> normal_;
};

constexpr Eigen::Index kCount = 5;

}  // namespace

TEST_CASE("no more than the level of unchanged pairs raise an alarm", "[change_test][long]") {
  const auto covariance = some_covariance(kCount);
  Draws draws(covariance);
  int total = 0, named = 0;
  constexpr int kPairs = 400;
  for (int i = 0; i < kPairs; ++i) {
    const auto test = test_change(draws.next(), covariance, 0.05);
    total += test.changed;
    for (const auto& number : test.numbers)
      if (number.changed) {
        REQUIRE(test.changed);
        ++named;
        break;
      }
  }
  // 5 %, three standard deviations of the count.
  CHECK(std::abs(total - 0.05 * kPairs) < 3 * std::sqrt(0.05 * kPairs));
  CHECK(named <= total);
  CHECK(named > 0);
}

TEST_CASE("a number that changed by its smallest change is named in 80 % of cases",
          "[change_test][long]") {
  const auto covariance = some_covariance(kCount);
  Draws draws(covariance);
  const auto none = test_change(Eigen::VectorXd::Zero(kCount), covariance, 0.05);
  CHECK(none.p == 1);
  for (const Eigen::Index k : {0, 3}) {
    int named = 0;
    constexpr int kPairs = 400;
    const auto& number = none.numbers[static_cast<std::size_t>(k)];
    CHECK(number.sigma == Approx(std::sqrt(covariance(k, k))));
    for (int i = 0; i < kPairs; ++i) {
      Eigen::VectorXd difference = draws.next();
      difference(k) += number.smallest;
      named +=
          test_change(difference, covariance, 0.05).numbers[static_cast<std::size_t>(k)].changed;
    }
    // Three standard deviations of the count, which is 2 %; Holm's later steps add a little.
    CHECK(std::abs(named - 0.8 * kPairs) < 0.06 * kPairs);
  }
}

TEST_CASE("one number alone is named whenever the total test says so", "[change_test]") {
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(1, 1, 4);
  const auto seen = test_change(Eigen::VectorXd::Constant(1, 4), covariance, 0.05);
  CHECK(seen.changed);
  CHECK(seen.numbers[0].changed);
  CHECK(seen.p == Approx(0.0455).epsilon(1e-3));                        // two sigma
  CHECK(seen.numbers[0].smallest == Approx(2 * 2.8016).epsilon(1e-3));  // 1.96 + 0.8416
  CHECK_FALSE(test_change(Eigen::VectorXd::Constant(1, 3.9), covariance, 0.05).changed);
  CHECK(test_change({}, {}, 0.05).numbers.empty());
}

TEST_CASE("of what has changed, the correlation with what has not tells more", "[change_test]") {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 1, 0.95, 0.95, 1;
  // Both errors are 1; the first number also changed by 10.
  const auto test = test_change(Eigen::Vector2d(11, 1), covariance, 0.05);
  CHECK(test.numbers[0].changed);
  CHECK_FALSE(test.numbers[1].changed);
  CHECK(test.changes(0) == Approx(11 - 0.95));
  CHECK(test.changes(1) == 0);
  CHECK(test.changes_covariance(0, 0) == Approx(1 - 0.95 * 0.95));
}

TEST_CASE("numbers that are correlated beyond what a file can tell are no proof", "[change_test]") {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 1, 1 - 1e-9, 1 - 1e-9, 1;
  CHECK_FALSE(test_change(Eigen::Vector2d(0.5, 0.501), covariance, 0.05).changed);
}
