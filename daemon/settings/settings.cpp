#include "daemon/settings/settings.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/option.hpp"
#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRobot = "robot";
constexpr std::string_view kHttp = "http";
constexpr std::string_view kPublish = "publish";
constexpr std::string_view kSignals = "signals";
constexpr std::string_view kRecording = "recording";
constexpr std::string_view kDevice = "device";
constexpr std::int64_t kTebibyte = std::int64_t{1} << 40;

template <typename T>
void append(std::vector<T>& to, std::vector<T> from) {
  std::move(from.begin(), from.end(), std::back_inserter(to));
}

/// What the socket and the reply thread are made of needs a restart.
Options options_of(RobotSettings& robot) {
  return {
      required({"name", &robot.name,
                "names the robot in logs and the folder of its results: letters, digits, - _ ."}),
      required(
          {"description", &robot.description, "the robot: joints, limits, specified DH table"}),
      required(after_restart(
          {"listen", &robot.listen,
           "address and port of this machine that the controller sends to; 0.0.0.0 is any"})),
      after_restart({"controller", &robot.controller,
                     "only this address is answered; left out: the first that streams"}),
      after_restart({"ethernet_config", &robot.ethernet_config,
                     "the very Ethernet file that lies on the controller"}),
      after_restart(
          {"answers_with_zeros", &robot.answers_with_zeros,
           "tags of RECEIVE that can move the robot or switch something, and may all the same be "
           "answered with zeros"}),
      required({"output", &robot.output,
                "folder under which recordings and results are kept, in OUTPUT/NAME/START"}),
      {"plan", &robot.plan,
       "the sweep program; its order of joints is needed where telegrams carry no angles"},
      {"record", &robot.record, "whether every datagram is kept in trace.pcap"},
      {"silence_ms", &robot.silence, "the stream has ended when nothing came for so long", 100,
       3'600'000},
      after_restart({"queue_bytes", &robot.queue_bytes,
                     "room for datagrams that are answered but not yet processed", 64 << 10,
                     1 << 30}),
      after_restart(
          {"realtime", &robot.real_time.wish,
           "locked memory and SCHED_FIFO for the reply thread: required, tried, or left alone"}),
      after_restart({"realtime_priority", &robot.real_time.priority,
                     "priority of the reply thread under SCHED_FIFO", 1, 98}),
      after_restart(
          {"cpus", &robot.real_time.cpus,
           "the reply thread runs on these processors only, and all others keep off; left out: any",
           0, 1023}),
  };
}

