#pragma once

#include <iosfwd>
#include <string_view>

namespace sweepd {

struct Outcome;

// How the program ends.
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
/// All was done, and the answer is not the one that is hoped for: a doubtful result, a robot that
/// has changed, replies that were right and late.
inline constexpr int kAdverse = 3;
inline constexpr int kConfigError = 78;  // EX_CONFIG of sysexits.h

struct ExitCode {
  int code;
  std::string_view meaning;
};
inline constexpr ExitCode kOk{0, "Done."};
inline constexpr ExitCode kError{kFailed,
                                 "Failed. A line on standard error says why, and what to do."};
inline constexpr ExitCode kWrongUsage{kUsage,
                                      "The command line is wrong. Standard error says where."};
inline constexpr ExitCode kWrongFile{
    kConfigError, "A configuration file is wrong. Standard error names the file and the line."};
inline constexpr ExitCode kDoubtful{
    kAdverse,
    "The result is doubtful: the data contradict themselves, or what a built robot can be. The "
    "result files are written. The first lines of the report say why."};

/// That of the commands that identify. Where nothing is identified `errors` gets a line that says
/// why.
[[nodiscard]] int exit_code(const Outcome& outcome, std::ostream& errors);

}  // namespace sweepd
