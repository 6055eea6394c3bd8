#include "tests/simulation/program.hpp"

#include <algorithm>
#include <cmath>

#include "identify/geometry/angle.hpp"

namespace simulation {

using identify::kDegree;

namespace {

constexpr double kRamp_s = 0.12;  ///< up to speed, and down to rest

}  // namespace

Program::Program(std::vector<double> home_rad) {
  std::copy(home_rad.begin(), home_rad.end(), home_.begin());
  at_ = home_;
}

Program& Program::move(const std::vector<To>& to, double speed_deg_s) {
  Move move{end_s_, 0, at_, at_};
  double most = 0;
  for (const To& one : to) {
    move.to[one.joint] = one.deg * kDegree;
    most = std::max(most, std::abs(move.to[one.joint] - at_[one.joint]) / kDegree);
  }
  if (most < 1e-9) return *this;
  move.seconds = std::max(2 * kRamp_s, most / speed_deg_s + kRamp_s);
  end_s_ += move.seconds;
  at_ = move.to;
  moves_.push_back(move);
  return *this;
}

Program& Program::rest(double seconds) {
  end_s_ += seconds;
  return *this;
}

Program& Program::sweep(std::size_t joint, double half_deg, double speed_deg_s, double rest_s) {
  const double home = home_[joint] / kDegree;
  const double way = joint % 2 == 0 ? half_deg : -half_deg;
  return move({{joint, home - way}}, 3 * speed_deg_s)
      .rest(rest_s)
      .move({{joint, home + way}}, speed_deg_s)
      .rest(rest_s)
      .move({{joint, home}}, 3 * speed_deg_s)
      .rest(rest_s);
}

identify::JointAngles Program::angles_rad(double time_s) const {
  const auto after =
      std::upper_bound(moves_.begin(), moves_.end(), time_s,
                       [](double time, const Move& move) { return time < move.begin_s; });
  if (after == moves_.begin()) return home_;
  const Move& move = *std::prev(after);
  const double ramp = kRamp_s / move.seconds;
  const double x = std::clamp((time_s - move.begin_s) / move.seconds, 0.0, 1.0);
  const double end = std::min(x, 1 - x);
  const double gone = end < ramp ? end * end / (2 * ramp) : end - ramp / 2;
  const double share = (x < 0.5 ? gone : 1 - ramp - gone) / (1 - ramp);
  identify::JointAngles angles = move.from;
  for (std::size_t j = 0; j < angles.size(); ++j) angles[j] += share * (move.to[j] - move.from[j]);
  return angles;
}

}  // namespace simulation
