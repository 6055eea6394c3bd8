#include "identify/geometry/information.hpp"

#include <Eigen/LU>

#include "tests/catch.hpp"

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using identify::Information;

namespace {

/// Of three numbers, the last two with the given correlation, in units a thousandfold apart.
MatrixXd correlated(double correlation) {
  MatrixXd normal = MatrixXd::Identity(3, 3);
  normal(1, 2) = normal(2, 1) = correlation;
  const Vector3d scale(1, 1e3, 1e-3);
  return scale.asDiagonal() * normal * scale.asDiagonal();
}

double off(const MatrixXd& found, const MatrixXd& wanted) {
  return (found - wanted).norm() / wanted.norm();
}

}  // namespace

TEST_CASE("information that is whole: step and covariance are the solution's", "[information]") {
  const MatrixXd normal = correlated(0.9);
  const Information information(normal);
  const Vector3d gradient(1, -2e3, 3e-3);
  CHECK(information.undetermined() == 0);
  CHECK(off(normal * information.step(gradient, 0), gradient) < 1e-12);
  CHECK(off(information.covariance(), normal.inverse()) < 1e-12);
  CHECK(information.covariance() == information.covariance().transpose());
  CHECK(information.condition() == Approx(19).epsilon(1e-9));  // 1.9 by 0.1
  CHECK(information.determined().cols() == 3);
  CHECK(information.open().cols() == 0);
}

TEST_CASE("a direction just above and just below what counts as information", "[information]") {
  // Eigenvalues of the last two: 1 - correlation and 1 + correlation.
  for (const double least : {1e-6, 5e-9, 1.1e-9, 0.9e-9, 1e-11}) {
    INFO(least);
    const Information information(correlated(1 - least));
    const bool informed = least > identify::kNoInformation;
    CHECK(information.undetermined() == (informed ? 0 : 1));
    CHECK(information.determined().cols() == (informed ? 3 : 2));
    CHECK(information.open().cols() == (informed ? 0 : 1));
    // Along it the variance is (1, -1)/sqrt(2) over its eigenvalue, scaled.
    const double wanted = 1e-6 * (0.25 + (informed ? 0.5 / least : 0));
    CHECK(information.covariance()(1, 1) == Approx(wanted).epsilon(1e-5));
    const VectorXd step = information.step(Vector3d(0, 1e3, -1e-3), 0);
    CHECK(step(1) == Approx(informed ? 1e-3 / least : 0).epsilon(1e-5).margin(1e-6));
  }
}

TEST_CASE("what is held back by damping moves less far", "[information]") {
  const Information information(correlated(0.5));
  const Vector3d gradient(1, 0, 0);
  CHECK(information.step(gradient, 0)(0) == Approx(1));
  CHECK(information.step(gradient, 1)(0) == Approx(0.5));
}

TEST_CASE("a parameter that nothing depends on is no loss", "[information]") {
  MatrixXd normal = correlated(0.5);
  normal.row(0).setZero();
  normal.col(0).setZero();
  const Information information(normal);
  CHECK(information.undetermined() == 0);
  CHECK(information.open().cols() == 0);
  CHECK(information.covariance().col(0).norm() == 0);
  CHECK(information.covariance()(1, 1) == Approx(1e-6 / 0.75));
}
