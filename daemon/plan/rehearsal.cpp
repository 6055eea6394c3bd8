#include "daemon/plan/rehearsal.hpp"

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/pipeline.hpp"
#include "daemon/text/units.hpp"
#include "rsi/telegram/telegram_writer.hpp"

namespace sweepd {
namespace {

using identify::Sample;
using identify::Sweep;

rsi::TelegramWriter telegram_writer(int precision) {
  rsi::EthernetConfig config;
  config.sentype = "ImFree";
  for (const char* tag : {"DEF_RIst", "DEF_AIPos"})
    config.send.push_back({tag, rsi::EthernetConfig::Element::Type::DOUBLE, 0, false, 0});
  return {config, precision};
}

/// The same stroke as another device measures it.
Sweep seen_by_device(const Sweep& sweep, double sigma_mm, std::mt19937_64& random) {
  std::normal_distribution<> normal(0, sigma_mm);
  std::vector<Sample> samples = *sweep.samples;
  for (Sample& sample : samples) {
    for (Eigen::Index k = 0; k < 3; ++k) sample.position_mm(k) += normal(random);
    sample.joints = 0;
    sample.has_orientation = false;
  }
  Sweep seen = sweep;
  seen.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
  return seen;
}

/// Each planned sweep's stroke, known by its joint and its ends; all in the order of time.
std::vector<std::optional<std::size_t>> strokes_of_sweeps(const SweepPlan& plan,
                                                          const std::vector<Sweep>& strokes) {
  constexpr double kSame_deg = 1;  // a stroke's ends are cut off where the joint hardly moves
  std::vector<std::optional<std::size_t>> found;
  std::size_t next = 0;
  for (const PlannedSweep& sweep : plan.sweeps) {
    found.emplace_back();
    const auto at = [&](const Sample& sample, double angle_deg) {
      return std::abs(degrees(sample.angles_rad[sweep.joint - 1]) - angle_deg) <= kSame_deg;
    };
    for (std::size_t i = next; i < strokes.size() && !found.back(); ++i)
      if (strokes[i].joint == sweep.joint - 1 && at(strokes[i].first(), sweep.start_deg) &&
          at(strokes[i].last(), sweep.end_deg))
        found.back() = i;
    if (found.back()) next = *found.back() + 1;
  }
  return found;
}

class Strokes : public StreamSink {
 public:
  explicit Strokes(std::vector<Sweep>& strokes) : strokes_(strokes) {}
  void sweep(const Sweep& sweep) override { strokes_.push_back(sweep); }

 private:
  std::vector<Sweep>& strokes_;
};

}  // namespace

Rehearsal rehearse(const RobotDescription& robot, const SweepPlan& plan,
                   const Measurement& measurement, std::uint64_t seed) {
  SimulatedRobot simulated(robot, plan,
                           {.cycle = measurement.cycle,
                            .wobble_deg = measurement.wobble_deg,
                            .seed = seed,
                            .tool_mm = {}});
  const rsi::TelegramWriter writer = telegram_writer(measurement.precision);
  Rehearsal rehearsal;
  Strokes strokes(rehearsal.strokes);
  Pipeline pipeline(robot.joints(), {}, strokes);
  rsi::Datagram datagram;
  rsi::SignalValues values;
  std::string telegram;
  for (std::chrono::milliseconds time{0}; simulated.next(values); time += measurement.cycle) {
    telegram.clear();
    writer.append(telegram, values, static_cast<std::uint64_t>(time.count()));
    datagram.payload = telegram;
    datagram.time = time;
    pipeline.telegram(datagram);
  }
  pipeline.finish();
  rehearsal.duration = simulated.duration();
  rehearsal.stroke_of_sweep = strokes_of_sweeps(plan, rehearsal.strokes);

  RobotSetup setup;
  setup.joints = robot.joints();
  setup.description = robot;
  setup.plan = plan;
  rehearsal.campaign = campaign(setup, pipeline.resolution());
  if (measurement.position_sigma_mm) {
    rehearsal.campaign.resolution = {};
    rehearsal.campaign.device_frame = true;
    std::mt19937_64 random(seed);
    for (Sweep& sweep : rehearsal.strokes)
      sweep = seen_by_device(sweep, *measurement.position_sigma_mm, random);
  }
  rehearsal.identification = identify::identify(rehearsal.strokes, rehearsal.campaign);
  return rehearsal;
}

identify::Prediction Rehearsal::prediction(const Measurement& measurement) const {
  const double wobble = radians(measurement.wobble_deg);
  return identify::predict(
      identification, campaign,
      measurement.position_sigma_mm
          ? identify::device_noise(*measurement.position_sigma_mm, wobble, campaign.joints)
          : identify::printed_noise(campaign.resolution, wobble, campaign.joints));
}

}  // namespace sweepd
