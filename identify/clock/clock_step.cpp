#include "identify/clock/clock_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace identify {
namespace {

/// Those of one's moves that the other did not look at, behind all that it did, or before them.
struct Beyond {
  std::vector<Span> before, behind;
};

/// `to_other`: the one's time by the other's clock.
template <class ToOther>
Beyond beyond(const Motion& one, const Motion& other, const ToOther& to_other) {
  const auto looked = [&](const Span& move) { return is_within(other.seen, to_other(move)); };
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Span& move : one.moves) {
    if (!looked(move)) continue;
    first = std::min(first, move.begin_s);
    last = std::max(last, move.end_s);
  }
  Beyond found;
  for (const Span& move : one.moves) {
    if (move.end_s < first) found.before.push_back(move);
    if (move.begin_s > last) found.behind.push_back(move);
  }
  return found;
}

/// The step that most of them fit.
std::optional<ClockStep> step_of(const std::vector<Span>& device,
                                 const std::vector<Span>& controller, const ClockMatch& match) {
  constexpr std::size_t kFewestMoves = 2;
  std::optional<ClockStep> found;
  std::size_t most = kFewestMoves - 1;
  const std::size_t enough = std::min(device.size(), controller.size()) / 2;
  for (const Span& d : device)
    for (const Span& c : controller) {
      if (!alike(d, c, 0, kMostHidden_s)) continue;
      const double ahead_s = d.middle_s() - c.middle_s();
      const auto fits = static_cast<std::size_t>(
          std::count_if(controller.begin(), controller.end(), [&](const Span& one) {
            return std::any_of(device.begin(), device.end(), [&](const Span& seen) {
              return std::abs(seen.middle_s() - one.middle_s() - ahead_s) < kSameMove_s &&
                     alike(seen, one, 0, kMostHidden_s);
            });
          }));
      if (fits <= most || fits < enough) continue;
      most = fits;
      found = {controller.front().begin_s, d.middle_s() - match.device_s(c.middle_s())};
    }
  return found;
}

}  // namespace

std::optional<ClockStep> step_beyond(const Motion& device, const Motion& controller,
                                     const ClockMatch& match) {
  const Beyond device_alone = beyond(device, controller, [&](const Span& move) {
    return Span{match.controller_s(move.begin_s), match.controller_s(move.end_s)};
  });
  const Beyond controller_alone = beyond(controller, device, [&](const Span& move) {
    return Span{match.device_s(move.begin_s), match.device_s(move.end_s)};
  });
  if (auto step = step_of(device_alone.behind, controller_alone.behind, match)) return step;
  auto step = step_of(device_alone.before, controller_alone.before, match);
  // The offset of those before is the one that changes.
  if (step) *step = {controller_alone.before.back().end_s, -step->by_s};
  return step;
}

}  // namespace identify
