#include "daemon/commands/exit_codes.hpp"

#include <ostream>

#include "daemon/results/outcome.hpp"

namespace sweepd {

int exit_code(const Outcome& outcome, std::ostream& errors) {
  const auto& found = outcome.identification;
  if (found.status == identify::Status::doubtful) {
    errors << "sweepd: the result is doubtful: " << found.doubts.front().message << '\n';
    return kAdverse;
  }
  if (found.status != identify::Status::failed) return kOk.code;
  errors << "sweepd: nothing is identified: " << found.reason;
  // The first warning has what to do, as a doubt has.
  if (found.doubts.empty() && !found.warnings.empty() &&
      found.warnings.front().message != found.reason)
    errors << ": " << found.warnings.front().message;
  errors << '\n';
  return kFailed;
}

}  // namespace sweepd
