#pragma once

#include <cstdint>
#include <random>

#include "identify/clock/motion_spans.hpp"

namespace identify::test {

/// Moves of any length with rests of any length between, all of them seen.
inline Motion by_chance(std::uint32_t seed, int moves = 30) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> lasts(0.5, 6), rests(0.3, 3);
  Motion motion;
  double at = 5;
  for (int i = 0; i < moves; ++i) {
    const double seconds = lasts(random);
    motion.moves.push_back({at, at + seconds});
    at += seconds + rests(random);
  }
  motion.seen = {{0, at + 5}};
  return motion;
}

/// The same by another clock, each end seen a little early or late.
inline Motion by_other_clock(Motion motion, double ahead_s, double rate, double scatter_s,
                             std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<> normal(0, scatter_s);
  const auto moved = [&](double& at) { at += ahead_s + rate * at; };
  for (auto* spans : {&motion.moves, &motion.seen})
    for (Span& span : *spans) {
      moved(span.begin_s);
      moved(span.end_s);
    }
  for (Span& span : motion.moves) {
    span.begin_s += normal(random);
    span.end_s += normal(random);
  }
  return motion;
}

}  // namespace identify::test
