#include "daemon/settings/option.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "identify/sweeps/sample.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;
using Triple = std::array<std::string, 3>;
using Names = std::vector<std::string>;

static_assert(std::is_same_v<std::size_t, std::uint64_t>,
              "sizes of files are read as whole numbers");

constexpr std::array<std::string_view, 3> kRealTime{"require", "try",
                                                    "off"};  // in RealTime's order
constexpr std::string_view kOff = "off";

constexpr std::size_t kMostHosts = 32;

std::string a_signal_each() {
  return fmt::format("1 to {} signals", identify::kMostJoints);
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

/// A name or an IPv4 address, without a port.
bool is_host(std::string_view text) {
  constexpr std::size_t kLongest = 253;  // RFC 1035
  return !text.empty() && text.size() <= kLongest && consists_of(text, "-.");
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
  void operator()(std::optional<rsi::Endpoint>* endpoint) const {
    const std::string text = table.text(option.key);
    *endpoint = rsi::parse_endpoint(text);
    if (!*endpoint && text != kOff)
      wrong("an IPv4 address and a port (1 to 65535), or \"off\"",
            "write it like \"127.0.0.1:19152\"");
  }
  void operator()(std::optional<std::uint32_t>* address) const {
    constexpr std::uint32_t kFirstOfMany = 224U << 24;  // multicast, reserved, broadcast
    *address = rsi::parse_address(table.text(option.key));
    if (address->value_or(0) == 0 || **address >= kFirstOfMany)
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
    for (const double number : table.numbers(option.key, static_cast<double>(option.least),
                                             static_cast<double>(option.most))) {
      if (number != std::floor(number))
        wrong(fmt::format("whole numbers from {} to {}", option.least, option.most),
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
    if (names->empty() || names->size() > identify::kMostJoints)
      wrong(a_signal_each(), "name one a joint");
    for (const auto& name : *names)
      if (!is_signal(name))
        table.fail(option.key, "expected signals like \"Act_X\" or \"Pos.X\", found \"" +
                                   rsi::in_short(name) +
                                   "\": write the element, or element.attribute");
    for (auto name = names->begin(); name != names->end(); ++name)
      if (std::find(names->begin(), name, *name) != name)
        table.fail(option.key, "expected each signal once, found \"" + rsi::in_short(*name) +
                                   "\" twice: name the signal of each joint");
  }
  void operator()(Triple* triple) const {
    Names names;
    (*this)(&names);
    if (names.size() != 3) wrong("three signals", "name one for each of the three values");
    std::copy(names.begin(), names.end(), triple->begin());
  }
  void operator()(HostNames* hosts) const {
    hosts->names = table.texts(option.key);
    if (hosts->names.size() > kMostHosts)
      wrong(fmt::format("at most {} names", kMostHosts), "name those that people type");
    for (const auto& host : hosts->names)
      if (!is_host(host))
        table.fail(option.key,
                   "expected names of this machine like \"cell-pc\" or "
                   "\"192.168.1.5\", found \"" +
                       host + "\": write them without scheme and port");
  }
  void operator()(TagNames* tags) const { tags->names = table.texts(option.key); }
  void operator()(TextPort* port) const {
    const auto parsed = parse_text_port(table.text(option.key));
    if (!parsed)
      wrong("udp:// or tcp://, an IPv4 address and a port (1 to 65535)",
            "write it like \"udp://0.0.0.0:5005\"");
    *port = *parsed;
  }
  void operator()(ColumnList* columns) const {
    *columns = {table.text(option.key), table.place(option.key)};
  }
  void operator()(BrokerAddress* broker) const {
    const auto parsed = parse_broker(table.text(option.key));
    if (!parsed)
      wrong("mqtt:// or mqtts://, a host and perhaps a port (1 to 65535)",
            "write it like \"mqtt://plant-server:1883\"");
    *broker = *parsed;
  }
  void operator()(Words* words) const { words->text = table.text(option.key); }
  void operator()(std::optional<std::string>* words) const { *words = table.text(option.key); }
};

std::string names_text(std::span<const std::string> names) {
  std::string text = "[";
  for (const auto& name : names) text += (text.size() == 1 ? "\"" : ", \"") + name + '"';
  return text + ']';
}

/// Fills in what the type of a field says: how its value is written, and the default.
struct Describer {
  const Option& option;
  OptionText& text;

  void operator()(const std::string*) const { text.value = "name"; }
  void operator()(const fs::path* path) const {
    text.value = "path";
    if (!path->empty()) text.fallback = '"' + path->string() + '"';
  }
  void operator()(const BrokerAddress*) const {
    text.value = "\"mqtt://HOST:PORT\" or \"mqtts://HOST:PORT\"";
  }
  void operator()(const Words* words) const {
    text.value = "text";
    if (!words->text.empty()) text.fallback = '"' + words->text + '"';
  }
  void operator()(const std::optional<std::string>*) const { text.value = "text"; }
  void operator()(const std::optional<fs::path>*) const { text.value = "path"; }
  void operator()(const rsi::Endpoint*) const { text.value = "\"ADDRESS:PORT\""; }
  void operator()(const std::optional<rsi::Endpoint>* endpoint) const {
    text.value = "\"ADDRESS:PORT\" or \"off\"";
    text.fallback = '"' + (*endpoint ? rsi::text(**endpoint) : std::string(kOff)) + '"';
  }
  void operator()(const std::optional<std::uint32_t>*) const { text.value = "\"ADDRESS\""; }
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
    text.value = a_signal_each();
    text.fallback = names_text(*names);
  }
  void operator()(const HostNames* hosts) const {
    text.value = fmt::format("at most {} names of hosts", kMostHosts);
    text.fallback = names_text(hosts->names);
  }
  void operator()(const TextPort*) const {
    text.value = "\"udp://ADDRESS:PORT\" or \"tcp://ADDRESS:PORT\"";
  }
  void operator()(const ColumnList*) const { text.value = "names with commas between"; }
  void operator()(const TagNames* tags) const {
    text.value = "tags in brackets";
    text.fallback = names_text(tags->names);
  }

  void whole_number(std::int64_t value) const {
    text.value = fmt::format("whole number, {} to {}", option.least, option.most);
    text.fallback = std::to_string(value);
  }
};

}  // namespace

void read_options(const TomlTable& table, const Options& options,
                  std::initializer_list<std::string_view> more_keys, const fs::path& folder,
                  const std::vector<KeyElsewhere>& elsewhere) {
  std::vector<std::string_view> keys(more_keys);
  for (const Option& option : options) keys.push_back(option.key);
  Mistakes mistakes;
  const auto meant = table.check_keys(keys, elsewhere, mistakes);
  for (const Option& option : options)
    mistakes.of([&] {
      if (table.has(option.key))
        std::visit(Reader{table, option, folder}, option.field);
      else if (option.required && std::find(meant.begin(), meant.end(), option.key) == meant.end())
        table.fail(option.key, "missing: add it (" + std::string(option.help) + ")");
    });
  mistakes.tell();
}

std::vector<OptionText> option_texts(const Options& options, const std::string& prefix) {
  std::vector<OptionText> texts;
  for (const Option& option : options) {
    OptionText text{prefix + std::string(option.key),
                    "",
                    "",
                    option.required,
                    std::string(option.help),
                    option.takes_effect};
    std::visit(Describer{option, text}, option.field);
    texts.push_back(std::move(text));
  }
  return texts;
}

Option required(Option option) {
  option.required = true;
  return option;
}

Option at_once(Option option) {
  option.takes_effect = TakesEffect::at_once;
  return option;
}

Option after_restart(Option option) {
  option.takes_effect = TakesEffect::after_restart;
  return option;
}

SettingsChange differing(const Options& from, const Options& to, const std::string& prefix) {
  SettingsChange change;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const bool same =
        std::visit([&](auto* value) { return *value == *std::get<decltype(value)>(to[i].field); },
                   from[i].field);
    if (!same) change.of(from[i].takes_effect).push_back(prefix + std::string(from[i].key));
  }
  return change;
}

void take_over_live(const Options& to, const Options& from) {
  for (std::size_t i = 0; i < to.size(); ++i)
    if (to[i].takes_effect != TakesEffect::after_restart)
      std::visit([&](auto* value) { *value = *std::get<decltype(value)>(from[i].field); },
                 to[i].field);
}

}  // namespace sweepd
