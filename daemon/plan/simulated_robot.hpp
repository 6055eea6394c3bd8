#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "rsi/telegram/telegram_writer.hpp"

namespace sweepd {

/// By how much a joint wobbles where nobody says otherwise, standard deviation; and the most that
/// can be meant.
inline constexpr double kUsualWobble_deg = 1e-4, kMostWobble_deg = 1;

/// A robot that runs a sweep plan: says cycle by cycle where it is. Each move takes its joint with
/// the plan's acceleration to the wanted speed, and back to rest; one that is too short for that
/// turns from speeding up to braking half way.
///
/// The commanded angles follow the plan exactly. The actual ones wobble about them, as servos do:
/// Gaussian, independent from joint to joint and cycle to cycle. Poses are those of the tool point
/// in the robot's base, with the orientation of the frame after the last row; the actual one comes
/// from the actual angles. Motors take a current against Coulomb friction and against the weight of
/// a point mass at the tool point, with some noise.
class SimulatedRobot {
 public:
  struct Options {
    std::chrono::milliseconds cycle = rsi::kUsualCycle;  ///< 1 to 1000
    double wobble_deg = kUsualWobble_deg;                ///< standard deviation
    std::uint64_t seed = 1;                  ///< the same seed wobbles the same way again
    std::optional<Eigen::Vector3d> tool_mm;  ///< in place of the description's
  };

  /// Throws ConfigError if the robot has no specified table, more joints than RSI carries, or
  /// cannot do the plan; std::invalid_argument for wrong options.
  SimulatedRobot(const RobotDescription& robot, const SweepPlan& plan, const Options& options);

  /// Fills in RIst, RSol, AIPos, ASPos and MACur of the next cycle; false after the last one. The
  /// first and the last see the robot at the plan's home. Joints that it does not have are zero.
  [[nodiscard]] bool next(rsi::SignalValues& values);

  /// How often next() gives a cycle in all.
  [[nodiscard]] std::uint64_t cycles() const { return cycles_; }
  /// From the first cycle to the last.
  [[nodiscard]] std::chrono::milliseconds duration() const;
  /// The joint that moves, or the one that moved last; from 1.
  [[nodiscard]] std::size_t joint() const { return moves_[move_].joint; }

 private:
  struct Move {
    std::size_t joint;  // from 1
    double from_deg;
    double to_deg;
    double begin_s;
    double ramp_s;  // speeding up; braking takes as long
    double duration_s;

    [[nodiscard]] double angle_deg(double time_s) const;
  };

  void fill(const std::vector<double>& angles_deg, std::array<double, 6>& angles,
            std::array<double, 6>& pose);
  void fill_currents(std::array<double, 6>& currents, double time_s);
  static double gaussian(std::mt19937_64& random);

  identify::Arm arm_;
  std::chrono::milliseconds cycle_;
  double wobble_deg_;
  std::mt19937_64 random_;
  std::mt19937_64 current_noise_;  // its own: what is moved stays the same without currents
  std::vector<Move> moves_;
  std::uint64_t cycles_ = 0;

  std::uint64_t next_cycle_ = 0;
  std::size_t move_ = 0;  // the current one; a rest belongs to the move before it
  std::vector<double> commanded_deg_;
  std::vector<double> actual_deg_;
  std::vector<double> angles_rad_;
};

/// KUKA's A, B, C in degrees of a rotation R = Rz(A) Ry(B) Rx(C); A and C are one of their many
/// pairs where B is +-90.
[[nodiscard]] std::array<double, 3> kuka_abc_deg(const Eigen::Matrix3d& rotation);

}  // namespace sweepd
