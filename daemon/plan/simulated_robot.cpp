#include "daemon/plan/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kAxesOfRsi = 6;

// Of no robot's data sheet: sizes that such motors have.
constexpr std::array<double, kAxesOfRsi> kFriction_a = {1.2, 1.5, 1.0, 0.5, 0.4, 0.3};
constexpr double kWeight_a_m = 3;
constexpr double kCurrentNoise_a = 0.05;

void check(const RobotDescription& robot, const SweepPlan& plan) {
  const std::string name = "robot \"" + robot.name + "\": ";
  if (!robot.arm)
    throw ConfigError(name +
                      "[[joint]]: expected a specified table to move by, found none: add b_mm, "
                      "theta_deg, a_mm, alpha_deg and positive to every joint");
  if (robot.joints() > kAxesOfRsi)
    throw ConfigError(
        fmt::format("{}[[joint]]: expected at most 6 joints, as RSI carries no more, found {}: "
                    "sweeps of such an arm can be neither planned nor simulated, but "
                    "identified from a file of points",
                    name, robot.joints()));
  const auto findings = check_plan(plan, robot);
  if (findings.empty()) return;
  std::string text = findings.front();
  for (std::size_t i = 1; i < findings.size(); ++i) text += '\n' + findings[i];
  throw ConfigError(text);
}

// Written so that NaN fails.
void check(const SimulatedRobot::Options& options) {
  using std::chrono::milliseconds;
  if (options.cycle < milliseconds(1) || options.cycle > milliseconds(1000))
    throw std::invalid_argument(
        fmt::format("cycle: expected 1 to 1000 ms, found {}", options.cycle.count()));
  if (!(options.wobble_deg >= 0 && std::isfinite(options.wobble_deg)))
    throw std::invalid_argument("wobble: expected 0 degrees or more, found " +
                                number_text(options.wobble_deg));
  if (options.tool_mm && !options.tool_mm->allFinite())
    throw std::invalid_argument("tool point: expected three finite numbers");
}

}  // namespace

SimulatedRobot::SimulatedRobot(const RobotDescription& robot, const SweepPlan& plan,
                               const Options& options)
    : cycle_(options.cycle),
      wobble_deg_(options.wobble_deg),
      random_(options.seed),
      current_noise_(options.seed + 1),
      commanded_deg_(plan.home_deg),
      actual_deg_(plan.home_deg),
      angles_rad_(plan.home_deg.size()) {
  check(robot, plan);
  check(options);
  arm_ = *robot.arm;
  if (options.tool_mm) arm_.tool_mm = *options.tool_mm;

  const double dwell_s = std::chrono::duration<double>(plan.dwell).count();
  double time_s = dwell_s;
  const double acceleration_deg_s2 = plan.acceleration_deg_s2;
  for (const auto& sweep : plan.sweeps)
    for (const PlannedMove& move : moves_of(plan, sweep)) {
      const double way_deg = std::abs(move.to_deg - move.from_deg);
      if (way_deg == 0) continue;
      const double ramp_s = std::min(move.speed_deg_s / acceleration_deg_s2,
                                     std::sqrt(way_deg / acceleration_deg_s2));
      const double duration_s = way_deg / (acceleration_deg_s2 * ramp_s) + ramp_s;
      moves_.push_back({sweep.joint, move.from_deg, move.to_deg, time_s, ramp_s, duration_s});
      time_s += duration_s + dwell_s;
    }
  // The last cycle is the first one at rest; rounding must not add another.
  const double cycle_s = std::chrono::duration<double>(cycle_).count();
  cycles_ = static_cast<std::uint64_t>(std::ceil(time_s / cycle_s - 1e-6)) + 1;
}

double SimulatedRobot::Move::angle_deg(double time_s) const {
  // Braking mirrors speeding up, so both are reckoned from their own end.
  const double time = std::clamp(time_s - begin_s, 0.0, duration_s);
  const bool second_half = time > duration_s / 2;
  const double t = second_half ? duration_s - time : time;
  const double at_full_speed_s = t < ramp_s ? t * t / (2 * ramp_s) : t - ramp_s / 2;
  const double share = at_full_speed_s / (duration_s - ramp_s);
  return second_half ? to_deg + (from_deg - to_deg) * share
                     : from_deg + (to_deg - from_deg) * share;
}

