#include "daemon/settings.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>

#include "daemon/toml_table.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;
using Triple = std::array<std::string, 3>;
using Names = std::vector<std::string>;

/// Where an option's value goes. Its type says how it is written and whether it may be left out.
using Field = std::variant<std::string*, fs::path*, rsi::Endpoint*,  // required
                           std::optional<fs::path>*, std::optional<std::uint32_t>*, bool*,
                           std::chrono::milliseconds*, std::chrono::seconds*, std::chrono::days*,
                           std::size_t*, int*, std::vector<int>*, RealTime*, Triple*, Names*>;
static_assert(std::is_same_v<std::size_t, std::uint64_t>,
              "sizes of files are read as whole numbers");

struct Option {
  std::string_view key;
  Field (*field)(RobotSettings&);
  std::string_view help;
  std::int64_t least = 0;  ///< of a whole number
  std::int64_t most = 0;
};

constexpr std::array<std::string_view, 3> kRealTime{"require", "try",
                                                    "off"};  // in RealTime's order

constexpr std::string_view kSignals = "signals";
constexpr std::string_view kRecording = "recording";
constexpr std::int64_t kTebibyte = std::int64_t{1} << 40;

/// What the socket and the reply thread are made of; all else may change while a robot is served.
constexpr std::array<std::string_view, 7> kAfterRestart{
    "listen", "controller", "ethernet_config", "queue_bytes", "realtime", "realtime_priority",
    "cpus"};

const Option kRobotOptions[] = {
    {"name", [](RobotSettings& r) -> Field { return &r.name; },
     "names the robot in logs and the folder of its results: letters, digits, - _ ."},
    {"description", [](RobotSettings& r) -> Field { return &r.description; },
     "the robot: joints, limits, specified DH table"},
    {"listen", [](RobotSettings& r) -> Field { return &r.listen; },
     "address and port of this machine that the controller sends to; 0.0.0.0 is any"},
    {"controller", [](RobotSettings& r) -> Field { return &r.controller; },
     "only this address is answered; left out: the first that speaks"},
    {"ethernet_config", [](RobotSettings& r) -> Field { return &r.ethernet_config; },
     "the very Ethernet file that lies on the controller"},
    {"output", [](RobotSettings& r) -> Field { return &r.output; },
     "folder under which recordings and results are kept, in OUTPUT/NAME/START"},
    {"plan", [](RobotSettings& r) -> Field { return &r.plan; },
     "the sweep program; its order of joints is needed where telegrams carry no angles"},
    {"record", [](RobotSettings& r) -> Field { return &r.record; },
     "whether every datagram is kept in trace.pcap"},
    {"silence_ms", [](RobotSettings& r) -> Field { return &r.silence; },
     "the stream has ended when nothing came for so long", 100, 3'600'000},
    {"queue_bytes", [](RobotSettings& r) -> Field { return &r.queue_bytes; },
     "room for datagrams that are answered but not yet processed", 64 << 10, 1 << 30},
    {"realtime", [](RobotSettings& r) -> Field { return &r.real_time.wish; },
     "locked memory and SCHED_FIFO for the reply thread: required, tried, or left alone"},
    {"realtime_priority", [](RobotSettings& r) -> Field { return &r.real_time.priority; },
     "of the reply thread under SCHED_FIFO", 1, 98},
    {"cpus", [](RobotSettings& r) -> Field { return &r.real_time.cpus; },
     "the reply thread runs on these processors only, and all others keep off; left out: any", 0,
     1023},
};

const Option kRecordingOptions[] = {
    {"memory_bytes", [](RobotSettings& r) -> Field { return &r.recording.memory_bytes; },
     "room for what waits for a slow disk", 1 << 20, 1 << 30},
    {"rotate_bytes", [](RobotSettings& r) -> Field { return &r.recording.rotate_bytes; },
     "a trace that has grown to this goes on in a new file", 1 << 20, kTebibyte},
    {"rotate_s", [](RobotSettings& r) -> Field { return &r.recording.rotate; },
     "and so does one that is as old as this", 60, 31'536'000},
    {"keep_free_bytes", [](RobotSettings& r) -> Field { return &r.recording.keep_free_bytes; },
     "while the disk has less room than this, nothing is recorded", 0, kTebibyte},
    {"keep_bytes", [](RobotSettings& r) -> Field { return &r.recording.keep_bytes; },
     "the oldest recordings of this robot go when all are larger than this; 0: none go", 0,
     1024 * kTebibyte},
    {"keep_days", [](RobotSettings& r) -> Field { return &r.recording.keep; },
     "recordings older than this go, results stay; 0: none go", 0, 36'500},
};

const Option kSignalOptions[] = {
    {"position", [](RobotSettings& r) -> Field { return &r.signals.position; },
     "where X, Y, Z of the tool stand in a telegram (mm)"},
    {"orientation", [](RobotSettings& r) -> Field { return &r.signals.orientation; },
     "where A, B, C of the tool stand in a telegram (deg)"},
    {"angles", [](RobotSettings& r) -> Field { return &r.signals.angles; },
     "where the actual axis angles stand in a telegram (deg), joint 1 first"},
};

bool required(const Field& field) {
  return field.index() < 3;
}

constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr std::string_view kDigits = "0123456789";

bool consists_of(std::string_view text, std::string_view more) {
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return kLetters.find(c) != kLetters.npos || kDigits.find(c) != kDigits.npos ||
           more.find(c) != more.npos;
  });
}

