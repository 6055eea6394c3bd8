#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include "identify/sweeps/sample.hpp"
#include "identify/sweeps/window.hpp"

namespace sweepd {

/// Motor currents of one telegram, joint 1 first, in what the controller tells them in: ampere by
/// KUKA's RSI. Not a number where one is missing.
inline constexpr std::size_t kMostCurrents = 6;
using Currents = std::array<double, kMostCurrents>;
inline constexpr double kNoCurrent = std::numeric_limits<double>::quiet_NaN();

/// What motors took while their joint alone moved at a steady speed: by the joint's angle and its
/// direction. Half the difference of the two directions is friction, their mean is weight. Memory
/// is bounded by the joints' ranges, whatever the stream's length. One thread.
class JointCurrents {
 public:
  /// Values of one direction at one place.
  struct Mean {
    std::size_t count = 0;
    double sum = 0;
    void add(double value) {
      ++count;
      sum += value;
    }
    [[nodiscard]] double value() const { return sum / static_cast<double>(count); }
  };
  struct Place {
    Mean rising, falling;
    [[nodiscard]] bool both() const { return rising.count > 0 && falling.count > 0; }
    [[nodiscard]] double friction() const { return (rising.value() - falling.value()) / 2; }
  };
  /// Of one joint, by its whole degree (mm of a linear one), rounded down.
  struct Joint {
    std::map<int, Place> places;
    Mean speed_deg_s;

    /// Over the places that were passed in both directions.
    struct Friction {
      std::size_t places = 0;
      double mean = 0;     ///< without its sign, which is a matter of how the motor is mounted
      double scatter = 0;  ///< standard deviation from place to place
    };
    [[nodiscard]] Friction friction() const;
  };

  /// In the order of time; samples without angles are passed over.
  void take(const identify::Sample& sample, const Currents& currents);
  /// One a joint that has any; empty: the stream has no currents.
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }

 private:
  struct Moment {
    identify::Sample sample;
    Currents currents{};
  };
  void look(const Moment& before, const Moment& middle, const Moment& now);

  identify::Window<Moment> recent_;
  std::size_t middle_ = 0;  // the last one of recent_ that is a span old
  std::vector<Joint> joints_;
};

}  // namespace sweepd
