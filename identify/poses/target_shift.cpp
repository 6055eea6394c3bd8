#include "identify/poses/target_shift.hpp"

#include <algorithm>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/spread.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A target has moved where a shift explains so much (chi-square, 3 degrees of freedom, at the
/// worst of all places in the order).
constexpr double kMoved = 60;

/// Where a target was seen on the tool, less where the fit has it; one column a pose. Medians of
/// columns tell a shift whatever single poses are like.
class SeenOnTool {
 public:
  SeenOnTool(const PoseEstimate& found, const std::vector<Pose>& poses, std::size_t target) {
    const Index at = found.fit.model.chain_parameters().target(target);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i].target != target) continue;
      of_.push_back(i);
      const PoseRow& row = found.fit.rows[i];
      const Matrix3d turned = row.by_parameter.block<3, 3>(0, at);
      seen_.emplace_back(turned.transpose() * row.off.head<3>());
    }
  }

  [[nodiscard]] TargetShift largest() const {
    TargetShift most;
    if (of_.size() < 2 * kFewest) return most;
    const std::size_t last = of_.size() - kFewest;
    const std::size_t step = 1 + (last - kFewest) / kMostTries;
    for (std::size_t k = kFewest; k <= last; k += step) take(k, most);
    const std::size_t about = most.at;
    for (std::size_t k = about > kFewest + step ? about - step : kFewest;
         k <= std::min(last, about + step); ++k)
      take(k, most);
    return most;
  }

 private:
  static constexpr std::size_t kFewest = 6;
  static constexpr std::size_t kMostTries = 64;

  [[nodiscard]] Vector3d middle(std::size_t from, std::size_t to) const {
    std::vector<Vector3d> part(seen_.begin() + static_cast<std::ptrdiff_t>(from),
                               seen_.begin() + static_cast<std::ptrdiff_t>(to));
    return median(part);
  }

  /// Standard deviation of these, by the median of their distances from the middle of their part.
  [[nodiscard]] double spread(std::size_t from, std::size_t to, std::size_t k,
                              const Vector3d& first, const Vector3d& second) const {
    std::vector<double> off;
    for (std::size_t i = from; i < to; ++i) {
      const Vector3d away = (seen_[i] - (i < k ? first : second)).cwiseAbs();
      off.insert(off.end(), away.begin(), away.end());
    }
    return std::max(kSigmaByMedian * median_of(std::move(off)), 1e-9);
  }

  void take(std::size_t k, TargetShift& most) const {
    const Vector3d first = middle(0, k), second = middle(k, seen_.size());
    const double sigma = spread(0, seen_.size(), k, first, second);
    // Where of few poses half lie far off, their middle tells nothing.
    const double before = std::max(sigma, spread(0, k, k, first, second));
    const double after = std::max(sigma, spread(k, seen_.size(), k, first, second));
    // The variance of a median is pi / 2 times that of a mean.
    const double square =
        (second - first).squaredNorm() / (kPi / 2 *
                                          (before * before / static_cast<double>(k) +
                                           after * after / static_cast<double>(seen_.size() - k)));
    if (square > most.square) most = {square, of_[k], (second - first).norm(), k};
  }

  std::vector<std::size_t> of_;
  std::vector<Vector3d> seen_;
};

}  // namespace

std::vector<TargetShift> target_shifts(const PoseEstimate& found, const std::vector<Pose>& poses) {
  std::vector<TargetShift> shifts;
  for (std::size_t t = 0; t < found.fit.model.chain.targets_mm.size(); ++t) {
    const TargetShift shift = SeenOnTool(found, poses, t).largest();
    if (shift.square >= kMoved && shift.size_mm >= found.left.rms_mm) shifts.push_back(shift);
  }
  return shifts;
}

}  // namespace identify