bool is_name(std::string_view text) {
  constexpr std::size_t kLongest = 64;
  return !text.empty() && text.size() <= kLongest && consists_of(text, "-_.") &&
         text.front() != '.' && text.front() != '-';
}

/// `Element` or `Element.attribute`, in the characters of XML names that controllers use.
bool is_signal(std::string_view text) {
  const auto dot = text.find('.');
  const auto is_part = [](std::string_view part) {
    return !part.empty() && consists_of(part, "-_:");
  };
  return is_part(text.substr(0, dot)) && (dot == text.npos || is_part(text.substr(dot + 1)));
}

/// Reads one option that is present.
struct Reader {
  const TomlTable& table;
  const Option& option;
  const fs::path& folder;  ///< of the settings file

  [[noreturn]] void wrong(const std::string& expected, const std::string& remedy) const {
    table.fail(option.key,
               "expected " + expected + ", found " + table.found(option.key) + ": " + remedy);
  }

  void operator()(std::string* name) const {
    *name = table.text(option.key);
    if (!is_name(*name))
      wrong("a name of at most 64 letters, digits, - _ . that begins with none of - .",
            "choose one that can name a folder");
  }
  void operator()(fs::path* path) const {
    *path = (folder / table.text(option.key)).lexically_normal();
  }
  void operator()(std::optional<fs::path>* path) const { (*this)(&path->emplace()); }
  void operator()(rsi::Endpoint* endpoint) const {
    const auto parsed = rsi::parse_endpoint(table.text(option.key));
    if (!parsed)
      wrong("an IPv4 address and a port (1 to 65535)", "write it like \"0.0.0.0:49152\"");
    *endpoint = *parsed;
  }
  void operator()(std::optional<std::uint32_t>* address) const {
    *address = rsi::parse_address(table.text(option.key));
    if (address->value_or(0) == 0)
      wrong("the controller's IPv4 address",
            "write it like \"192.168.1.20\", or leave the key out");
  }
  void operator()(bool* flag) const { *flag = table.flag(option.key); }
  void operator()(std::chrono::milliseconds* time) const {
    *time = std::chrono::milliseconds(table.whole_number(option.key, option.least, option.most));
  }
  void operator()(std::chrono::seconds* time) const {
    *time = std::chrono::seconds(table.whole_number(option.key, option.least, option.most));
  }
  void operator()(std::chrono::days* time) const {
    *time = std::chrono::days(table.whole_number(option.key, option.least, option.most));
  }
  void operator()(std::size_t* size) const {
    *size = static_cast<std::size_t>(table.whole_number(option.key, option.least, option.most));
  }
  void operator()(int* number) const {
    *number = static_cast<int>(table.whole_number(option.key, option.least, option.most));
  }
  void operator()(std::vector<int>* numbers) const {
    for (const double number : table.numbers(option.key)) {
      if (number < static_cast<double>(option.least) || number > static_cast<double>(option.most) ||
          number != std::floor(number))
        wrong("whole numbers from " + std::to_string(option.least) + " to " +
                  std::to_string(option.most),
              "write them like [2, 3], as `lscpu -e` counts them");
      numbers->push_back(static_cast<int>(number));
    }
  }
  void operator()(RealTime* wish) const {
    const std::string text = table.text(option.key);
    const auto found = std::find(kRealTime.begin(), kRealTime.end(), text);
    if (found == kRealTime.end())
      wrong("\"require\", \"try\" or \"off\"", "\"try\" takes what the system permits");
    *wish = static_cast<RealTime>(found - kRealTime.begin());
  }
  void operator()(Names* names) const {
    *names = table.texts(option.key);
    if (names->empty() || names->size() > 12) wrong("1 to 12 signals", "name one a joint");
    for (const auto& name : *names)
      if (!is_signal(name))
        table.fail(option.key, "expected signals like \"Act_X\" or \"Pos.X\", found \"" + name +
                                   "\": write the element, or element.attribute");
  }
  void operator()(Triple* triple) const {
    Names names;
    (*this)(&names);
    if (names.size() != 3) wrong("three signals", "name one for each of the three values");
    std::copy(names.begin(), names.end(), triple->begin());
  }
};

