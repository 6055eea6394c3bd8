#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/identification.hpp"
#include "tests/simulation/simulation.hpp"

namespace coverage {

/// What one campaign's identification was worth.
struct Outcome {
  struct Number {
    std::size_t index = 0;  ///< five a row: b, theta, a, alpha, beta
    double error = 0;       ///< mm or rad
    double sigma = 0;       ///< as stated
    [[nodiscard]] bool inside() const;
  };
  std::vector<Number> numbers;  ///< those that the result calls identified
  identify::Status status = identify::Status::failed;
  bool converged = false;  ///< the table is the chain's
  bool transmission = false;
  bool backlash = false;  ///< a gear was accused
  double milliseconds = 0;
};

/// The result against the truth at its home.
[[nodiscard]] Outcome judged(const simulation::Simulation& simulation,
                             const identify::Identification& found);

/// Errors by kind of number: of a and b in mm, of alpha and theta in degrees, each the median over
/// the arm's numbers of the root mean square over the runs. Nothing where none was identified.
struct Errors {
  std::array<std::optional<double>, 4> rms;
};
inline constexpr std::array<const char*, 4> kKinds = {"a", "b", "alpha", "theta"};

/// Of the first `runs` outcomes.
[[nodiscard]] Errors errors(const std::vector<Outcome>& outcomes, std::size_t runs);

/// All outcomes of one kind of campaign.
struct Score {
  double covered = 0;  ///< percent
  double rms_z = 0;
  double worst_covered = 0;  ///< of the number with the least
  std::string worst;
  double known = 0;  ///< identified numbers a run
  int unconverged = 0;
  std::array<int, 4> statuses{};  ///< in the order of `identify::Status`
  double transmission = 0;        ///< percent of runs
  double backlash = 0;
  double milliseconds = 0;
};
[[nodiscard]] Score score(const std::vector<Outcome>& outcomes);

}  // namespace coverage
