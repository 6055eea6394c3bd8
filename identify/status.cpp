#include <string>

#include "identify/identification.hpp"

namespace identify {

void apply_doubts(Identification& found) {
  if (found.doubts.empty()) return;
  if (found.status != Status::failed) found.status = Status::doubtful;
  found.reason = found.doubts.front().message + (found.reason.empty() ? "" : "; " + found.reason);
}

std::string_view text(Status status) noexcept {
  switch (status) {
    case Status::complete:
      return "complete";
    case Status::doubtful:
      return "doubtful";
    case Status::partial:
      return "partial";
    case Status::failed:
      return "failed";
  }
  return "";
}

std::string_view text(Estimator estimator) noexcept {
  switch (estimator) {
    case Estimator::circle:
      return "circle";
    case Estimator::chain:
      return "chain";
    case Estimator::poses:
      return "poses";
    case Estimator::axes:
      return "axes";
  }
  return "";
}

namespace {

/// As in "theta, a of row 2"; empty where all of the row is known.
std::string undetermined_in(const DhEstimate& row, std::size_t index) {
  std::string names;
  for (const DhNumberName& of : kDhNumbers)
    if ((row.*of.number).knowledge == Knowledge::undetermined &&
        (has_beta(row) || of.number != &DhEstimate::beta_rad))
      names += (names.empty() ? "" : ", ") + std::string(of.name);
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
