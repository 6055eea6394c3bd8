#include "identify/sweeps/stroke_moments.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/random_chain.hpp"

using namespace identify;
using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using identify::test::as_sweeps;
using identify::test::Measured;
using identify::test::Random;
using identify::test::random_chain;
using identify::test::sweeps_of;

namespace {

Measured measured(double turn_rad, int samples) {
  Measured how;
  how.position_mm = 0.02;
  how.orientation_rad = 2e-5;
  how.locked_rad = 1e-6;
  how.from_rad = -turn_rad / 2;
  how.to_rad = turn_rad / 2;
  how.samples = samples;
  return how;
}

}  // namespace

TEST_CASE("Sums over nodes are sums over samples", "[stroke_moments]") {
  const bool told = GENERATE(false, true);
  const double turn_deg = GENERATE(5, 90, 300);
  CAPTURE(told, turn_deg);
  Random random(51);
  const Chain chain = random_chain(3, 1, random);
  const auto sweeps =
      as_sweeps(sweeps_of(chain, measured(turn_deg * kDegree, 400), random), 3, told);
  const auto stroke = moments_of(sweeps[1], {1, told ? std::size_t{3} : 0, true});
  REQUIRE(stroke);
  CHECK(stroke->told == told);
  CHECK(stroke->outliers == 0);
  // What a model is along a stroke: harmonics of the turn. The weights are those of the samples,
  // so that all of them is known only where none is an outlier.
  const auto model = [](double x) { return 1 + 0.5 * x + std::cos(x) - 0.3 * std::sin(2 * x); };
  double weight = 0;
  Eigen::Matrix<double, 7, 7> from_samples = Eigen::Matrix<double, 7, 7>::Zero();
  for (const Sample& sample : *sweeps[1].samples) {
    const double x = stroke->zero_rad + stroke->sense * stroke->angle_about(sample.position_mm);
    const auto [a, b, c] = sample.abc_rad;
    const Matrix3d tool =
        (Eigen::AngleAxisd(a, Vector3d::UnitZ()) * Eigen::AngleAxisd(b, Vector3d::UnitY()) *
         Eigen::AngleAxisd(c, Vector3d::UnitX()))
            .toRotationMatrix();
    Eigen::Matrix<double, 7, 1> z;
    z << 1, stroke->departure(sample.position_mm, x),
        stroke->departure(tool, x, told ? sample.angles_rad[1] : x);
    z(3) = told ? stroke->circle.radius_mm * stroke->sense * (x - sample.angles_rad[1]) : 0;
    from_samples += model(x) * z * z.transpose();
    weight += 1;
  }
  CHECK(stroke->weight == Approx(weight).epsilon(0.01));
  Eigen::Matrix<double, 7, 7> from_nodes = Eigen::Matrix<double, 7, 7>::Zero();
  for (const StrokeMoments::Node& node : stroke->nodes)
    from_nodes += model(node.turn_rad) * node.sums.topLeftCorner<7, 7>();
  // Some samples in a hundred have a little less than their whole weight.
  for (Index r = 0; r < 7; ++r)
    for (Index c = 0; c < 7; ++c) {
      CAPTURE(r, c);
      const double size = std::sqrt(from_samples(r, r) * from_samples(c, c));
      CHECK(std::abs(from_nodes(r, c) - from_samples(r, c)) <= 0.03 * size);
    }
}

TEST_CASE("Samples five millimetres off lose their weight, good ones keep theirs",
          "[stroke_moments]") {
  Random random(24);
  const Chain chain = random_chain(4, 1, random);
  auto samples = sweeps_of(chain, measured(1.6, 400), random);
  for (std::size_t i = 0; i < samples.size(); i += 20)
    samples[i].position_mm += 5 * random.direction();
  const bool told = GENERATE(false, true);
  for (const Sweep& sweep : as_sweeps(samples, 4, told)) {
    const auto stroke = moments_of(sweep, {*sweep.joint, told ? std::size_t{4} : 0, false});
    REQUIRE(stroke);
    CHECK(stroke->samples == 400);
    // Of 20 some lie along the circle by chance, where a stroke whose turn is not told follows.
    CHECK(stroke->outliers >= 18);
    CHECK(stroke->outliers <= 22);
    CHECK(stroke->weight == Approx(380).margin(6));
  }
}

TEST_CASE("Printed numbers a step beside most others are no outliers", "[stroke_moments]") {
  constexpr double kStep_mm = 0.1;
  auto samples = std::make_shared<std::vector<Sample>>();
  for (int i = 0; i < 400; ++i) {
    const double turn = 0.003 * i;
    Sample sample;
    sample.time_s = 0.004 * i;
    sample.has_position = true;
    sample.position_mm = {std::round(500 * std::cos(turn) / kStep_mm) * kStep_mm,
                          std::round(500 * std::sin(turn) / kStep_mm) * kStep_mm,
                          i % 20 == 7 ? 300.2 : 300.1};
    samples->push_back(sample);
  }
  Sweep sweep;
  sweep.samples = samples;
  const auto stroke = moments_of(sweep, {0, 0, false, false, {kStep_mm, 0}});
  REQUIRE(stroke);
  CHECK(stroke->outliers == 0);
  CHECK(stroke->weight == Approx(400));
}

