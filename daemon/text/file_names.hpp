#pragma once

namespace sweepd::file_names {

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

}  // namespace sweepd::file_names
