#pragma once

#include <filesystem>

namespace sweepd::test {

// What is shipped with sweepd, for one robot. No constant outside of a function may be made from
// kConfig, which is made when the program starts, and not always first. The others are literals.
inline const auto kConfig = std::filesystem::path(SWEEPD_SOURCE_DIR) / "config";
inline constexpr auto kRobot = SWEEPD_SOURCE_DIR "/config/robots/kr5_arc.toml";
inline constexpr auto kPlan = SWEEPD_SOURCE_DIR "/config/plans/kr5_arc_90deg.toml";
inline constexpr auto kEthernet = SWEEPD_SOURCE_DIR "/config/controller/krc4/sweepd_ethernet.xml";

}  // namespace sweepd::test
