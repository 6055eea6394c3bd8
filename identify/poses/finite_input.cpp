#include "identify/poses/finite_input.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace identify {
namespace {

/// Whether all that is known of it is.
bool is_finite(const Sample& sample) {
  const auto finite = [](double number) { return std::isfinite(number); };
  const auto& angles = sample.angles_rad;
  return finite(sample.time_s) && (!sample.has_position || sample.position_mm.allFinite()) &&
         (!sample.has_orientation ||
          std::all_of(sample.abc_rad.begin(), sample.abc_rad.end(), finite)) &&
         std::all_of(angles.begin(), angles.begin() + std::min<int>(sample.joints, kMostJoints),
                     finite);
}

}  // namespace

void leave_out_not_finite(std::vector<Sweep>& sweeps, std::vector<Pose>& poses,
                          std::vector<Warning>& warnings) {
  std::size_t left_out = 0;
  std::erase_if(sweeps, [&](Sweep& sweep) {
    const bool has_range = std::isfinite(sweep.range_rad);
    const auto counts = [&](const Sample& sample) { return has_range && is_finite(sample); };
    const auto& samples = *sweep.samples;
    if (std::all_of(samples.begin(), samples.end(), counts)) return false;
    std::vector<Sample> kept;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(kept), counts);
    left_out += samples.size() - kept.size();
    if (kept.empty()) return true;
    sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(kept));
    return false;
  });
  left_out += std::erase_if(poses, [](const Pose& pose) { return !is_finite(pose.sample); });
  if (left_out > 0)
    warnings.push_back({"not_finite",
                        {},
                        std::to_string(left_out) +
                            " of the samples and poses hold a number that is infinite or none, "
                            "and were left out"});
}

}  // namespace identify
