#pragma once

namespace identify {

/// What noise hides in a stream of positions without angles.
struct MotionLimit {
  double noise_mm = 0;      ///< of one coordinate of a position, as the stream showed it
  double slowest_mm_s = 0;  ///< slower motion of the target is not told from rest
  double shortest_mm = 0;   ///< arcs of less extent are not told from noise

  /// Whether noise makes it worse than it is at best.
  [[nodiscard]] bool by_noise() const { return slowest_mm_s > kUsualSlowest_mm_s; }
  static constexpr double kUsualSlowest_mm_s = 2;
  static constexpr double kUsualShortest_mm = 3;
};

}  // namespace identify
