#include "identify/chain/chain_effects.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using identify::test::Random;

namespace {

/// Six strokes in five stands of three groups at two homes, each stroke with its own two effects,
/// each stand with one, each group with three, each home with three, of which each stroke knows
/// two; four parameters, of which each stroke knows three.
struct Example {
  static constexpr Index kParameters = 4, kRows = 12, kStrokes = 6, kAtHome = 3,
                         kEffects = 6 * 2 + 5 + 3 * 3 + 2 * kAtHome;
  std::vector<StrokeProducts> strokes;
  std::vector<std::size_t> group_of{0, 1, 2, 0, 1};
  std::vector<std::size_t> home_of{0, 0, 1};
  EffectVariances variances;
  // All at once: y = X b + Z u + e.
  MatrixXd x = MatrixXd::Zero(kStrokes * kRows, kParameters),
           z = MatrixXd::Zero(kStrokes * kRows, kEffects);
  VectorXd y{kStrokes * kRows}, weights{kStrokes * kRows}, effects{kEffects};

  explicit Example(Random& random, bool zero) {
    const auto size = [&] {
      return zero && random.uniform(0, 1) < 0.5 ? 0 : random.uniform(0.1, 3);
    };
    const auto sizes = [&](Index columns, Index rows) {
      MatrixXd all(rows, columns);
      for (double& value : all.reshaped()) value = size();
      return all;
    };
    variances = {sizes(kStrokes, 2), sizes(5, 1), sizes(3, 3), sizes(2, kAtHome)};
    for (std::size_t s = 0; s < kStrokes; ++s) {
      const std::size_t stand = s % 5, group = group_of[stand];
      const auto row = static_cast<Index>(s) * kRows;
      MatrixXd columns(kRows, 2 + 1 + 3 + 2 + 3 + 1);
      for (Index r = 0; r < columns.rows(); ++r)
        for (Index c = 0; c < columns.cols(); ++c) columns(r, c) = random.normal();
      VectorXd weight(kRows);
      for (double& value : weight) value = random.uniform(0.2, 4);
      StrokeProducts stroke;
      stroke.stand = stand;
      for (Index k = 0; k < kAtHome; ++k)
        if (k != static_cast<Index>(s) % 3) stroke.outer.push_back(k);
      for (Index p = 0; p < kParameters; ++p)
        if (p != static_cast<Index>(s) % 4) stroke.outer.push_back(kAtHome + p);
      stroke.products = columns.transpose() * weight.asDiagonal() * columns;
      strokes.push_back(stroke);
      z.block(row, static_cast<Index>(2 * s), kRows, 2) = columns.leftCols(2);
      z.block(row, static_cast<Index>(12 + stand), kRows, 1) = columns.col(2);
      z.block(row, static_cast<Index>(17 + 3 * group), kRows, 3) = columns.middleCols(3, 3);
      const auto at = [&](std::size_t k) { return stroke.outer[k]; };
      for (std::size_t k = 0; k < 2; ++k)
        z.col(static_cast<Index>(26 + kAtHome * home_of[group]) + at(k)).segment(row, kRows) =
            columns.col(static_cast<Index>(6 + k));
      for (std::size_t k = 2; k < 5; ++k)
        x.col(at(k) - kAtHome).segment(row, kRows) = columns.col(static_cast<Index>(6 + k));
      y.segment(row, kRows) = columns.col(11);
      weights.segment(row, kRows) = weight;
    }
    effects << variances.own.reshaped(), variances.stand.reshaped(), variances.shared.reshaped(),
        variances.home.reshaped();
  }
};

}  // namespace

