#pragma once

#include <cstddef>
#include <vector>

#include "identify/clock/angle_tape.hpp"

namespace simulation {

/// A robot's program: moves and rests one after the other, as smooth as a controller makes them.
class Program {
 public:
  explicit Program(std::vector<double> home_rad);

  /// Joints go from where they are to these angles, and start and stop together.
  struct To {
    std::size_t joint;
    double deg;
  };
  Program& move(const std::vector<To>& to, double speed_deg_s);
  Program& rest(double seconds);
  /// From home to the start, to the end and home again, with rests between.
  Program& sweep(std::size_t joint, double half_deg, double speed_deg_s, double rest_s);

  [[nodiscard]] double seconds() const { return end_s_; }
  [[nodiscard]] identify::JointAngles angles_rad(double time_s) const;

 private:
  struct Move {
    double begin_s, seconds;
    identify::JointAngles from, to;
  };
  identify::JointAngles home_{}, at_{};
  std::vector<Move> moves_;
  double end_s_ = 0;
};

}  // namespace simulation
