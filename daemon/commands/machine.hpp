#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "daemon/commands/findings.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/system/disk_room.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/server/port_owner.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {

/// What matters to a robot of the machine that sweepd runs on, seen by the user who looks.
struct Machine {
  bool root = false;
  std::string port_taken_by;             ///< "sweepd (process 12)"; empty if nobody has it
  std::string cannot_listen;             ///< why, and what to do; empty if it can
  std::size_t receive_buffer = 0;        ///< bytes that the system grants a socket
  std::vector<std::uint32_t> addresses;  ///< of its interfaces, host byte order
  std::optional<std::uint32_t> towards_controller;  ///< the address that the controller sees
  RealTimeReport real_time;
  std::string cannot_write;      ///< why, and what to do; empty if recordings can be written
  std::optional<DiskRoom> room;  ///< of the disk for recordings
};

/// Looks: binds the robot's port for a moment, tries SCHED_FIFO on a thread of its own.
[[nodiscard]] Machine look_at_machine(const RobotSettings& robot, rsi::Transport transport);

/// Says whether this machine can serve the robot. `ethernet`: the controller's file, if there is
/// one.
void judge_machine(const Machine& machine, const RobotSettings& robot,
                   const rsi::EthernetConfig* ethernet, Findings& findings);

}  // namespace sweepd
