#pragma once

#include <string>
#include <vector>

#include "tests/bench/coverage_score.hpp"

namespace coverage {

/// Which campaigns: one line of the bench.
struct Cell {
  std::string what;  ///< the case
  std::string arm;
  int arc_deg = 0;
  int samples = 0;
  bool operator==(const Cell&) const = default;
};

/// The errors of an earlier estimator on the same campaigns (same seeds).
struct Reference {
  std::string commit;
  struct Line {
    Cell cell;
    std::size_t runs = 0;
    Errors errors;
  };
  std::vector<Line> lines;

  [[nodiscard]] const Line* find(const Cell& cell) const;
};

/// Empty where there is no such file.
[[nodiscard]] Reference read_reference(const std::string& path);
/// False where it could not be written.
[[nodiscard]] bool write_reference(const std::string& path, const Reference& reference);

}  // namespace coverage
