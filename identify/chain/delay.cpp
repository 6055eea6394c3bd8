#include "identify/chain/delay.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "identify/chain/angle_track.hpp"
#include "identify/chain/delay_fit.hpp"
#include "identify/geometry/median.hpp"

namespace identify {
namespace {

/// Less certain than this, a delay is of no use.
constexpr double kWorstSigma_s = 0.05;
/// So many samples tell how an angle goes on where it was not told.
constexpr std::size_t kAtEnd = 50;

}  // namespace

std::optional<Delay> find_delay(const CircleEstimate& circles,
                                const std::vector<std::optional<ChainAxis>>& axes,
                                const Campaign& campaign) {
  const auto tracks = angle_tracks(circles, axes, campaign);
  if (tracks.empty()) return std::nullopt;
  auto delay = fitted_delay(tracks, campaign.two_clocks);
  if (delay && !(delay->sigma_s < kWorstSigma_s)) return std::nullopt;
  return delay;
}

bool is_significant(const Delay& delay) noexcept {
  return std::abs(delay.late_s) > kSignificantDelay * delay.sigma_s || delay.rate != 0;
}

CircleEstimate in_step(CircleEstimate circles, const std::vector<std::optional<ChainAxis>>& axes,
                       const Delay& delay) {
  for (std::size_t j = 0; j < circles.joints.size(); ++j) {
    if (!axes[j]) continue;
    for (Sweep& sweep : circles.joints[j].sweeps) {
      sweep.repeats.reset();  // in sums no angle can be put off
      const auto track = angle_track(sweep, j, *axes[j]);
      if (!track) continue;
      auto samples = *sweep.samples;
      AngleAbout about(*axes[j]);
      std::vector<double> seen(samples.size());
      std::vector<bool> told(samples.size(), false);
      std::vector<double> off;  // told minus seen, where both are
      for (std::size_t i = 0; i < samples.size(); ++i) {
        Sample& sample = samples[i];
        if (sample.has_position) seen[i] = about.next(sample.position_mm);
        const double late = delay.late_s + delay.rate * (sample.time_s - delay.at_s);
        const auto then = track->told(sample.time_s + late);
        told[i] = then.has_value();
        if (!then) continue;
        sample.angles_rad[j] = then->angle_rad;
        if (sample.has_position) off.push_back(then->angle_rad - seen[i]);
      }
      if (off.empty()) continue;
      const auto near = static_cast<std::ptrdiff_t>(std::min<std::size_t>(kAtEnd, off.size()));
      const double before = median_of({off.begin(), off.begin() + near});
      const double after = median_of({off.end() - near, off.end()});
      bool begun = false;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        begun = begun || told[i];
        if (!told[i] && samples[i].has_position)
          samples[i].angles_rad[j] = seen[i] + (begun ? after : before);
      }
      sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
    }
  }
  return circles;
}

}  // namespace identify
