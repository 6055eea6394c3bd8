#pragma once

#include <array>
#include <string_view>

namespace sweepd {

/// Whether a folder whose run.json names this command is a session's: recorded as it went, and
/// without "ended" until its last result is there.
[[nodiscard]] constexpr bool records_sessions(std::string_view command) {
  return command == "run" || command == "watch";
}

namespace file_names {

/// What a run leaves in its folder, where more than one room knows it: docs/results.md says what is
/// in each.
inline constexpr const char* kResult = "result.json";
inline constexpr const char* kRun = "run.json";
inline constexpr const char* kReport = "report.txt";
inline constexpr const char* kReportPage = "report.html";
inline constexpr const char* kTable = "dh.csv";
inline constexpr const char* kSweeps = "sweeps.csv";
inline constexpr const char* kPoses = "poses.csv";
inline constexpr const char* kDisplacement = "displacement.csv";
inline constexpr const char* kCurrents = "currents.csv";
inline constexpr const char* kLink = "link.json";
inline constexpr const char* kLinkText = "link.txt";
inline constexpr const char* kLastCycles = "last_cycles.csv";
inline constexpr const char* kSamples = "samples.csv";
/// What `validate` and `correct` make of a result, and leave beside it.
inline constexpr const char* kValidation = "validation.json";
inline constexpr const char* kCorrection = "correction.json";
/// Slices of the displacement, across X, Y and Z.
inline constexpr std::array kSlices = {"displacement-x.svg", "displacement-y.svg",
                                       "displacement-z.svg"};
/// Of recordings, which go on in numbered files: see part_name() in recording_files.hpp.
inline constexpr std::string_view kTraceStem = "trace", kTraceEnding = ".pcap";
inline constexpr std::string_view kSamplesStem = "samples", kSamplesEnding = ".csv";

}  // namespace file_names

/// What JSON that sweepd reads again says of itself: these files, and what /api/state shows.
namespace schemas {

inline constexpr const char* kResult = "sweepd.result/1";
inline constexpr const char* kLink = "sweepd.link/1";
inline constexpr const char* kRun = "sweepd.run/1";
inline constexpr const char* kState = "sweepd.state/1";

}  // namespace schemas
}  // namespace sweepd
