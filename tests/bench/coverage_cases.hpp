#pragma once

#include <string>
#include <vector>

#include "tests/simulation/simulation.hpp"

namespace coverage {

/// What has to come out; shares in percent.
struct Aim {
  double least_covered = 93;  ///< of all numbers, inside 1.96 sigma
  double most_covered = 97;
  enum class Gears {
    perfect,        ///< at most 1 % of the runs may accuse a gear
    with_error,     ///< its transmission error may be found or not
    with_large,     ///< has to be found
    with_backlash,  ///< has to be found
  } gears = Gears::perfect;
};

/// One kind of campaign.
struct Case {
  std::string name;
  std::string about;
  simulation::World world;
  simulation::Strokes strokes;
  std::size_t targets = 1;
  Aim aim;
  double kept = 1;        ///< share of the sweeps that a stream has memory for
  bool as_drawn = false;  ///< from the description's home, whose axes lie along the frame's
};

[[nodiscard]] const std::vector<Case>& all_cases();

[[nodiscard]] const std::vector<std::string>& all_arms();
/// As built, at a random home; the paper's KR 5 is the specified one at the paper's home.
[[nodiscard]] simulation::Robot robot_of(const std::string& arm, std::size_t targets,
                                         std::uint32_t seed, bool as_drawn = false);

}  // namespace coverage
