#include "identify/clock/clock_rates.hpp"

#include <algorithm>

namespace identify {
namespace {

constexpr double kWorstRate = 3e-3;
/// From one rate that is tried to the next, a clock gains so much over the take.
constexpr double kStep_s = 0.1;
/// Motions that are looked at for the rate alone.
constexpr std::size_t kTellingMoves = 150;
/// From the rate that was tried to the one that the motions have.
constexpr int kRounds = 3;

Motion at_rate(Motion motion, double rate, double from_s) {
  for (auto* spans : {&motion.moves, &motion.rests, &motion.seen})
    for (Span& span : *spans)
      for (double* time_s : {&span.begin_s, &span.end_s})
        *time_s = from_s + (*time_s - from_s) / (1 + rate);
  return motion;
}

/// The match of times that `at_rate` changed, as one of those before.
ClockMatch with_rate(ClockMatch match, double rate, double from_s) {
  match.ahead_s = from_s + (match.at_s + match.ahead_s - from_s) * (1 + rate) - match.at_s;
  match.rate = (1 + rate) * (1 + match.rate) - 1;
  return match;
}

std::size_t matched(const ClockSearch& search) {
  return search.matches.empty() ? 0 : search.matches.front().matched;
}

}  // namespace

ClockSearch match_wrong_rate(const Motion& device, const Motion& controller) {
  ClockSearch found;
  if (device.moves.empty()) return found;
  Motion first = device;
  if (first.moves.size() > kTellingMoves) first.moves.resize(kTellingMoves);
  for (Span& span : first.seen) span.end_s = std::min(span.end_s, first.moves.back().end_s);
  const double from_s = first.moves.front().begin_s;
  const double step = kStep_s / std::max(1.0, first.moves.back().end_s - from_s);
  double best_rate = 0;
  for (double size = kMostRate; size <= kWorstRate; size += step)
    for (const double rate : {size, -size}) {
      const ClockSearch tried = match_clocks(at_rate(first, rate, from_s), controller);
      if (matched(tried) <= matched(found)) continue;
      found = tried;
      best_rate = rate;
    }
  for (int round = 0; round < kRounds && !found.matches.empty(); ++round) {
    best_rate = with_rate(found.matches.front(), best_rate, from_s).rate;
    found = match_clocks(at_rate(device, best_rate, from_s), controller);
  }
  for (ClockMatch& match : found.matches) match = with_rate(match, best_rate, from_s);
  found.problem.clear();
  return found;
}

}  // namespace identify
