#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/plant_settings.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/endpoint.hpp"

namespace sweepd {

/// Where in a telegram the measured values stand, as `Element` (its text) or `Element.attribute`.
struct SignalNames {
  std::array<std::string, 3> position{"RIst.X", "RIst.Y", "RIst.Z"};     ///< mm
  std::array<std::string, 3> orientation{"RIst.A", "RIst.B", "RIst.C"};  ///< deg, KUKA's A, B, C
  /// Axis angles in deg, joint 1 first.
  std::vector<std::string> angles{"AIPos.A1", "AIPos.A2", "AIPos.A3",
                                  "AIPos.A4", "AIPos.A5", "AIPos.A6"};
};

/// [robot.recording]: how much of it is kept, and where it ends.
struct RecordingSettings {
  std::size_t memory_bytes = std::size_t{16} << 20;  ///< waiting for a slow disk
  std::uint64_t rotate_bytes = std::uint64_t{1} << 30;
  std::chrono::seconds rotate{std::chrono::hours(24)};
  std::uint64_t keep_free_bytes = std::uint64_t{1}
                                  << 30;  ///< on the disk; below it nothing is recorded
  std::uint64_t keep_bytes = 0;           ///< of this robot's recordings; 0: all
  std::chrono::days keep{0};              ///< 0: for ever
};

/// Tags of the RECEIVE list of an Ethernet file, as they are written there.
struct TagNames {
  std::vector<std::string> names;
  bool operator==(const TagNames&) const = default;
};

/// "udp://0.0.0.0:5005", or tcp://: where text comes to. Port 0: nowhere.
struct TextPort {
  bool tcp = false;
  rsi::Endpoint endpoint;
  bool operator==(const TextPort&) const = default;
};
/// Nothing where it is none; without udp:// or tcp:// it is UDP.
[[nodiscard]] std::optional<TextPort> parse_text_port(std::string_view text);
[[nodiscard]] std::string text(const TextPort& port);

/// Columns of lines, with commas between, as `identify --columns` has them.
struct ColumnList {
  std::string text;
  std::string place = {};  ///< `FILE:LINE:COLUMN: robot.device.`, for errors; empty: of no file
  bool operator==(const ColumnList& other) const { return text == other.text; }
};

/// [[robot.device]]: a measuring device that sends text lines while the robot moves.
struct DeviceSettings {
  TextPort listen;
  ColumnList columns;

  [[nodiscard]] bool there() const { return listen.endpoint.port != 0; }
};

/// Another program answers the controller: `sweepd watch` only listens. In no file.
struct TapSettings {
  std::string interface;
  bool promiscuous = false;
};

/// One [[robot]] of the settings: a controller that is served. The defaults are those of the file.
/// Paths are absolute, or relative to the working directory as the path of the settings file was.
struct RobotSettings {
  std::string name;                         ///< fit for a folder's name; unique
  std::filesystem::path description;        ///< see robot_description.hpp
  rsi::Endpoint listen;                     ///< local; 0.0.0.0 is every interface
  std::optional<std::uint32_t> controller;  ///< host byte order; absent: the first that speaks
  std::optional<std::filesystem::path> ethernet_config;  ///< the controller's own file
  TagNames answers_with_zeros;                           ///< see answers.hpp
  std::filesystem::path output;
  std::optional<std::filesystem::path> plan;  ///< see sweep_plan.hpp
  bool record = true;
  std::chrono::milliseconds silence{2000};  ///< the stream has ended when nothing came for so long
  std::size_t queue_bytes = std::size_t{4} << 20;
  RealTimeSettings real_time;
  RecordingSettings recording;
  SignalNames signals;
  DeviceSettings device;  ///< perhaps none
  std::optional<TapSettings> tap = {};
};

/// Names of hosts, without a port.
struct HostNames {
  std::vector<std::string> names;
  bool operator==(const HostNames&) const = default;
};

/// [http]: the pages that tell how sweepd is.
struct HttpSettings {
  std::optional<rsi::Endpoint> listen = rsi::Endpoint{0x7f000001, 19152};  ///< absent: no pages
  /// This machine's, which a request may name beside localhost and the address of `listen`.
  HostNames hosts;
};

/// When a sweepd that runs heeds another value of a key, after it read its settings again.
enum class TakesEffect { at_once, next_session, after_restart };

struct Settings {
  std::filesystem::path file;
  std::vector<RobotSettings> robots;  ///< at least one
  HttpSettings http;
  std::optional<PublishSettings> publish;  ///< for `sweepd publish`
};

/// Reads and checks the settings; throws ConfigError. Whether the files that they name exist is
/// left to who reads those.
[[nodiscard]] Settings load_settings(const std::filesystem::path& file);

/// What differs between two settings of a robot with one name, by key.
struct SettingsChange {
  std::array<std::vector<std::string>, 3> keys;
  [[nodiscard]] std::vector<std::string>& of(TakesEffect when) {
    return keys[static_cast<std::size_t>(when)];
  }
  [[nodiscard]] const std::vector<std::string>& of(TakesEffect when) const {
    return keys[static_cast<std::size_t>(when)];
  }
};
[[nodiscard]] SettingsChange change(RobotSettings from, RobotSettings to);
[[nodiscard]] SettingsChange change(HttpSettings from, HttpSettings to);
/// All but what needs a restart of `from`, another reading of the same robot's settings.
void take_over_live(RobotSettings& robot, RobotSettings from);

/// An option in words, for a manual.
struct OptionText {
  std::string key;       ///< of a robot, "signals.position" stands in [robot.signals]
  std::string value;     ///< what is written, with its range: "whole number, 100 to 3600000"
  std::string fallback;  ///< the default as TOML; empty if there is none
  bool required = false;
  std::string help;  ///< one line
  TakesEffect takes_effect = TakesEffect::next_session;
};
[[nodiscard]] std::vector<OptionText> robot_options();  ///< of [[robot]]
[[nodiscard]] std::vector<OptionText> http_options();   ///< of [http]

}  // namespace sweepd