Options options_of(RecordingSettings& recording) {
  Options options = {
      {"memory_bytes", &recording.memory_bytes, "room for what waits for a slow disk", 1 << 20,
       1 << 30},
      {"rotate_bytes", &recording.rotate_bytes,
       "a trace that has grown to this goes on in a new file", 1 << 20, kTebibyte},
      {"rotate_s", &recording.rotate, "a trace older than this many seconds goes on in a new file",
       60, 31'536'000},
      {"keep_free_bytes", &recording.keep_free_bytes,
       "while the disk has less room than this, nothing is recorded", 0, kTebibyte},
      {"keep_bytes", &recording.keep_bytes,
       "the oldest recordings of this robot go when all are larger than this; 0: none go", 0,
       1024 * kTebibyte},
      {"keep_days", &recording.keep, "recordings older than this go, results stay; 0: none go", 0,
       36'500},
  };
  for (Option& option : options) option = at_once(option);  // the recorder has them once read
  return options;
}

Options options_of(SignalNames& signals) {
  return {
      {"position", &signals.position, "where X, Y, Z of the tool stand in a telegram (mm)"},
      {"orientation", &signals.orientation, "where A, B, C of the tool stand in a telegram (deg)"},
      {"angles", &signals.angles,
       "where the actual axis angles stand in a telegram (deg), joint 1 first"},
  };
}

Options options_of(DeviceSettings& device) {
  return {
      required(
          after_restart({"listen", &device.listen,
                         "address and port of this machine that the device sends its lines to"})),
      required(
          after_restart({"columns", &device.columns,
                         "what its lines hold, with commas between, as for identify --columns"})),
  };
}

Options options_of(HttpSettings& http) {
  return {
      after_restart({"listen", &http.listen, "address and port of the pages; / lists them"}),
      after_restart(
          {"hosts", &http.hosts,
           "names of this machine that a request may use beside localhost and that address"}),
  };
}

/// A table of the file, and what it holds. The robot's own has no name.
struct Section {
  std::string_view table;
  Options options;

  [[nodiscard]] std::string prefix() const {
    return table.empty() ? std::string() : std::string(table) + '.';
  }
};

std::vector<Section> sections_of(RobotSettings& robot) {
  return {{"", options_of(robot)},
          {kSignals, options_of(robot.signals)},
          {kRecording, options_of(robot.recording)},
          {kDevice, options_of(robot.device)}};
}

std::vector<Section> sections_of(HttpSettings& http) {
  return {{kHttp, options_of(http)}};
}

/// Where each key of the file belongs.
std::vector<KeyElsewhere> keys_of_all() {
  RobotSettings robot;
  HttpSettings http;
  std::vector<Section> sections = sections_of(robot);
  append(sections, sections_of(http));
  std::vector<KeyElsewhere> all{{std::string(kPublish), "[publish]"}};
  for (const Section& section : sections) {
    const auto place = section.table.empty()      ? "[[robot]]"
                       : section.table == kHttp   ? "[http]"
                       : section.table == kDevice ? "[[robot.device]]"
                                                  : fmt::format("[robot.{}]", section.table);
    if (!section.table.empty()) all.push_back({std::string(section.table), place});
    for (const Option& option : section.options)
      all.push_back({std::string(option.key), fmt::format("\"{}\" of {}", option.key, place)});
  }
  for (const OptionText& option : publish_options())
    all.push_back({option.key, fmt::format("\"{}\" of [publish]", option.key)});
  return all;
}

template <typename T>
SettingsChange change_between(T& from, T& to) {
  const auto before = sections_of(from);
  const auto after = sections_of(to);
  SettingsChange all;
  for (std::size_t i = 0; i < before.size(); ++i) {
    auto some = differing(before[i].options, after[i].options, before[i].prefix());
    for (std::size_t when = 0; when < all.keys.size(); ++when)
      append(all.keys[when], std::move(some.keys[when]));
  }
  return all;
}

/// A port that is listened on, and whose it is.
struct Taken {
  rsi::Endpoint endpoint;
  /// Nothing: a controller's. Its Ethernet file tells its transport, and in recordings its port
  /// alone tells its telegrams from a device's lines.
  std::optional<bool> tcp;
  std::string owner;
};

/// The ports of the whole file. No two sockets get the same one, and what is refused to one of them
/// is only seen when sweepd runs.
class TakenPorts {
 public:
  void pages(const rsi::Endpoint& endpoint) { pages_ = {endpoint, true, "the pages"}; }
  void controller(const rsi::Endpoint& endpoint, const TomlTable& table) {
    take({endpoint, std::nullopt, fmt::format("the robot in line {}", table.line())}, table,
         rsi::text(endpoint));
  }
  void device(const TextPort& port, const TomlTable& table) {
    Taken device{port.endpoint, port.tcp, fmt::format("the device in line {}", table.line())};
    if (pages_ && port.tcp && overlap(*pages_, device)) fail(table, sweepd::text(port), *pages_);
    take(std::move(device), table, sweepd::text(port));
  }

 private:
  /// A socket on 0.0.0.0 takes the port on every address.
  static bool overlap(const Taken& a, const Taken& b) {
    const auto here = a.endpoint.address, there = b.endpoint.address;
    return a.endpoint.port == b.endpoint.port && (here == there || here == 0 || there == 0);
  }
  [[noreturn]] static void fail(const TomlTable& table, const std::string& found,
                                const Taken& other) {
    table.fail("listen", fmt::format("expected an address and port of its own, found {}, which "
                                     "collides with {} of {}: choose another port",
                                     found, rsi::text(other.endpoint), other.owner));
  }
  void take(Taken port, const TomlTable& table, const std::string& found) {
    for (const Taken& other : taken_)
      if (overlap(port, other) && (!port.tcp || !other.tcp || port.tcp == other.tcp))
        fail(table, found, other);
    taken_.push_back(std::move(port));
  }

  std::optional<Taken> pages_;
  std::vector<Taken> taken_;
};

/// At most one: points of several devices are in frames of their own.
std::optional<TomlTable> device_table(const TomlTable& robot) {
  if (!robot.has(kDevice)) return std::nullopt;
  const auto devices = robot.tables(kDevice);
  if (devices.size() > 1)
    devices[1].fail("listen",
                    "expected one [[robot.device]] of a robot, found another: what two "
                    "devices measure is in two frames; leave one out");
  return devices.front();
}

}  // namespace

