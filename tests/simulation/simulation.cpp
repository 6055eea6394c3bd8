#include "tests/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/arc_shape.hpp"
#include "tests/simulation/device.hpp"
#include "tests/simulation/printed.hpp"
#include "tests/simulation/stream.hpp"

namespace simulation {
namespace {

using Eigen::Vector3d;

using identify::kArcsec;
using identify::kDegree;
using identify::kPi;

/// A linear unit comes home to hundredths of a millimetre where joints that turn do so to
/// thousandths of a degree; and a degree is a millimetre here.
constexpr double kLinearTimes = 10;

/// A, B, C of R = Rz(A) Ry(B) Rx(C).
std::array<double, 3> abc_of(const Eigen::Matrix3d& r) {
  return {std::atan2(r(1, 0), r(0, 0)), std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0))),
          std::atan2(r(2, 1), r(2, 2))};
}

/// Where a point is on its arc: radial, axial and tangential unit vectors.
Eigen::Matrix3d along_arc(const identify::Chain& chain, const identify::Turns& turns,
                          std::size_t joint, const Vector3d& point) {
  identify::Turns before{};
  std::copy_n(turns.begin(), joint, before.begin());
  const Eigen::Isometry3d moved = chain.displacement(before);
  const Vector3d axial = moved.linear() * chain.axes[joint].direction;
  const Vector3d from = point - moved * chain.axes[joint].point_mm;
  const Vector3d radial = (from - axial * axial.dot(from)).normalized();
  Eigen::Matrix3d ways;
  ways << radial, axial, axial.cross(radial);
  return ways;
}

}  // namespace

Simulation::Simulation(Robot robot, Strokes strokes, World world, std::uint32_t seed)
    : robot_(std::move(robot)),
      how_(std::move(strokes)),
      world_(world),
      seed_(seed),
      chain_(chain_of(robot_)),
      sag_(robot_, world.sag_arcsec * kArcsec),
      homes_(homes_of(how_, robot_, seed)) {
  if (world_.placed) base_ = random_place(seed);
  auto random = stream(world_.gears.seed.value_or(seed), Source::gears);
  std::uniform_real_distribution<> phase(-kPi, kPi);
  for (std::size_t j = 0; j < robot_.arm.joints(); ++j) {
    const double first = phase(random);
    phases_.push_back({first, phase(random)});
  }
  sides_.assign(robot_.arm.joints(), 1);
  if (world_.gears.play_as_left)
    for (int& side : sides_) side = phase(random) > 0 ? 1 : -1;
}

identify::Turns Simulation::turns_at(const std::vector<double>& angles,
                                     const std::vector<int>& sides) const {
  identify::Turns turns{};
  const Gears& gears = world_.gears;
  for (std::size_t k = 0; k < angles.size(); ++k) {
    turns[k] = angles[k] - robot_.arm.home_rad[k];
    if (world_.controller || k != gears.joint.value_or(k)) continue;
    turns[k] += kArcsec * (gears.first_arcsec * std::sin(angles[k] + phases_[k][0]) +
                           gears.second_arcsec * std::sin(2 * angles[k] + phases_[k][1]) -
                           0.5 * gears.backlash_arcsec * sides[k]);
  }
  if (world_.sag_arcsec > 0 && !world_.controller) {
    const identify::Turns bent = sag_.at(turns);
    for (std::size_t k = 0; k < angles.size(); ++k) turns[k] += bent[k];
  }
  return turns;
}

identify::Arm Simulation::arm_at(const std::vector<double>& angles) const {
  const identify::Turns turns =
      turns_at(angles, std::vector<int>(angles.size(), world_.gears.play_as_left ? 0 : 1));
  identify::Arm arm = robot_.arm;
  for (std::size_t k = 0; k < angles.size(); ++k)
    if (arm.is_linear(k))
      arm.rows[k].b_mm += identify::kLinear_mm * arm.positive[k] * turns[k];
    else
      arm.rows[k].theta_rad += arm.positive[k] * turns[k];
  arm.home_rad = angles;
  return arm;
}

