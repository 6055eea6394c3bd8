#include "daemon/commands/exit_codes.hpp"

#include <sstream>

#include "daemon/results/outcome.hpp"
#include "tests/catch.hpp"

using sweepd::exit_code;
using sweepd::Outcome;

TEST_CASE("what is wrong with a result stands on standard error, whoever reads the report",
          "[exit_codes]") {
  const auto said = [](const Outcome& outcome, int code) {
    std::ostringstream errors;
    CHECK(exit_code(outcome, errors) == code);
    return errors.str();
  };
  Outcome outcome;
  auto& found = outcome.identification;
  found.status = identify::Status::complete;
  CHECK(said(outcome, 0).empty());
  found.status = identify::Status::partial;
  CHECK(said(outcome, 0).empty());
  found.status = identify::Status::doubtful;
  found.doubts.push_back({"unit_factor", {}, "all lengths are too small"});
  CHECK(said(outcome, 3) == "sweepd: the result is doubtful: all lengths are too small\n");
  found.doubts.clear();
  found.status = identify::Status::failed;
  found.reason = "no sweep was found";
  found.warnings.push_back({"joint_never_moved", 0, "joint 1 was never swept alone"});
  CHECK(said(outcome, 1) ==
        "sweepd: nothing is identified: no sweep was found: joint 1 was never swept alone\n");
}
