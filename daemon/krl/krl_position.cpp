#include "daemon/krl/krl_position.hpp"

#include <array>
#include <cmath>

#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {
namespace {

constexpr std::array<std::string_view, 6> kFrameFields = {"X", "Y", "Z", "A", "B", "C"};
/// No robot reaches as far, and no angle is as large, in mm and degrees.
constexpr double kMostOfRobots = 1e5;
constexpr int kFrameDecimals = 4;
constexpr double kNoTurn_rad = 2 * kDegree;

}  // namespace

double krl_number(const KrlAggregate& aggregate, std::string_view field) {
  const std::string who = aggregate.name.empty() ? "" : aggregate.name + ": ";
  const KrlField* found = aggregate.find(field);
  if (found == nullptr) throw KrlError(who + std::string(field) + " is missing: add it");
  const auto value = found->number();
  if (!value) throw KrlError(who + std::string(field) + " is no number: write one");
  if (std::abs(*value) > kMostOfRobots)
    throw KrlError(who + std::string(field) + " is too large for a robot: correct it");
  return *value;
}

Eigen::Isometry3d krl_frame(const KrlAggregate& aggregate) {
  identify::Sample sample;
  for (std::size_t k = 0; k < 3; ++k)
    sample.position_mm(static_cast<Eigen::Index>(k)) = krl_number(aggregate, kFrameFields[k]);
  for (std::size_t k = 0; k < 3; ++k)
    sample.abc_rad[k] = radians(krl_number(aggregate, kFrameFields[k + 3]));
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() = identify::orientation(sample);
  frame.translation() = sample.position_mm;
  return frame;
}

Eigen::Isometry3d krl_frame(std::string_view text) {
  return krl_frame(krl_aggregate(text));
}

std::string krl_frame_text(const Eigen::Isometry3d& frame) {
  const auto abc = identify::abc_of(frame.linear());
  std::string text = "{";
  for (std::size_t k = 0; k < 6; ++k) {
    const double value =
        k < 3 ? frame.translation()(static_cast<Eigen::Index>(k)) : degrees(abc[k - 3]);
    text.append(k == 0 ? "" : ",")
        .append(kFrameFields[k])
        .append(" ")
        .append(fixed(value, kFrameDecimals));
  }
  return text + "}";
}

double from_gimbal_deg(const Eigen::Matrix3d& rotation) {
  return degrees(std::atan2(std::hypot(rotation(0, 0), rotation(1, 0)), std::abs(rotation(2, 0))));
}

identify::Posture posture_of(unsigned status) {
  return {(status & 1U) != 0, (status & 2U) != 0, (status & 4U) != 0};
}

unsigned turn_of(const std::array<double, 6>& angles_rad) {
  unsigned turn = 0;
  for (std::size_t j = 0; j < 6; ++j)
    if (angles_rad[j] < 0) turn |= 1U << j;
  return turn;
}

std::array<double, 6> turned_as(std::array<double, 6> angles_rad, unsigned turn) {
  for (std::size_t j = 0; j < 6; ++j) {
    double& angle = angles_rad[j];
    const bool negative = (turn >> j & 1U) != 0;
    if (negative == (angle < 0) || std::abs(angle) < kNoTurn_rad) continue;
    angle += negative ? -2 * kPi : 2 * kPi;
  }
  return angles_rad;
}

}  // namespace sweepd
