#pragma once

#include <string_view>

namespace sweepd {

// How the program ends.
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
/// Every reply was right: a busy machine, perhaps, and not a wrong server.
inline constexpr int kLate = 3;
/// The robot is another than it was.
inline constexpr int kChanged = 3;
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
    3,
    "The result is doubtful: the data contradict themselves, or what a built robot can be. The "
    "result files are written. The first lines of the report say why."};

}  // namespace sweepd
