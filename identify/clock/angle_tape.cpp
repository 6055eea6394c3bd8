#include "identify/clock/angle_tape.hpp"

#include <algorithm>

#include "identify/sweeps/segmentation.hpp"

namespace identify {

void AngleTape::add(const Sample& sample) {
  if (sample.joints < joints_) return;
  if (!time_s_.empty() && !(sample.time_s > time_s_.back())) return;
  if (told_++ % stride_ != 0) return;
  if (time_s_.size() == most_) halve();
  time_s_.push_back(sample.time_s);
  angles_rad_.push_back(sample.angles_rad);
}

void AngleTape::halve() {
  for (std::size_t i = 0; 2 * i < time_s_.size(); ++i) {
    time_s_[i] = time_s_[2 * i];
    angles_rad_[i] = angles_rad_[2 * i];
  }
  time_s_.resize((time_s_.size() + 1) / 2);
  angles_rad_.resize(time_s_.size());
  stride_ *= 2;
}

std::optional<JointAngles> AngleTape::at(double time_s) const {
  const auto after = std::lower_bound(time_s_.begin(), time_s_.end(), time_s);
  if (after == time_s_.end()) return std::nullopt;
  const auto i = static_cast<std::size_t>(after - time_s_.begin());
  if (*after == time_s) return angles_rad_[i];
  if (i == 0 || time_s_[i] - time_s_[i - 1] > kLongestGap_s) return std::nullopt;
  std::size_t from = i - 1, to = i;
  if (from > 0 && time_s_[from] - time_s_[from - 1] <= kLongestGap_s) --from;
  if (to + 1 < time_s_.size() && time_s_[to + 1] - time_s_[to] <= kLongestGap_s) ++to;
  JointAngles angles{};
  for (std::size_t a = from; a <= to; ++a) {
    double weight = 1;
    for (std::size_t b = from; b <= to; ++b)
      if (b != a) weight *= (time_s - time_s_[b]) / (time_s_[a] - time_s_[b]);
    for (std::size_t j = 0; j < joints_; ++j) angles[j] += weight * angles_rad_[a][j];
  }
  return angles;
}

std::optional<JointAngles> AngleTape::mean(double from_s, double to_s) const {
  const auto begin = std::lower_bound(time_s_.begin(), time_s_.end(), from_s);
  const auto end = std::upper_bound(begin, time_s_.end(), to_s);
  if (begin == end) return std::nullopt;
  JointAngles sum{};
  for (auto at = begin; at != end; ++at)
    for (std::size_t j = 0; j < joints_; ++j)
      sum[j] += angles_rad_[static_cast<std::size_t>(at - time_s_.begin())][j];
  for (double& angle : sum) angle /= static_cast<double>(end - begin);
  return sum;
}

}  // namespace identify