std::vector<identify::Sweep> Simulation::sweeps() const {
  const std::size_t joints = robot_.arm.joints();
  const auto strokes = strokes_of(how_, joints, robot_.targets_mm.size());
  const double seconds = strokes.back().start_s + strokes.back().seconds;
  Device device(world_.noise, world_.drift, seconds, seed_);
  auto home_errors = stream(seed_, Source::home_error);
  auto creeps = stream(seed_, Source::creep);
  auto strays = stream(seed_, Source::stray);
  auto settles = stream(seed_, Source::settle);
  auto wobble = stream(seed_, Source::wobble);
  auto shapes = stream(seed_, Source::shape);
  std::normal_distribution<> normal;
  std::map<std::pair<std::size_t, std::size_t>, ArcCurve> curves;  // joint and home
  std::vector<double> stray(joints, 0.0);
  std::vector<double> errors(joints, 0.0), creep(joints, 0.0);
  std::vector<bool> anew(joints, true);
  std::vector<int> sides = sides_;
  std::vector<identify::Sweep> sweeps;
  for (const Stroke& stroke : strokes) {
    const std::size_t j = stroke.joint;
    const double low = std::min(stroke.from_rad, stroke.to_rad);
    const double high = std::max(stroke.from_rad, stroke.to_rad);
    const ArcCurve& curve =
        curves.try_emplace({j, stroke.home}, world_.shape, low, high, shapes).first->second;
    std::vector<double> locked = homes_[stroke.home];  // where the encoders stand
    std::vector<double> play(joints, 0.0);             // what they do not see
    for (std::size_t k = 0; k < joints; ++k) {
      const bool none = k == j || world_.home.joint.value_or(k) != k;
      const double degree = (robot_.arm.is_linear(k) ? kLinearTimes : 1) * kDegree;
      if (none)
        errors[k] = 0;
      else if (anew[k])
        errors[k] = world_.home.sigma_deg * degree * normal(home_errors);
      if (!none) anew[k] = false;
      if (world_.home.creep_deg > 0)
        creep[k] = none ? 0 : world_.home.creep_deg * degree * normal(creeps);
      locked[k] += stray[k];
      (world_.home.seen || world_.controller ? locked[k] : play[k]) += errors[k];
    }
    if (world_.gears.settles_deg > 0)
      play[j] += world_.gears.settles_deg * kDegree * normal(settles);
    sides[j] = stroke.direction();
    for (std::size_t k = 0; k < joints; ++k)
      if (k == j || world_.home.lasts == identify::HomeLasts::stroke ||
          (world_.home.lasts == identify::HomeLasts::stand && stroke.last_of_joint))
        anew[k] = true;
    std::vector<std::vector<identify::Sample>> seen(stroke.targets.size());
    device.begin();
    for (int i = 0; i < how_.samples; ++i) {
      const int places = how_.stops > 0 ? how_.stops : how_.samples;
      const int place = i * places / how_.samples;
      const double time = stroke.seconds * place / (places - 1);
      std::vector<double> angles = locked;
      angles[j] = homes_[stroke.home][j] + stroke.turn_at(time, how_.ramp);
      if (how_.along && how_.along->swept == j)
        angles[how_.along->joint] +=
            (how_.along->from_deg + how_.along->by_deg * time / stroke.seconds) * kDegree;
      if (world_.wobble_deg > 0)
        for (double& angle : angles) angle += world_.wobble_deg * kDegree * normal(wobble);
      identify::Turns turns = turns_at(angles, sides);
      for (std::size_t k = 0; k < joints; ++k)
        turns[k] += play[k] + creep[k] * time / stroke.seconds;
      const Eigen::Isometry3d moved = chain_.displacement(turns);

      identify::Sample sample;
      const double taken_s = stroke.start_s + stroke.seconds * i / (how_.samples - 1);
      sample.time_s = printed(taken_s, world_.time_decimals);
      sample.has_position = true;
      if (world_.angles) {
        const double late =
            world_.delay.late_s + 1e-6 * world_.delay.rate_ppm * (stroke.start_s + time);
        angles[j] += stroke.turn_at(time - late, how_.ramp) - stroke.turn_at(time, how_.ramp);
        sample.joints = static_cast<std::uint8_t>(joints);
        for (std::size_t k = 0; k < joints; ++k)
          sample.angles_rad[k] = printed(angles[k] / kDegree, world_.decimals) * kDegree;
      }
      if (world_.orientations) {
        sample.has_orientation = true;
        sample.abc_rad = abc_of(base_.linear() * moved.linear() * chain_.tool);
        for (double& angle : sample.abc_rad)
          angle = printed(angle / kDegree, world_.decimals) * kDegree;
      }
      for (std::size_t n = 0; n < stroke.targets.size(); ++n) {
        Vector3d point = moved * chain_.targets_mm[stroke.targets[n]];
        if (world_.shape.rms_mm > 0)
          point +=
              along_arc(chain_, turns, j, point) * curve.at(angles[j] - homes_[stroke.home][j]);
        sample.position_mm = device.measured(base_ * point, sample.time_s);
        if (world_.controller)
          for (double& value : sample.position_mm) value = printed(value, world_.decimals);
        seen[n].push_back(sample);
      }
    }
    for (std::size_t n = 0; n < stroke.targets.size(); ++n) {
      identify::Sweep sweep;
      sweep.samples = std::make_shared<const std::vector<identify::Sample>>(std::move(seen[n]));
      sweep.joint = j;
      sweep.target = stroke.targets[n];
      sweep.direction = stroke.direction();
      sweep.range_rad = high - low;
      sweeps.push_back(sweep);
    }
    if (world_.gears.play_as_left && stroke.to_rad != 0)
      sides[j] = stroke.to_rad < 0 ? 1 : -1;  // home from there
    else if (!world_.gears.play_as_left)
      sides[j] = 1;
    if (stroke.last_of_joint && world_.home.stray_sigma_deg > 0)
      stray[j] = world_.home.stray_sigma_deg * kDegree * normal(strays);
  }
  return sweeps;
}

identify::Campaign Simulation::campaign() const {
  identify::Campaign campaign;
  campaign.joints = robot_.arm.joints();
  campaign.specified = robot_.specified;
  campaign.resolution.position_mm =
      print_step(world_.controller ? world_.decimals : world_.noise.decimals);
  campaign.resolution.angle_rad = world_.angles ? print_step(world_.decimals) * kDegree : 0;
  campaign.declared_home_rad = robot_.arm.home_rad;
  campaign.device_frame = world_.placed;
  campaign.up = robot_.up;
  if (world_.sag_told) {
    campaign.sag_rad.assign(campaign.joints, 0);
    for (const std::size_t j : robot_.elastic) campaign.sag_rad[j] = world_.sag_arcsec * kArcsec;
  }
  return campaign;
}

}  // namespace simulation