TEST_CASE("A stroke of few samples, and one whose angles tell nothing of it", "[stroke_moments]") {
  Random random(52);
  const Chain chain = random_chain(2, 1, random);
  const auto few = as_sweeps(sweeps_of(chain, measured(1, 5), random), 2);
  const auto stroke = moments_of(few.front(), {0, 2, true});
  REQUIRE(stroke);
  for (const StrokeMoments::Node& node : stroke->nodes) CHECK(node.sums.allFinite());

  auto samples = sweeps_of(chain, measured(1, 400), random);
  for (ChainObservation& seen : samples) seen.measured_turn = random.uniform(-3, 3);
  const auto astray = moments_of(as_sweeps(samples, 2).front(), {0, 2, false});
  REQUIRE(astray);
  CHECK_FALSE(astray->told);

  auto still = few.front();
  still.samples = std::make_shared<const std::vector<Sample>>(100, few.front().first());
  CHECK_FALSE(moments_of(still, {0, 2, true}));
}

namespace {

/// As often as asked for: sweep n of joint 1, each with its own wobble and noise.
std::vector<Sweep> repeats(int count, double turn_rad, bool told, std::size_t targets = 1) {
  Random random(53);
  const Chain chain = random_chain(3, targets, random);
  std::vector<Sweep> found;
  for (int n = 0; n < count; ++n)
    found.push_back(as_sweeps(sweeps_of(chain, measured(turn_rad, 400), random), 3, told)[1]);
  return found;
}

/// What a model that is smooth along the arc makes of first moments.
Eigen::VectorXd modelled(const StrokeMoments& stroke) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(stroke.nodes.front().sums.rows());
  for (const StrokeMoments::Node& node : stroke.nodes)
    sum += std::cos(node.turn_rad + 0.3) * node.sums.col(0);
  return sum;
}

}  // namespace

TEST_CASE("Wherever a stroke's samples lie, each node has some", "[stroke_moments]") {
  const std::string where = GENERATE("at stops", "a gap in the middle", "a few beside most");
  CAPTURE(where);
  Random random(57);
  const Chain chain = random_chain(3, 1, random);
  const auto sweeps = as_sweeps(sweeps_of(chain, measured(90 * kDegree, 400), random), 3, false);
  auto samples = *sweeps[1].samples;
  if (where == "at stops")
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = samples[i / 100 * 133];
  else if (where == "a gap in the middle")
    samples.erase(samples.begin() + 80, samples.begin() + 320);
  else
    for (const auto& [from, to] : {std::pair{260, 395}, {202, 210}, {141, 198}, {6, 140}})
      samples.erase(samples.begin() + from, samples.begin() + to);
  Sweep sweep = sweeps[1];
  sweep.samples = std::make_shared<const std::vector<Sample>>(samples);
  const auto stroke = moments_of(sweep, {1, 0, false});
  REQUIRE(stroke);
  std::vector<double> turns;
  for (const Sample& sample : samples)
    turns.push_back(stroke->zero_rad + stroke->sense * stroke->angle_about(sample.position_mm));
  double weight = 0, weighted = 0, expected = 0;
  for (const StrokeMoments::Node& node : stroke->nodes) {
    CAPTURE(node.turn_rad);
    CHECK(node.sums(0, 0) > 0.5);
    double nearest = 10;
    for (const double turn : turns) nearest = std::min(nearest, std::abs(turn - node.turn_rad));
    CHECK(nearest < 2 * kDegree);
    weight += node.sums(0, 0);
    weighted += node.sums(0, 0) * std::cos(2 * node.turn_rad);
  }
  for (const double turn : turns) expected += std::cos(2 * turn);
  CHECK(weight == Approx(static_cast<double>(samples.size())));
  CHECK(weighted == Approx(expected).epsilon(1e-6));
}

TEST_CASE("Noise does not decide how many sections a sweep of 90 degrees has", "[stroke_moments]") {
  Random random(54);
  const Chain chain = random_chain(3, 1, random);
  for (const double turn_deg : {89.999, 90.0, 90.001})
    for (const Sweep& sweep :
         as_sweeps(sweeps_of(chain, measured(turn_deg * kDegree, 100), random), 3, true)) {
      const auto stroke = moments_of(sweep, {*sweep.joint, 3, true});
      REQUIRE(stroke);
      CHECK(stroke->nodes.size() == 24);
      for (const StrokeMoments::Node& node : stroke->nodes) CHECK(node.sums(0, 0) > 0.3);
    }
}

