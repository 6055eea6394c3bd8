#include "identify/undetermined.hpp"

#include <array>
#include <string>
#include <utility>

namespace identify {
namespace {

/// As in "theta, a of row 2"; empty where all of the row is known.
std::string undetermined_in(const DhEstimate& row, std::size_t index) {
  const std::array<std::pair<const char*, const DhNumber*>, 5> numbers{{{"b", &row.b_mm},
                                                                        {"theta", &row.theta_rad},
                                                                        {"a", &row.a_mm},
                                                                        {"alpha", &row.alpha_rad},
                                                                        {"beta", &row.beta_rad}}};
  const bool parallel = row.relation == Relation::parallel || row.relation == Relation::coincident;
  std::string names;
  for (const auto& [name, number] : numbers)
    if (number->knowledge == Knowledge::undetermined && (parallel || number != &row.beta_rad))
      names += (names.empty() ? "" : ", ") + std::string(name);
  return names.empty() ? names : names + " of row " + std::to_string(index + 1);
}

}  // namespace

void name_undetermined(Identification& found) {
  if (found.status != Status::complete) return;
  std::string all;
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const std::string names = undetermined_in(found.dh[i], i);
    if (!names.empty()) all += (all.empty() ? "" : "; ") + names;
  }
  if (all.empty()) return;
  found.status = Status::partial;
  found.reason = "not determined: " + all;
  found.warnings.push_back({"undetermined",
                            {},
                            "the axes are too uncertain to tell " + all +
                                ": these numbers are left out; state or measure the axes more "
                                "closely"});
}

}  // namespace identify