void read(const TomlTable& table, std::span<const Option> options,
          std::initializer_list<std::string_view> more_keys, const fs::path& folder,
          RobotSettings& robot) {
  std::vector<std::string_view> keys(more_keys);
  for (const Option& option : options) keys.push_back(option.key);
  table.allow_only(keys);
  for (const Option& option : options) {
    const Field field = option.field(robot);
    if (table.has(option.key))
      std::visit(Reader{table, option, folder}, field);
    else if (required(field))
      table.fail(option.key, "missing: add it (" + std::string(option.help) + ")");
  }
}

/// A socket on 0.0.0.0 takes the port on every address.
bool collide(const rsi::Endpoint& a, const rsi::Endpoint& b) {
  return a.port == b.port && (a.address == b.address || a.address == 0 || b.address == 0);
}

std::string names_text(std::span<const std::string> names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "[\"" : ", \"") + name + '"';
  return text + ']';
}

/// Fills in what the type of a field says: how its value is written, and the default.
struct Describer {
  const Option& option;
  OptionText& text;

  void operator()(std::string*) const { text.value = "name"; }
  void operator()(fs::path*) const { text.value = "path"; }
  void operator()(std::optional<fs::path>*) const { text.value = "path"; }
  void operator()(rsi::Endpoint*) const { text.value = "\"ADDRESS:PORT\""; }
  void operator()(std::optional<std::uint32_t>*) const { text.value = "\"ADDRESS\""; }
  void operator()(const bool* flag) const {
    text.value = "true or false";
    text.fallback = *flag ? "true" : "false";
  }
  void operator()(const std::chrono::milliseconds* time) const { whole_number(time->count()); }
  void operator()(const std::chrono::seconds* time) const { whole_number(time->count()); }
  void operator()(const std::chrono::days* time) const { whole_number(time->count()); }
  void operator()(const std::size_t* size) const { whole_number(static_cast<std::int64_t>(*size)); }
  void operator()(const int* number) const { whole_number(*number); }
  void operator()(const std::vector<int>*) const { text.value = "whole numbers in brackets"; }
  void operator()(const RealTime* wish) const {
    text.value = "\"require\", \"try\" or \"off\"";
    text.fallback = '"' + std::string(kRealTime[static_cast<std::size_t>(*wish)]) + '"';
  }
  void operator()(const Triple* names) const {
    text.value = "three signals";
    text.fallback = names_text(*names);
  }
  void operator()(const Names* names) const {
    text.value = "1 to 12 signals";
    text.fallback = names_text(*names);
  }

  void whole_number(std::int64_t value) const {
    text.value =
        "whole number, " + std::to_string(option.least) + " to " + std::to_string(option.most);
    text.fallback = std::to_string(value);
  }
};

}  // namespace

Settings load_settings(const fs::path& file) {
  const TomlTable top = TomlTable::load(file);
  top.allow_only({"robot"});
  const fs::path folder = file.parent_path();
  const std::vector<TomlTable> tables = top.tables("robot");

  Settings settings{file, {}};
  for (const TomlTable& table : tables) {
    RobotSettings robot;
    read(table, kRobotOptions, {kSignals, kRecording}, folder, robot);
    if (const auto signals = table.table(kSignals))
      read(*signals, kSignalOptions, {}, folder, robot);
    if (const auto recording = table.table(kRecording))
      read(*recording, kRecordingOptions, {}, folder, robot);

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
  return settings;
}

SettingsChange change(RobotSettings from, RobotSettings to) {
  SettingsChange change;
  const auto compare = [&](std::span<const Option> options, const std::string& prefix) {
    for (const Option& option : options) {
      const bool same = std::visit(
          [&](auto* value) { return *value == *std::get<decltype(value)>(option.field(to)); },
          option.field(from));
      const auto key = prefix + std::string(option.key);
      const bool fixed = std::count(kAfterRestart.begin(), kAfterRestart.end(), key) > 0;
      if (!same) (fixed ? change.after_restart : change.live).push_back(key);
    }
  };
  compare(kRobotOptions, "");
  compare(kSignalOptions, std::string(kSignals) + '.');
  compare(kRecordingOptions, std::string(kRecording) + '.');
  return change;
}

std::vector<OptionText> robot_options() {
  std::vector<OptionText> texts;
  RobotSettings defaults;
  const auto describe = [&](std::span<const Option> options, const std::string& prefix) {
    for (const Option& option : options) {
      const Field field = option.field(defaults);
      OptionText text{prefix + std::string(option.key), "", "", required(field),
                      std::string(option.help)};
      std::visit(Describer{option, text}, field);
      texts.push_back(std::move(text));
    }
  };
  describe(kRobotOptions, "");
  describe(kSignalOptions, std::string(kSignals) + '.');
  describe(kRecordingOptions, std::string(kRecording) + '.');
  return texts;
}

}  // namespace sweepd
