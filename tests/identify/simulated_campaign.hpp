#pragma once

// A KR 5 arc that sweeps its joints one after the other, for tests of the numerics. Noise is a
// wobble of every joint, as on a controller whose positions are computed from its encoders.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "identify/dh/dh.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/segmentation.hpp"

namespace identify::test {

using Change = std::function<void(Sweep&, std::vector<Sample>&)>;

/// The sweeps with all samples gone through it.
inline std::vector<Sweep> changed(std::vector<Sweep> sweeps, const Change& change) {
  for (Sweep& sweep : sweeps) {
    auto samples = *sweep.samples;
    change(sweep, samples);
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  }
  return sweeps;
}

/// The paper's specified table; thetas at the paper's home.
inline Arm kr5_arc() {
  Arm arm;
  const auto row = [&](double b, double theta_deg, double a, double alpha_deg) {
    arm.rows.push_back({b, theta_deg * kDegree, a, alpha_deg * kDegree});
  };
  row(400, -90, 180, 90);
  row(0, 90, 600, 0);
  row(0, 0, 120, 90);
  row(620, 180, 0, 90);
  row(0, 90, 0, 90);
  row(0, 180, 0, 0);
  for (const double home : {90, -90, 90, 0, 90, 0}) arm.home_rad.push_back(home * kDegree);
  arm.positive.assign(6, -1);
  arm.tool_mm = {200, 0, 215};
  return arm;
}

struct Noise {
  double wobble_deg = 0;
  double position_mm = 0;  ///< of a measuring device, isotropic
  std::uint32_t seed = 1;
};

/// Moves joints and samples them every 4 ms.
class Campaign {
 public:
  explicit Campaign(Arm arm, Noise noise = {})
      : arm_(std::move(arm)), noise_(noise), random_(noise.seed), angles_(arm_.home_rad) {}

  /// One joint, with soft start and stop, at `speed_deg_s` on average.
  Campaign& move(std::size_t joint, double to_deg, double speed_deg_s = 20) {
    return move_all({{joint, to_deg}}, speed_deg_s);
  }

  struct Target {
    std::size_t joint;
    double to_deg;
  };
  /// Several joints at once; they start and stop together.
  Campaign& move_all(const std::vector<Target>& targets, double speed_deg_s) {
    const auto from = angles_;
    double longest = 0;
    for (const auto& target : targets)
      longest = std::max(longest, std::abs(target.to_deg - from[target.joint] / kDegree));
    const int cycles = std::max(1, static_cast<int>(longest / speed_deg_s / 0.004));
    for (int k = 1; k <= cycles; ++k) {
      const double share = 0.5 - 0.5 * std::cos(kPi * k / cycles);
      for (const auto& target : targets)
        angles_[target.joint] =
            from[target.joint] + share * (target.to_deg * kDegree - from[target.joint]);
      sample();
    }
    return *this;
  }

  Campaign& rest(double seconds = 0.3) {
    for (int k = 0; k < seconds / 0.004; ++k) sample();
    return *this;
  }

  /// From home to the start, a sweep, and home again, with rests between.
  Campaign& sweep(std::size_t joint, double start_deg, double end_deg) {
    const double home = arm_.home_rad[joint] / kDegree;
    if (std::abs(angles_[joint] / kDegree - start_deg) > 1e-9) move(joint, start_deg, 60).rest();
    move(joint, end_deg).rest();
    if (end_deg != home) move(joint, home, 60).rest();
    return *this;
  }

  /// Table 2 of the paper.
  Campaign& sweep_all_90() {
    rest();
    return sweep(0, -45, 45)
        .sweep(1, -60, -130)
        .sweep(2, 120, 30)
        .sweep(3, 90, 0)
        .sweep(4, 90, 0)
        .sweep(5, 0, 90);
  }
  Campaign& sweep_all_30() {
    rest();
    return sweep(0, -15, 15)
        .sweep(1, -60, -90)
        .sweep(2, 120, 90)
        .sweep(3, 90, 60)
        .sweep(4, 90, 60)
        .sweep(5, 0, 30);
  }

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] const Arm& arm() const { return arm_; }

 private:
  void sample() {
    std::normal_distribution<> normal;
    Sample sample;
    sample.time_s = 0.004 * static_cast<double>(samples_.size());
    auto wobbling = angles_;
    for (auto& angle : wobbling) angle += noise_.wobble_deg * kDegree * normal(random_);
    sample.position_mm = forward_kinematics(arm_, wobbling) * arm_.tool_mm;
    for (Eigen::Index k = 0; k < 3; ++k)
      sample.position_mm(k) += noise_.position_mm * normal(random_);
    sample.has_position = true;
    sample.joints = static_cast<std::uint8_t>(wobbling.size());
    std::copy(wobbling.begin(), wobbling.end(), sample.angles_rad.begin());
    samples_.push_back(sample);
  }

  Arm arm_;
  Noise noise_;
  std::mt19937 random_;
  std::vector<double> angles_;
  std::vector<Sample> samples_;
};

/// Every stroke of a stream.
inline std::vector<Sweep> segment(const std::vector<Sample>& samples, Resolution resolution = {},
                                  std::size_t joints = 6) {
  Segmenter segmenter(joints);
  segmenter.set_resolution(resolution);
  std::vector<Sweep> sweeps;
  const auto take = [&](std::vector<Sweep> ended) {
    sweeps.insert(sweeps.end(), ended.begin(), ended.end());
  };
  for (const auto& sample : samples) take(segmenter.push(sample));
  take(segmenter.finish());
  return sweeps;
}

inline std::vector<Sample> without_angles(std::vector<Sample> samples) {
  for (auto& sample : samples) sample.joints = 0;
  return samples;
}

/// The last decimal of mm and degrees in a controller's telegrams.
inline constexpr double kPrinted = 1e-4;

inline double printed(double value) {
  return kPrinted * std::round(value / kPrinted);
}

/// What is known of a campaign with kr5_arc().
inline identify::Campaign for_kr5(double step = 0) {
  identify::Campaign campaign;
  campaign.specified = kr5_arc();
  campaign.resolution = {step, step * kDegree};
  return campaign;
}

inline const Warning* find_warning(const Identification& found, std::string_view code) {
  for (const Warning& warning : found.warnings)
    if (warning.code == code) return &warning;
  return nullptr;
}

}  // namespace identify::test
