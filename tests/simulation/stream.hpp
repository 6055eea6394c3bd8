#pragma once

#include <cstdint>
#include <random>

namespace simulation {

/// What has random numbers of its own, so that turning one knob changes no other error.
enum class Source {
  noise,
  outliers,
  drift,
  place,
  home_error,
  stray,
  wobble,
  gears,
  shape,
  built,
  home,
  homes,
  poses,
  clock,
  weights,
  move,
  creep,
  settle
};

[[nodiscard]] inline std::mt19937_64 stream(std::uint32_t seed, Source source) {
  std::seed_seq numbers{seed, static_cast<std::uint32_t>(source)};
  return std::mt19937_64(numbers);
}

}  // namespace simulation
