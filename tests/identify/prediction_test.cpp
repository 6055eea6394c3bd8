#include "identify/prediction.hpp"

#include <array>
#include <cmath>
#include <memory>

#include "identify/geometry/angle.hpp"
#include "tests/catch.hpp"
#include "tests/identify/simulated_campaign.hpp"

using namespace identify;

namespace {

constexpr double kDevice_mm = 0.02;
constexpr std::array kNumbers{&DhEstimate::b_mm, &DhEstimate::theta_rad, &DhEstimate::a_mm,
                              &DhEstimate::alpha_rad, &DhEstimate::beta_rad};

identify::Campaign settings(const Arm& arm = test::kr5_arc()) {
  identify::Campaign campaign;
  campaign.specified = arm;
  campaign.declared_home_rad = arm.home_rad;
  return campaign;
}

/// Strokes as a device measures them: joints are known, angles not.
std::vector<Sweep> measured(const test::Campaign& campaign) {
  std::vector<Sweep> sweeps = test::segment(campaign.samples());
  for (Sweep& sweep : sweeps)
    sweep.samples =
        std::make_shared<const std::vector<Sample>>(test::without_angles(*sweep.samples));
  return sweeps;
}

Prediction predicted(const std::vector<Sweep>& sweeps, const identify::Campaign& campaign) {
  return predict(identify::identify(sweeps, campaign), campaign,
                 device_noise(kDevice_mm, 0, campaign.joints));
}

template <class See>
void compare(const std::vector<DhEstimate>& a, const std::vector<DhEstimate>& b, const See& see) {
  REQUIRE(a.size() == b.size());
  int identified = 0;
  for (std::size_t j = 0; j < a.size(); ++j)
    for (std::size_t k = 0; k < kNumbers.size(); ++k) {
      INFO("row " << j + 1 << ", number " << k);
      const DhNumber& first = a[j].*kNumbers[k];
      const DhNumber& second = b[j].*kNumbers[k];
      CHECK(first.knowledge == second.knowledge);
      CHECK((first.sigma > 0) == (first.knowledge == Knowledge::identified));
      if (first.knowledge != Knowledge::identified) continue;
      ++identified;
      see(first.sigma, second.sigma);
    }
  CHECK(identified > 10);
}

}  // namespace

TEST_CASE("a prediction names and states what the result of such data does", "[prediction][long]") {
  for (const bool device_frame : {false, true}) {
    test::Campaign campaign(test::kr5_arc(), {0, kDevice_mm, 3});
    campaign.sweep_all_90();
    auto known = settings();
    known.device_frame = device_frame;
    const auto result = identify::identify(measured(campaign), known);
    REQUIRE(result.status == Status::complete);
    const auto prediction = predict(result, known, device_noise(kDevice_mm, 0, known.joints));
    // The result's own sigma comes from the noise that it finds in some 20,000 coordinates, which
    // scatters by 0.5 %, times a correlation that it takes for real: up to 10 %.
    compare(prediction.dh, result.dh, [](double expected, double stated) {
      CHECK(stated / expected > 0.97);
      CHECK(stated / expected < 1.12);
    });
    CHECK(prediction.dh[0].b_mm.knowledge ==
          (device_frame ? Knowledge::by_convention : Knowledge::identified));
    CHECK(prediction.dh[1].b_mm.knowledge == Knowledge::by_convention);  // parallel axes
    CHECK(prediction.dh[5].a_mm.knowledge == Knowledge::by_convention);
    for (std::size_t j = 0; j < 6; ++j)  // the specified table
      CHECK(std::abs(prediction.dh[j].a_mm.value - test::kr5_arc().rows[j].a_mm) < 1e-9);
  }
}

TEST_CASE("every sweep twice: uncertainties fall by the square root of two", "[prediction][long]") {
  const auto sweep_all = [](test::Campaign& campaign) { campaign.sweep_all_90(); };
  test::Campaign once(test::kr5_arc(), {0, kDevice_mm, 1});
  sweep_all(once);
  test::Campaign twice(test::kr5_arc(), {0, kDevice_mm, 1});
  sweep_all(twice);
  sweep_all(twice);
  // The strokes of the second round are cut a sample or two elsewhere, as noise decides.
  compare(predicted(measured(once), settings()).dh, predicted(measured(twice), settings()).dh,
          [](double one, double two) { CHECK(std::abs(one / two - std::sqrt(2.0)) < 0.02); });
}

TEST_CASE("what the data will not tell gets no uncertainty", "[prediction][long]") {
  SECTION("the target on axis 6") {
    Arm arm = test::kr5_arc();
    for (const double off_mm : {0.0, 0.5}) {
      arm.tool_mm = {off_mm, 0, 215};
      test::Campaign campaign(arm, {0, kDevice_mm, 1});
      campaign.sweep_all_90();
      const auto prediction = predicted(measured(campaign), settings(arm));
      CHECK_FALSE(prediction.axes[5]);
      CHECK(std::abs(prediction.radius_mm[5] - off_mm) < 1e-9);
      CHECK(prediction.axes[4]);
      CHECK(prediction.dh[4].alpha_rad.knowledge == Knowledge::undetermined);
      for (const auto number : kNumbers) CHECK((prediction.dh[4].*number).sigma == 0);
    }
  }
  SECTION("a joint that is not swept") {
    test::Campaign campaign(test::kr5_arc(), {0, kDevice_mm, 1});
    campaign.rest()
        .sweep(0, -45, 45)
        .sweep(1, -60, -130)
        .sweep(3, 90, 0)
        .sweep(4, 90, 0)
        .sweep(5, 0, 90);
    const auto prediction = predicted(measured(campaign), settings());
    CHECK_FALSE(prediction.axes[2]);
    CHECK(prediction.dh[1].a_mm.knowledge == Knowledge::undetermined);
    CHECK(prediction.dh[2].a_mm.knowledge == Knowledge::undetermined);
    CHECK(prediction.dh[3].a_mm.knowledge == Knowledge::identified);
  }
  SECTION("nothing at all") {
    const auto prediction = predicted({}, settings());
    CHECK(prediction.dh.size() == 6);
    for (std::size_t j = 0; j < 6; ++j) {
      CHECK_FALSE(prediction.axes[j]);
      CHECK(prediction.dh[j].a_mm.knowledge == Knowledge::undetermined);
    }
  }
}

TEST_CASE("printed angles scatter by their rounding, a resting joint's by no more than it wobbles",
          "[prediction]") {
  const double step = 1e-4 * kDegree;
  const double rounding = step / std::sqrt(12.0);
  const auto locked = [&](double wobble) {
    return printed_noise({1e-4, step}, wobble, 6).locked_rad;
  };
  const auto noise = printed_noise({1e-4, step}, 0, 6);
  CHECK(std::abs(noise.position_mm - 1e-4 / std::sqrt(12.0)) < 1e-12);
  CHECK(std::abs(noise.swept_rad[5] - rounding) < 1e-9 * rounding);
  CHECK(locked(0) < 0.03 * rounding);  // the series ends after 100 terms
  CHECK(std::abs(locked(step / 20) - step / 20) < 0.01 * step / 20);
  CHECK(std::abs(locked(step) - rounding) < 1e-6 * rounding);
  CHECK(std::abs(locked(100 * step) - rounding) < 1e-9 * rounding);

  const auto device = device_noise(0.02, step, 6);
  CHECK(device.position_mm == 0.02);
  CHECK(device.locked_rad == step);
  for (const double swept : device.swept_rad) CHECK(std::isinf(swept));
}