TEST_CASE("Moments like a stroke's are its own first ones", "[stroke_moments]") {
  const bool told = GENERATE(false, true);
  const double turn_deg = GENERATE(30, 90, 300);
  CAPTURE(told, turn_deg);
  const auto sweeps = repeats(1, turn_deg * kDegree, told);
  const auto stroke = moments_of(sweeps.front(), {1, told ? std::size_t{3} : 0, true});
  REQUIRE(stroke);
  const auto same = moments_like(*stroke, sweeps.front());
  REQUIRE(same);
  CHECK_FALSE(same->squares);
  CHECK(same->samples == stroke->samples);
  CHECK(same->weight == Approx(stroke->weight).epsilon(1e-9));
  REQUIRE(same->nodes.size() == stroke->nodes.size());
  for (std::size_t k = 0; k < same->nodes.size(); ++k) {
    CHECK(same->nodes[k].turn_rad == stroke->nodes[k].turn_rad);
    const double size = stroke->nodes[k].sums.col(0).norm();
    CHECK((same->nodes[k].sums - stroke->nodes[k].sums.col(0)).norm() <= 1e-9 * size);
  }
}

TEST_CASE("The sum of repeats tells of all of them", "[stroke_moments]") {
  const bool told = GENERATE(false, true);
  CAPTURE(told);
  const auto sweeps = repeats(9, 90 * kDegree, told);
  const StrokeContent content{1, told ? std::size_t{3} : 0, true};
  const auto first = moments_of(sweeps.front(), content);
  REQUIRE(first);
  auto sum = moments_like(*first, sweeps[1]);
  REQUIRE(sum);
  for (std::size_t n = 2; n < sweeps.size(); ++n) {
    const auto next = moments_like(*first, sweeps[n]);
    REQUIRE(next);
    add(*sum, *next);
  }
  CHECK(sum->strokes == 8);
  CHECK(sum->samples == 3200);
  // By the samples themselves, all of which have their whole weight or nearly so.
  Eigen::VectorXd all = Eigen::VectorXd::Zero(4);
  double across = 0;
  for (std::size_t n = 1; n < sweeps.size(); ++n)
    for (const Sample& sample : *sweeps[n].samples) {
      const double x = first->zero_rad + first->sense * first->angle_about(sample.position_mm);
      const double f = std::cos(x + 0.3);
      const Vector3d off = first->departure(sample.position_mm, x);
      all(0) += f;
      all.segment<2>(1) += f * off.head<2>();
      if (told) all(3) += f * first->circle.radius_mm * first->sense * (x - sample.angles_rad[1]);
      across += f * f * off.head<2>().squaredNorm();
    }
  const Eigen::VectorXd found = modelled(*sum).head<4>();
  CHECK(found(0) == Approx(all(0)).epsilon(0.01));
  for (Index k = 1; k < 4; ++k) CHECK(std::abs(found(k) - all(k)) <= 0.3 * std::sqrt(across));
}

TEST_CASE("A stroke that covers another part of the arc is not like it", "[stroke_moments]") {
  const auto sweeps = repeats(2, 90 * kDegree, true);
  const auto first = moments_of(sweeps.front(), {1, 3, true});
  REQUIRE(first);
  const auto part = [&](std::size_t from, std::size_t to) {
    Sweep cut = sweeps[1];
    const auto begin = cut.samples->begin();
    cut.samples = std::make_shared<const std::vector<Sample>>(
        begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to));
    return cut;
  };
  CHECK(moments_like(*first, part(0, 400)));
  CHECK(moments_like(*first, part(1, 399)));
  CHECK_FALSE(moments_like(*first, part(0, 300)));
  CHECK_FALSE(moments_like(*first, part(100, 400)));
  CHECK_FALSE(moments_like(*first, part(0, 10)));
}

TEST_CASE("A stroke after something has moved is not like it", "[stroke_moments]") {
  const auto sweeps = repeats(2, 90 * kDegree, true);
  const auto first = moments_of(sweeps.front(), {1, 3, true});
  REQUIRE(first);
  const auto moved = [&](const Vector3d& by_mm, double locked_deg) {
    auto samples = *sweeps[1].samples;
    for (Sample& sample : samples) {
      sample.position_mm += by_mm;
      sample.angles_rad[2] += locked_deg * kDegree;
    }
    Sweep other = sweeps[1];
    other.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    return moments_like(*first, other).has_value();
  };
  CHECK(moved(Vector3d::Zero(), 0));
  CHECK(moved({0.02, 0.02, 0.02}, 0.002));
  // The device, or the target.
  CHECK_FALSE(moved({1, 0, 0}, 0));
  CHECK_FALSE(moved({0, 1, 0}, 0));
  CHECK_FALSE(moved({0, 0, 1}, 0));
  // A home elsewhere.
  CHECK_FALSE(moved(Vector3d::Zero(), 0.05));
}
