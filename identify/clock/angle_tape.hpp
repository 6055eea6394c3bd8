#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "identify/sweeps/sample.hpp"

namespace identify {

using JointAngles = std::array<double, kMostJoints>;

/// The angles of all joints as a controller told them, by its clock. Bounded: where there are more,
/// every second one goes.
class AngleTape {
 public:
  /// An hour of telegrams at 4 ms; 104 bytes each.
  static constexpr std::size_t kMost = 1'000'000;

  explicit AngleTape(std::size_t joints, std::size_t most = kMost) : joints_(joints), most_(most) {}

  /// In order of time; samples without all angles, and those out of order, are passed over.
  void add(const Sample& sample);

  [[nodiscard]] std::size_t joints() const { return joints_; }
  [[nodiscard]] std::size_t size() const { return time_s_.size(); }
  [[nodiscard]] const std::vector<double>& time_s() const { return time_s_; }
  [[nodiscard]] const JointAngles& angles_rad(std::size_t i) const { return angles_rad_[i]; }

  /// Between the samples by the cubic through the nearest four. Nothing outside the tape, and in
  /// gaps of more than kLongestGap_s.
  [[nodiscard]] std::optional<JointAngles> at(double time_s) const;
  /// The mean over the samples of this time; nothing where there are none.
  [[nodiscard]] std::optional<JointAngles> mean(double from_s, double to_s) const;

 private:
  void halve();

  std::size_t joints_;
  std::size_t most_;
  std::size_t stride_ = 1;  // of those told, every n-th is kept
  std::size_t told_ = 0;
  std::vector<double> time_s_;
  std::vector<JointAngles> angles_rad_;
};

}  // namespace identify
