// Static poses of a real arm: a Universal Robots UR5 before a laser tracker.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>
#include <string>

#include <Eigen/LU>
#include <spdlog/fmt/fmt.h>

#include "daemon/points/point_poses.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/poses/pose_design.hpp"
#include "identify/poses/pose_estimate.hpp"
#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"
#include "tests/simulation/level_oracle.hpp"

using namespace acceptance;
using identify::Pose;

namespace {

/// As its maker specifies it (standard DH), angles without offsets.
identify::Campaign ur5() {
  constexpr std::array<std::array<double, 3>, 6> kRows{{{89.159, 0, 90},
                                                        {0, -425, 0},
                                                        {0, -392.25, 0},
                                                        {109.15, 0, 90},
                                                        {94.65, 0, -90},
                                                        {82.3, 0, 0}}};
  identify::Arm arm;
  for (const auto& [b, a, alpha] : kRows) arm.rows.push_back({b, 0, a, alpha * identify::kDegree});
  arm.home_rad.assign(6, 0);
  arm.positive.assign(6, 1);
  identify::Campaign campaign;
  campaign.specified = arm;
  campaign.device_frame = true;
  return campaign;
}

struct HeldOut {
  double mean_mm = 0;
  double inside = 0;  ///< share in the 95 % ellipsoids
};

HeldOut judged(const std::vector<Pose>& fit, const std::vector<Pose>& held) {
  std::string reason;
  const auto found = identify::estimate_poses(fit, ur5(), nullptr, {}, reason);
  INFO(reason);
  REQUIRE(found);
  REQUIRE(found->fit.converged);
  HeldOut all;
  const auto count = static_cast<double>(held.size());
  for (const Pose& pose : held) {
    const Eigen::Vector3d off = pose.sample.position_mm - found->fit.model.position_mm(pose);
    all.mean_mm += off.norm() / count;
    if (off.dot(found->covariance_at(pose).inverse() * off) < 7.815) all.inside += 1 / count;
  }
  return all;
}

}  // namespace

TEST_CASE("A real arm's poses tell where it is in others", "[poses]") {
  const auto folder = real_data("pose-logs");
  if (!folder) return;
  sweepd::PointsReader reader({}, 6);
  const auto all = sweepd::static_poses(reader.read(*folder / "ur5-poses.csv", {}), 6);
  REQUIRE(all.size() == 1000);

  SECTION("ten draws of 200, judged by the others") {
    double mean = 0;
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      auto drawn = all;
      std::mt19937 random(seed);
      std::shuffle(drawn.begin(), drawn.end(), random);
      const auto middle = drawn.begin() + 200;
      const HeldOut found = judged({drawn.begin(), middle}, {middle, drawn.end()});
      std::cout << fmt::format("draw {}: mean {:.4f} mm of 800 held out, {:.1f} % inside\n", seed,
                               found.mean_mm, 100 * found.inside);
      mean += found.mean_mm / 10;
      CHECK(found.inside >= 0.90);
      CHECK(found.inside <= 0.98);
    }
    std::cout << fmt::format("mean {:.4f} mm\n", mean);
    CHECK(mean <= 0.105);
  }

  SECTION("twelve that a design chose, judged by the others") {
    identify::PoseModel model;
    const auto placed =
        identify::placed_robustly(*ur5().specified, identify::Freedom::frames, all, 1);
    model.chain = placed.chain();
    model.home_rad.assign(6, 0);
    std::vector<Eigen::MatrixXd> rows;
    for (const Pose& pose : all) {
      Eigen::MatrixXd row = identify::pose_row(model, pose, false)
                                .by_parameter.leftCols(model.chain_parameters().count(false));
      for (Eigen::Index j = 0; j < 6; ++j) row.middleCols<2>(4 * j) /= 1000;  // rad times a metre
      rows.push_back(row);
    }
    const auto chosen = identify::d_optimal(rows, 12);
    std::vector<Pose> fit, held;
    for (std::size_t i = 0; i < all.size(); ++i)
      (std::binary_search(chosen.begin(), chosen.end(), i) ? fit : held).push_back(all[i]);
    const HeldOut found = judged(fit, held);
    std::cout << fmt::format("12 chosen: mean {:.4f} mm of {} held out\n", found.mean_mm,
                             held.size());
    CHECK(found.mean_mm <= 0.14);
  }

  SECTION("the level table, beside one that was worked out by differences") {
    const std::vector<Pose> fit(all.begin(), all.begin() + 200), held(all.begin() + 200, all.end());
    std::string reason;
    const auto found = identify::estimate_poses(fit, ur5(), nullptr, {}, reason);
    REQUIRE(found);
    std::vector<Pose> counted;
    for (std::size_t i = 0; i < fit.size(); ++i)
      if (!std::binary_search(found->outliers.begin(), found->outliers.end(), i))
        counted.push_back(fit[i]);
    const auto oracle = simulation::levels_by_differences(found->levels.front().arm, counted, held);
    for (std::size_t k = 0; k < oracle.size(); ++k) {
      const auto left = identify::left_of(distances_mm(found->levels[k].arm, held));
      std::cout << fmt::format("level {}: mean {:.5f} mm, by differences {:.5f} mm\n", k + 1,
                               left.mean_mm, oracle[k].mean_mm);
      CHECK(std::abs(left.mean_mm - oracle[k].mean_mm) < 0.01);
      CHECK(std::abs(left.rms_mm - oracle[k].rms_mm) < 0.01);
      CHECK(std::abs(left.most_mm - oracle[k].most_mm) < 0.01);
    }
  }
}
