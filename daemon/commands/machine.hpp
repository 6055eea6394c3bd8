#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/settings.hpp"
#include "daemon/system/disk_room.hpp"
#include "daemon/system/realtime.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/server/port_owner.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {

/// What an examination found, printed as it comes, a finding a line: `ok`, `warning` or `error`,
/// what it is about, and for the latter two what to do.
class Findings {
 public:
  explicit Findings(std::ostream& out) : out_(out) {}

  /// What follows is about this.
  void heading(const std::string& text) { out_ << text << '\n'; }
  void ok(const std::string& text) { line("ok", text); }
  void warning(const std::string& text) { line("warning", text); }
  /// A file is wrong: a mistake a line.
  void error(std::string_view text) {
    for (const auto& mistake : lines_of(text)) line("error", mistake);
    wrong_file_ = true;
  }
  /// The files may be right, but this machine cannot do what they say.
  void not_ready(const std::string& text) {
    line("error", text);
    not_ready_ = true;
  }
  /// A fact by itself: "reply  <Sen ...>".
  void line(const std::string& label, const std::string& text) {
    out_ << "  " << label << std::string(label.size() < 9 ? 9 - label.size() : 1, ' ') << text
         << '\n';
  }

  [[nodiscard]] bool wrong_file() const { return wrong_file_; }
  [[nodiscard]] bool not_ready() const { return not_ready_; }

 private:
  std::ostream& out_;
  bool wrong_file_ = false;
  bool not_ready_ = false;
};

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
