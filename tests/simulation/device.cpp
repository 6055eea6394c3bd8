#include "tests/simulation/device.hpp"

#include <cmath>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/printed.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {

using Eigen::Vector3d;

namespace {

constexpr double kLever_mm = 3000;

Vector3d unit3(std::mt19937_64& random) {
  std::normal_distribution<> normal;
  const double x = normal(random), y = normal(random);
  return Vector3d(x, y, normal(random)).normalized();
}

}  // namespace

Device::Device(const Noise& noise, const Drift& drift, double seconds, std::uint32_t seed)
    : noise_(noise),
      drift_(drift),
      seconds_(seconds),
      random_(stream(seed, Source::noise)),
      outliers_(stream(seed, Source::outliers)),
      wandering_(stream(seed, Source::drift)),
      way_(normal3(wandering_).normalized()) {
  auto random = stream(seed, Source::move);
  move_ = unit3(random);
  turn_ = unit3(random);
}

Vector3d Device::measured(const Vector3d& point, double time_s) {
  const double part = time_s / seconds_;
  if (fresh_ && part >= drift_.moved_at) moved_mm_ = drift_.moved_mm;
  const double old = fresh_ ? 0 : noise_.correlation;
  fresh_ = false;
  Vector3d seen = point;
  if (noise_.range_mm > 0 || noise_.across_mm > 0) {
    error_ = old * error_ + std::sqrt(1 - old * old) * normal3(random_);
    seen += noise_.across_mm * error_;
    if (noise_.range_mm != noise_.across_mm) {
      const Vector3d sight = point.normalized();
      seen += (noise_.range_mm - noise_.across_mm) * sight.dot(error_) * sight;
    }
  }
  if (noise_.outlier_share > 0 &&
      std::uniform_real_distribution<>()(outliers_) < noise_.outlier_share)
    seen += noise_.outlier_mm * normal3(outliers_).normalized();
  if (drift_.walk_mm > 0) {
    const double sigma = drift_.walk_mm / std::sqrt(3.0);
    wandered_mm_ += sigma * std::sqrt((time_s - time_s_) / seconds_) * normal3(wandering_);
    time_s_ = time_s;
  }
  constexpr double kWarm = 0.2;
  seen += wandered_mm_ + (drift_.linear_mm * part +
                          drift_.sway_mm * std::sin(2 * identify::kPi * drift_.sways * part) +
                          drift_.warm_mm * (1 - std::exp(-part / kWarm))) *
                             way_;
  seen += moved_mm_ * (move_ + turn_.cross(seen) / kLever_mm);
  for (double& value : seen) value = printed(value, noise_.decimals);
  return seen;
}

Vector3d Device::normal3(std::mt19937_64& random) {
  const double x = normal_(random);
  const double y = normal_(random);
  return {x, y, normal_(random)};
}

Eigen::Isometry3d random_place(std::uint32_t seed) {
  auto random = stream(seed, Source::place);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  using identify::kPi;
  const double bearing = between(-kPi, kPi);
  const double away = between(2500, 4000);
  const double turn = between(-kPi, kPi);
  const double tilt = between(-0.1, 0.1);
  return Eigen::Isometry3d(
      Eigen::Translation3d(away * std::cos(bearing), away * std::sin(bearing), between(-1500, 0)) *
      Eigen::AngleAxisd(tilt, Vector3d(std::cos(turn), std::sin(turn), 0)) *
      Eigen::AngleAxisd(turn, Vector3d::UnitZ()));
}

}  // namespace simulation