bool SimulatedRobot::next(rsi::SignalValues& values) {
  if (next_cycle_ == cycles_) return false;
  const double time_s =
      std::chrono::duration<double>(cycle_).count() * static_cast<double>(next_cycle_++);
  const auto turn = [&] { commanded_deg_[joint() - 1] = moves_[move_].angle_deg(time_s); };
  turn();
  while (move_ + 1 < moves_.size() && time_s >= moves_[move_ + 1].begin_s) {
    ++move_;
    turn();
  }
  for (std::size_t i = 0; i < commanded_deg_.size(); ++i)
    actual_deg_[i] = commanded_deg_[i] + wobble_deg_ * gaussian(random_);
  fill(commanded_deg_, values.ASPos, values.RSol);
  fill(actual_deg_, values.AIPos, values.RIst);
  fill_currents(values.MACur, time_s);
  return true;
}

void SimulatedRobot::fill(const std::vector<double>& angles_deg, std::array<double, 6>& angles,
                          std::array<double, 6>& pose) {
  angles.fill(0);
  std::copy(angles_deg.begin(), angles_deg.end(), angles.begin());
  for (std::size_t i = 0; i < angles_deg.size(); ++i) angles_rad_[i] = radians(angles_deg[i]);
  const Eigen::Isometry3d frame = identify::forward_kinematics(arm_, angles_rad_);
  const Eigen::Vector3d tool = frame * arm_.tool_mm;
  const auto abc = kuka_abc_deg(frame.linear());
  pose = {tool.x(), tool.y(), tool.z(), abc[0], abc[1], abc[2]};
}

std::chrono::milliseconds SimulatedRobot::duration() const {
  return cycle_ * (cycles_ - 1);
}

void SimulatedRobot::fill_currents(std::array<double, 6>& currents, double time_s) {
  currents.fill(0);
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  std::array<Eigen::Vector3d, kAxesOfRsi> axes, points;
  for (std::size_t j = 0; j < commanded_deg_.size(); ++j) {
    axes.at(j) = arm_.positive[j] * frame.linear().col(2);
    points.at(j) = frame.translation();
    frame = frame * transform(arm_.row_at(j, radians(commanded_deg_[j])));
  }
  const Eigen::Vector3d tool = frame * arm_.tool_mm;
  for (std::size_t j = 0; j < commanded_deg_.size(); ++j) {
    if (arm_.is_linear(j)) continue;
    // How fast the mass rises as the joint turns.
    const double lever_m = axes.at(j).cross(tool - points.at(j)).z() / 1000;
    currents.at(j) = kWeight_a_m * lever_m + kCurrentNoise_a * gaussian(current_noise_);
  }
  const Move& move = moves_[move_];
  const bool moves = time_s > move.begin_s && time_s < move.begin_s + move.duration_s;
  if (moves)
    currents.at(move.joint - 1) += move.to_deg > move.from_deg ? kFriction_a.at(move.joint - 1)
                                                               : -kFriction_a.at(move.joint - 1);
}

double SimulatedRobot::gaussian(std::mt19937_64& random) {
  // Box and Muller. Not std::normal_distribution, whose numbers depend on the library.
  const auto uniform = [&] { return static_cast<double>((random() >> 11) + 1) * 0x1p-53; };
  const double radius = std::sqrt(-2 * std::log(uniform()));
  return radius * std::cos(2 * kPi * uniform());
}

std::array<double, 3> kuka_abc_deg(const Eigen::Matrix3d& rotation) {
  const auto& r = rotation;
  // C from Rz(-A) R = Ry(B) Rx(C): fits A also where A is arbitrary.
  const double a = std::atan2(r(1, 0), r(0, 0));
  const double b = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const double c = std::atan2(std::sin(a) * r(0, 2) - std::cos(a) * r(1, 2),
                              std::cos(a) * r(1, 1) - std::sin(a) * r(0, 1));
  return {degrees(a), degrees(b), degrees(c)};
}

}  // namespace sweepd