std::optional<TextPort> parse_text_port(std::string_view text) {
  constexpr std::string_view kUdp = "udp://", kTcp = "tcp://";
  TextPort port;
  port.tcp = text.starts_with(kTcp);
  if (port.tcp || text.starts_with(kUdp)) text.remove_prefix(kUdp.size());
  const auto endpoint = rsi::parse_endpoint(text);
  if (!endpoint) return std::nullopt;
  port.endpoint = *endpoint;
  return port;
}

std::string text(const TextPort& port) {
  return (port.tcp ? "tcp://" : "udp://") + rsi::text(port.endpoint);
}

Settings load_settings(const fs::path& file) {
  const TomlTable top = TomlTable::load(file);
  const fs::path folder = file.parent_path();
  const auto elsewhere = keys_of_all();
  Mistakes mistakes;
  const auto meant = top.check_keys({kRobot, kHttp, kPublish}, elsewhere, mistakes);
  std::vector<TomlTable> tables;
  if (std::find(meant.begin(), meant.end(), kRobot) == meant.end())
    mistakes.of([&] { tables = top.tables(kRobot); });

  Settings settings{file, {}, {}, {}};
  mistakes.of([&] {
    if (const auto http = top.table(kHttp))
      read_options(*http, options_of(settings.http), {}, folder, elsewhere);
  });
  TakenPorts ports;
  if (settings.http.listen) ports.pages(*settings.http.listen);
  for (const TomlTable& table : tables) {
    RobotSettings robot;
    std::optional<TomlTable> device;
    mistakes.of([&] { device = device_table(table); });
    for (const Section& section : sections_of(robot))
      mistakes.of([&] {
        if (section.table.empty())
          read_options(table, section.options, {kSignals, kRecording, kDevice}, folder, elsewhere);
        else if (const auto inner = section.table == kDevice ? device : table.table(section.table))
          read_options(*inner, section.options, {}, folder, elsewhere);
      });
    // What could not be read is empty, and has been told.
    mistakes.of([&] {
      if (!robot.answers_with_zeros.names.empty() && !table.has("ethernet_config"))
        table.fail("answers_with_zeros",
                   "expected `ethernet_config` beside it, whose tags it names, found nothing: add "
                   "that key");
    });
    mistakes.of([&] {
      for (std::size_t i = 0; i < settings.robots.size(); ++i)
        if (!robot.name.empty() && robot.name == settings.robots[i].name)
          table.fail("name", fmt::format("expected a name of its own, found the name of the robot "
                                         "in line {}: change one",
                                         tables[i].line()));
    });
    mistakes.of([&] {
      if (robot.listen.port != 0) ports.controller(robot.listen, table);
    });
    mistakes.of([&] {
      if (robot.device.there()) ports.device(robot.device.listen, *device);
    });
    settings.robots.push_back(std::move(robot));
  }
  mistakes.of([&] {
    if (const auto publish = top.table(kPublish))
      settings.publish = read_publish_settings(*publish, folder);
  });
  mistakes.tell();
  return settings;
}

SettingsChange change(RobotSettings from, RobotSettings to) {
  return change_between(from, to);
}

SettingsChange change(HttpSettings from, HttpSettings to) {
  return change_between(from, to);
}

void take_over_live(RobotSettings& robot, RobotSettings from) {
  const auto to = sections_of(robot);
  const auto read = sections_of(from);
  for (std::size_t i = 0; i < to.size(); ++i) take_over_live(to[i].options, read[i].options);
}

std::vector<OptionText> robot_options() {
  RobotSettings defaults;
  std::vector<OptionText> texts;
  for (const Section& section : sections_of(defaults))
    append(texts, option_texts(section.options, section.prefix()));
  return texts;
}

std::vector<OptionText> http_options() {
  HttpSettings defaults;
  return option_texts(options_of(defaults));
}

}  // namespace sweepd
