#include "daemon/commands/compare_command.hpp"

#include "daemon/commands/exit_codes.hpp"
#include "daemon/results/change.hpp"
#include "daemon/results/change_json.hpp"
#include "daemon/results/change_text.hpp"

namespace sweepd {

int compare(const CompareOptions& options, std::ostream& out) {
  const Change change =
      change_between(read_told_arm(options.first), read_told_arm(options.second), options.level);
  out << (options.json ? change_json(change) : change_text(change));
  return change.test.changed ? kChanged : 0;
}

}  // namespace sweepd