TEST_CASE("Effects eliminated step by step are generalised least squares with all at once",
          "[chain_effects]") {
  Random random(61);
  const bool zero = GENERATE(false, true);
  for (int run = 0; run < 20; ++run) {
    const Example of(random, zero);
    MatrixXd covariance = of.z * of.effects.asDiagonal() * of.z.transpose();
    covariance.diagonal() += of.weights.cwiseInverse();
    const Eigen::LLT<MatrixXd> solver(covariance);
    EffectElimination eliminate(of.strokes, of.group_of, of.home_of, Example::kAtHome,
                                Example::kParameters);
    const auto found = eliminate(of.variances);
    CHECK(found.normal.isApprox(of.x.transpose() * solver.solve(of.x), 1e-9));
    CHECK(found.gradient.isApprox(of.x.transpose() * solver.solve(of.y), 1e-9));
    CHECK(found.squares == Approx(of.y.dot(solver.solve(of.y))).epsilon(1e-9));
    const double all = 2 * solver.matrixLLT().diagonal().array().log().sum();
    CHECK(found.log_determinant == Approx(all + of.weights.array().log().sum()).epsilon(1e-9));
  }
}

TEST_CASE("Effects eliminated after others are what they are at once", "[chain_effects]") {
  Random random(62);
  const Example of(random, false);
  EffectElimination eliminate(of.strokes, of.group_of, of.home_of, Example::kAtHome,
                              Example::kParameters);
  for (int run = 0; run < 40; ++run) {
    const Example other(random, false);
    EffectVariances variances = of.variances;  // one level or two differ from those before
    if (run % 2 == 0) variances.home = other.variances.home;
    if (run % 3 == 0) variances.shared = other.variances.shared;
    if (run % 5 == 0) variances.own = other.variances.own;
    if (run % 7 == 0) variances.stand = other.variances.stand;
    if (run % 4 == 0) variances.own.col(1) = other.variances.own.col(1);  // of one stroke alone
    const auto found = eliminate(variances);
    const auto fresh = EffectElimination(of.strokes, of.group_of, of.home_of, Example::kAtHome,
                                         Example::kParameters)(variances);
    CHECK(found.normal == fresh.normal);
    CHECK(found.gradient == fresh.gradient);
    CHECK(found.squares == fresh.squares);
    CHECK(found.log_determinant == fresh.log_determinant);
  }
}

TEST_CASE("Strokes have so much of a device's place in common as their times tell",
          "[chain_effects]") {
  Random random(63);
  const Chain chain = identify::test::random_chain(2, 1, random);
  identify::test::Measured how;
  auto there = identify::test::sweeps_of(chain, how, random);
  auto back = there;
  for (auto& seen : back) seen.sweep += 2;
  there.insert(there.end(), back.begin(), back.end());
  auto nodes = identify::test::nodes_of(there, 2);
  REQUIRE(nodes.units.size() == 4);
  ChainEffects effects;
  effects.drift_mm = 0.1;
  const auto timed = [&](double after_s) {
    // Each joint's second stroke begins so long after its first one; the campaign takes 12 s.
    for (std::size_t s = 0; s < 4; ++s) {
      const double begin_s = (nodes.strokes[s].content.joint == 0 ? 0 : 6) + (s < 2 ? 0 : after_s);
      nodes.strokes[s].begin_s = begin_s;
      nodes.strokes[s].end_s = begin_s + 1;
    }
    nodes.strokes.back().end_s = 12;
    nodes.strokes.back().begin_s = 11;
    const EffectColumns columns(effects, nodes);
    REQUIRE(columns.wander == 3);
    REQUIRE(columns.bent == 3);
    return variances_of(effects, nodes, columns);
  };
  const auto share = [&](const EffectVariances& variances) {
    // What is not shared is a stroke's own: the three shifts behind the two joints' turns.
    const double shared = variances.shared(0, static_cast<Index>(nodes.group[0]));
    CHECK(shared + variances.own(2, 0) == Approx(0.01));
    return shared / 0.01;
  };
  CHECK(share(timed(1)) == Approx(1 - 3 * (1 - 1.0 / 3) / 12));
  CHECK(share(timed(3)) == Approx(1 - 3 * (3 - 1.0 / 3) / 12));
  CHECK(share(timed(5)) == 0);    // as far apart as any
  CHECK(share(timed(0)) == 0);    // times begin anew with each
  CHECK(share(timed(0.5)) == 0);  // nor can a joint sweep twice at once
}
