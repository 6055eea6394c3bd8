#pragma once

#include <string>
#include <vector>

#include "daemon/settings/settings.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {

/// The tags with which an answer can move the robot or switch something, although all values are
/// zero: absolute corrections, outputs, $OV_PRO. None where nothing is answered.
[[nodiscard]] std::vector<std::string> commanding_tags(const rsi::EthernetConfig& config);

// What follows reads as a line each, with file, place and remedy.

/// Why this robot must not be answered as its Ethernet file wants; none if it may be: a reply fits
/// into a datagram, and each commanding tag is named in `answers_with_zeros`.
[[nodiscard]] std::vector<std::string> objections_to_answers(const RobotSettings& robot,
                                                             const rsi::EthernetConfig& config);

/// What it means that the settings name no Ethernet file.
inline constexpr const char* kWithoutEthernetConfig =
    "replies carry Type ImFree and the IPOC alone; name the file that lies on the controller";

/// Replies that are larger than a frame of the network.
[[nodiscard]] std::vector<std::string> warnings_of_answers(const rsi::EthernetConfig& config);

/// For an Ethernet file by itself, without a robot's settings: what those would have to allow.
/// Empty if nothing.
[[nodiscard]] std::string warning_of_commands(const rsi::EthernetConfig& config);

}  // namespace sweepd
