#include "identify/chain/chain_sag.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/QR>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"
#include "tests/simulation/gravity.hpp"

using namespace identify;
using Eigen::Index;
using identify::test::Random;

namespace {

Turns some_turns(std::size_t joints, Random& chance) {
  Turns turns{};
  for (std::size_t j = 0; j < joints; ++j) turns[j] = chance.uniform(-2, 2);
  return turns;
}

}  // namespace

TEST_CASE("A weight's lever is how fast it rises as the joint turns", "[chain_sag]") {
  Random chance(1);
  Chain chain = test::random_chain(6, 1, chance);
  chain.up = chance.direction();
  chain.sags = sags_of(chain, std::vector<bool>(6, true), {0, 1, 1, 0, 0, 1});
  REQUIRE(chain.sags.size() == 2 * (5 + 4 + 1));
  const Turns turns = some_turns(6, chance);
  constexpr double kStep = 1e-6;
  const auto levers = sag_levers(chain, turns);
  for (std::size_t s = 0; s < chain.sags.size(); ++s) {
    const ChainSag& sag = chain.sags[s];
    const auto rise = [&](Turns from) {
      for (std::size_t j = sag.link + 1; j < 6; ++j) from[j] = 0;
      Turns more = from;
      more[sag.joint] += kStep;
      from[sag.joint] -= kStep;
      const Eigen::Matrix3d turned =
          chain.displacement(more).linear() - chain.displacement(from).linear();
      return chain.up.dot(turned * sag.arm) / (2 * kStep);
    };
    CHECK(levers[s] == Approx(rise(turns) - rise({})).margin(1e-8));
  }
}

TEST_CASE("What any weights bend is a sum of a chain's sags, as large as was said", "[chain_sag]") {
  Random chance(3);
  double squares = 0, count = 0;
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U})
    for (const auto& plain : {simulation::kr5(), simulation::iiwa()}) {
      auto robot = simulation::built(plain, seed);
      if (seed > 2) robot.up = Eigen::Vector3d::UnitX();  // mounted to a wall
      Chain chain = simulation::chain_of(robot);
      chain.up = robot.up;
      const std::size_t joints = chain.axes.size();
      std::vector<double> bends(joints);
      for (const std::size_t j : robot.elastic) bends[j] = 1;
      chain.sags = sags_of(chain, std::vector<bool>(joints, true), bends);
      const simulation::Sag sag(robot, 1);
      constexpr Index kPoses = 200;
      for (const std::size_t j : robot.elastic) {
        std::vector<ChainSag> own;
        for (const ChainSag& one : chain.sags)
          if (one.joint == j) own.push_back(one);
        Chain alone = chain;
        alone.sags = own;
        Eigen::MatrixXd levers(kPoses, static_cast<Index>(own.size()));
        Eigen::VectorXd bent(kPoses);
        for (Index i = 0; i < kPoses; ++i) {
          const Turns turns = some_turns(joints, chance);
          const auto here = sag_levers(alone, turns);
          levers.row(i) = Eigen::Map<const Eigen::RowVectorXd>(here.data(), levers.cols());
          bent(i) = sag.at(turns)[j] - sag.at({})[j];
        }
        const Eigen::VectorXd sizes = levers.completeOrthogonalDecomposition().solve(bent);
        CHECK((levers * sizes - bent).norm() < 1e-9 * bent.norm());
        for (std::size_t s = 0; s < own.size(); ++s)
          squares += std::pow(sizes(static_cast<Index>(s)) / own[s].share, 2);
        count += static_cast<double>(own.size());
      }
    }
  CAPTURE(squares / count);
  CHECK(squares / count == Approx(1).margin(0.6));
}

TEST_CASE("What joints give way by is shared out so that it is what the description says",
          "[chain_sag]") {
  Random chance(2);
  Chain chain = test::random_chain(6, 1, chance);
  chain.up = chance.direction();
  const auto sags = sags_of(chain, std::vector<bool>(6, true), {0, 0.1, 0.2, 0, 0, 0});
  // All links along one line: the first sag of each link pulls.
  std::array<double, 6> squares{};
  for (std::size_t s = 0; s < sags.size(); s += 2)
    squares[sags[s].joint] += sags[s].share * sags[s].share;
  CHECK(std::sqrt(squares[1]) == Approx(0.5));
  CHECK(std::sqrt(squares[2]) == Approx(1));
  CHECK(sags_of(chain, std::vector<bool>(6, false), {0, 0.1, 0, 0, 0, 0}).empty());
  CHECK(sags_of(chain, std::vector<bool>(6, true), {}).empty());
  // About a joint that stands upright nothing pulls.
  const std::vector<double> first{0.1, 0, 0, 0, 0, 0};
  CHECK_FALSE(sags_of(chain, std::vector<bool>(6, true), first).empty());
  chain.up = chain.axes.front().direction;
  CHECK(sags_of(chain, std::vector<bool>(6, true), first).empty());
  chain.up.setZero();  // nobody knows
  CHECK(sags_of(chain, std::vector<bool>(6, true), {0, 0.1, 0, 0, 0, 0}).empty());
}
