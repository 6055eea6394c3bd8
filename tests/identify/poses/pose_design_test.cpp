#include "identify/poses/pose_design.hpp"

#include <algorithm>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/catch.hpp"

using namespace identify;

namespace {

std::vector<Eigen::MatrixXd> random_rows(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<> normal;
  std::vector<Eigen::MatrixXd> all;
  for (std::size_t k = 0; k < count; ++k)
    all.push_back(Eigen::MatrixXd::NullaryExpr(3, 8, [&] { return normal(random); }));
  return all;
}

double information(const std::vector<Eigen::MatrixXd>& rows, const std::vector<std::size_t>& of) {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(rows[0].cols(), rows[0].cols());
  for (const std::size_t k : of) normal += rows[k].transpose() * rows[k];
  return normal.determinant();
}

}  // namespace

TEST_CASE("Chosen poses tell more than any others that were drawn", "[pose_design]") {
  const auto rows = random_rows(60, 1);
  const auto chosen = d_optimal(rows, 6);
  REQUIRE(chosen.size() == 6);
  CHECK(std::is_sorted(chosen.begin(), chosen.end()));
  const double best = information(rows, chosen);
  std::mt19937 random(2);
  std::vector<std::size_t> all(rows.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  for (int draw = 0; draw < 2000; ++draw) {
    std::shuffle(all.begin(), all.end(), random);
    CHECK(information(rows, {all.begin(), all.begin() + 6}) <= best);
  }
}

TEST_CASE("No exchange of one for another betters a design", "[pose_design]") {
  const auto rows = random_rows(25, 3);
  const auto chosen = d_optimal(rows, 5);
  const double best = information(rows, chosen);
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (std::size_t other = 0; other < rows.size(); ++other) {
      if (std::find(chosen.begin(), chosen.end(), other) != chosen.end()) continue;
      auto exchanged = chosen;
      exchanged[k] = other;
      CHECK(information(rows, exchanged) <= best * (1 + 1e-3));
    }
}

TEST_CASE("Where there are no more candidates than asked for, all are taken", "[pose_design]") {
  CHECK(d_optimal(random_rows(3, 4), 5) == std::vector<std::size_t>{0, 1, 2});
}
