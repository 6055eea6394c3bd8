#pragma once

#include <filesystem>

namespace sweepd::test {

// What is shipped with sweepd, for one robot.
inline const auto kConfig = std::filesystem::path(SWEEPD_SOURCE_DIR) / "config";
inline const auto kRobot = kConfig / "robots/kr5_arc.toml";
inline const auto kPlan = kConfig / "plans/kr5_arc_90deg.toml";
inline const auto kEthernet = kConfig / "controller/krc4/sweepd_ethernet.xml";

}  // namespace sweepd::test
