#include "daemon/settings/settings.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "daemon/settings/option.hpp"
#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRobot = "robot";
constexpr std::string_view kHttp = "http";
constexpr std::string_view kSignals = "signals";
constexpr std::string_view kRecording = "recording";
constexpr std::int64_t kTebibyte = std::int64_t{1} << 40;

/// What the socket and the reply thread are made of; all else may change while a robot is served.
constexpr std::array<std::string_view, 8> kAfterRestart{
    "listen",      "controller", "ethernet_config",   "answers_with_zeros",
    "queue_bytes", "realtime",   "realtime_priority", "cpus"};

Options options_of(RobotSettings& robot) {
  return {
      {"name", &robot.name,
       "names the robot in logs and the folder of its results: letters, digits, - _ ."},
      {"description", &robot.description, "the robot: joints, limits, specified DH table"},
      {"listen", &robot.listen,
       "address and port of this machine that the controller sends to; 0.0.0.0 is any"},
      {"controller", &robot.controller,
       "only this address is answered; left out: the first that streams"},
      {"ethernet_config", &robot.ethernet_config,
       "the very Ethernet file that lies on the controller"},
      {"answers_with_zeros", &robot.answers_with_zeros,
       "tags of RECEIVE that can move the robot or switch something, and may all the same be "
       "answered with zeros"},
      {"output", &robot.output,
       "folder under which recordings and results are kept, in OUTPUT/NAME/START"},
      {"plan", &robot.plan,
       "the sweep program; its order of joints is needed where telegrams carry no angles"},
      {"record", &robot.record, "whether every datagram is kept in trace.pcap"},
      {"silence_ms", &robot.silence, "the stream has ended when nothing came for so long", 100,
       3'600'000},
      {"queue_bytes", &robot.queue_bytes,
       "room for datagrams that are answered but not yet processed", 64 << 10, 1 << 30},
      {"realtime", &robot.real_time.wish,
       "locked memory and SCHED_FIFO for the reply thread: required, tried, or left alone"},
      {"realtime_priority", &robot.real_time.priority, "of the reply thread under SCHED_FIFO", 1,
       98},
      {"cpus", &robot.real_time.cpus,
       "the reply thread runs on these processors only, and all others keep off; left out: any", 0,
       1023},
  };
}

Options options_of(RecordingSettings& recording) {
  return {
      {"memory_bytes", &recording.memory_bytes, "room for what waits for a slow disk", 1 << 20,
       1 << 30},
      {"rotate_bytes", &recording.rotate_bytes,
       "a trace that has grown to this goes on in a new file", 1 << 20, kTebibyte},
      {"rotate_s", &recording.rotate, "and so does one that is as old as this", 60, 31'536'000},
      {"keep_free_bytes", &recording.keep_free_bytes,
       "while the disk has less room than this, nothing is recorded", 0, kTebibyte},
      {"keep_bytes", &recording.keep_bytes,
       "the oldest recordings of this robot go when all are larger than this; 0: none go", 0,
       1024 * kTebibyte},
      {"keep_days", &recording.keep, "recordings older than this go, results stay; 0: none go", 0,
       36'500},
  };
}

Options options_of(SignalNames& signals) {
  return {
      {"position", &signals.position, "where X, Y, Z of the tool stand in a telegram (mm)"},
      {"orientation", &signals.orientation, "where A, B, C of the tool stand in a telegram (deg)"},
      {"angles", &signals.angles,
       "where the actual axis angles stand in a telegram (deg), joint 1 first"},
  };
}

Options options_of(HttpSettings& http) {
  return {
      {"listen", &http.listen,
       "address and port of the pages /metrics, /healthz, /readyz, /api/state, /api/result"},
      {"hosts", &http.hosts,
       "names of this machine that a request may use beside localhost and that address"},
  };
}

std::string prefix(std::string_view table) {
  return std::string(table) + '.';
}

/// A socket on 0.0.0.0 takes the port on every address.
bool collide(const rsi::Endpoint& a, const rsi::Endpoint& b) {
  return a.port == b.port && (a.address == b.address || a.address == 0 || b.address == 0);
}

template <typename T>
void append(std::vector<T>& to, std::vector<T> from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

}  // namespace

Settings load_settings(const fs::path& file) {
  const TomlTable top = TomlTable::load(file);
  top.allow_only({kRobot, kHttp});
  const fs::path folder = file.parent_path();
  const std::vector<TomlTable> tables = top.tables(kRobot);

  Settings settings{file, {}, {}};
  for (const TomlTable& table : tables) {
    RobotSettings robot;
    read_options(table, options_of(robot), {kSignals, kRecording}, folder);
    if (const auto signals = table.table(kSignals))
      read_options(*signals, options_of(robot.signals), {}, folder);
    if (const auto recording = table.table(kRecording))
      read_options(*recording, options_of(robot.recording), {}, folder);
    if (!robot.answers_with_zeros.names.empty() && !robot.ethernet_config)
      table.fail("answers_with_zeros",
                 "expected `ethernet_config` beside it, whose tags it names, found nothing: add "
                 "that key");

    for (std::size_t i = 0; i < settings.robots.size(); ++i) {
      const std::string other = " of the robot in line " + std::to_string(tables[i].line());
      if (robot.name == settings.robots[i].name)
        table.fail("name", "expected a name of its own, found the name" + other + ": change one");
      if (collide(robot.listen, settings.robots[i].listen))
        table.fail("listen", "expected an address and port of its own, found " +
                                 rsi::text(robot.listen) + ", which collides with " +
                                 rsi::text(settings.robots[i].listen) + other +
                                 ": choose another port");
    }
    settings.robots.push_back(std::move(robot));
  }
  if (const auto http = top.table(kHttp))
    read_options(*http, options_of(settings.http), {}, folder);
  return settings;
}

SettingsChange change(RobotSettings from, RobotSettings to) {
  std::vector<std::string> keys = differing(options_of(from), options_of(to));
  append(keys, differing(options_of(from.signals), options_of(to.signals), prefix(kSignals)));
  append(keys, differing(options_of(from.recording), options_of(to.recording), prefix(kRecording)));
  SettingsChange change;
  for (std::string& key : keys) {
    const bool fixed = std::count(kAfterRestart.begin(), kAfterRestart.end(), key) > 0;
    (fixed ? change.after_restart : change.live).push_back(std::move(key));
  }
  return change;
}

std::vector<std::string> change(HttpSettings from, HttpSettings to) {
  return differing(options_of(from), options_of(to), prefix(kHttp));
}

std::vector<OptionText> robot_options() {
  RobotSettings defaults;
  std::vector<OptionText> texts = option_texts(options_of(defaults));
  append(texts, option_texts(options_of(defaults.signals), prefix(kSignals)));
  append(texts, option_texts(options_of(defaults.recording), prefix(kRecording)));
  return texts;
}

std::vector<OptionText> http_options() {
  HttpSettings defaults;
  return option_texts(options_of(defaults));
}

}  // namespace sweepd
