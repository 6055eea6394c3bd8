#include "daemon/settings/settings.hpp"

#include <fstream>
#include <sstream>
#include <utility>

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/daemon/texts.hpp"

using sweepd::load_settings;
using sweepd::TakesEffect;
using sweepd::test::replaced;
namespace fs = std::filesystem;

namespace {

/// A settings file in a folder of its own, which goes when the test ends.
struct SettingsFile {
  sweepd::test::TemporaryFolder folder;
  fs::path path;

  explicit SettingsFile(const std::string& text) : path(folder.write("sweepd.toml", text)) {}
};

/// The four keys that every robot must have, each in a line of its own after [[robot]].
const std::string kRobotText =
    "[[robot]]\nname = \"a\"\ndescription = \"a.toml\"\nlisten = \"0.0.0.0:49152\"\n"
    "output = \"out\"\n";

/// The mistakes, a line each, without the file's name; "no error" if the settings are fine.
std::string settings_error(const std::string& text) {
  const SettingsFile file(text);
  try {
    (void)load_settings(file.path);
  } catch (const sweepd::ConfigError& error) {
    const std::string prefix = file.path.string() + ':';
    std::istringstream lines(error.what());
    std::string mistakes;
    for (std::string line; std::getline(lines, line);) {
      REQUIRE(line.starts_with(prefix));
      mistakes += (mistakes.empty() ? "" : "\n") + line.substr(prefix.size());
    }
    return mistakes;
  }
  return "no error";
}

}  // namespace

TEST_CASE("a robot needs four keys, and the rest has defaults", "[settings]") {
  const SettingsFile file(kRobotText);
  const auto settings = load_settings(file.path);
  CHECK(settings.file == file.path);
  REQUIRE(settings.robots.size() == 1);
  const auto& robot = settings.robots[0];
  CHECK(robot.name == "a");
  CHECK(robot.listen == rsi::parse_endpoint("0.0.0.0:49152"));
  CHECK_FALSE(robot.controller);
  CHECK_FALSE(robot.ethernet_config);
  CHECK_FALSE(robot.plan);
  CHECK(robot.record);
  CHECK(robot.silence == std::chrono::seconds(2));
  CHECK(robot.queue_bytes == 4u * 1024 * 1024);
  CHECK(robot.signals.position[2] == "RIst.Z");
  CHECK(robot.signals.orientation[0] == "RIst.A");
  CHECK(robot.signals.angles.size() == 6);
}

TEST_CASE("every option of a robot can be set", "[settings]") {
  const SettingsFile file(
      kRobotText +
      "controller = \"192.168.1.20\"\nethernet_config = \"e.xml\"\nplan = \"p.toml\"\n"
      "record = false\nsilence_ms = 500\nqueue_bytes = 65536\nanswers_with_zeros = [\"DiO\"]\n"
      "[robot.signals]\nposition = [\"Act_X\", \"Act_Y\", \"Pos.Z\"]\n"
      "orientation = [\"A\", \"B\", \"C\"]\nangles = [\"GPIO.01\"]\n");
  const auto robot = load_settings(file.path).robots.at(0);
  CHECK(robot.controller == rsi::parse_address("192.168.1.20"));
  CHECK(robot.ethernet_config == file.folder / "e.xml");
  CHECK(robot.plan == file.folder / "p.toml");
  CHECK_FALSE(robot.record);
  CHECK(robot.silence == std::chrono::milliseconds(500));
  CHECK(robot.queue_bytes == 65536);
  CHECK(robot.answers_with_zeros.names == std::vector<std::string>{"DiO"});
  CHECK(robot.signals.position == std::array<std::string, 3>{"Act_X", "Act_Y", "Pos.Z"});
  CHECK(robot.signals.orientation == std::array<std::string, 3>{"A", "B", "C"});
  CHECK(robot.signals.angles == std::vector<std::string>{"GPIO.01"});
}

TEST_CASE("a relative path starts at the folder of the settings, an absolute one stays",
          "[settings]") {
  const SettingsFile file(replaced(replaced(kRobotText, "\"a.toml\"", "\"../x/./a.toml\""),
                                   "\"out\"", "\"/var/lib/sweepd\""));
  const auto robot = load_settings(file.path).robots.at(0);
  CHECK(robot.description == file.folder.path().parent_path() / "x" / "a.toml");
  CHECK(robot.output == "/var/lib/sweepd");
}

TEST_CASE("a required option that is missing is named with what it is for", "[settings]") {
  for (const std::string key : {"name", "description", "listen", "output"}) {
    std::string text = kRobotText;
    const auto begin = text.find(key + " =");
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    CHECK_THAT(settings_error(text),
               Catch::Matchers::StartsWith("1:1: robot." + key + ": missing: add it ("));
  }
}

TEST_CASE("a misspelt option is found in the robot, its signals and the file", "[settings]") {
  CHECK(settings_error(kRobotText + "recrod = true\n") ==
        "6:1: robot.recrod: unknown key: did you mean \"record\"?");
  CHECK(settings_error(kRobotText + "[robot.signal]\n") ==
        "6:8: robot.signal: unknown key: did you mean \"signals\"?");
  CHECK(settings_error(kRobotText + "[robot.signals]\nangels = [\"a\"]\n") ==
        "7:1: robot.signals.angels: unknown key: did you mean \"angles\"?");
  CHECK(settings_error("[[robots]]\n") == "1:3: robots: unknown key: did you mean \"robot\"?");
  SECTION("a misspelt required option is reported as misspelt rather than missing") {
    CHECK(settings_error(replaced(kRobotText, "listen", "lisen")) ==
          "4:1: robot.lisen: unknown key: did you mean \"listen\"?");
  }
}

TEST_CASE(
    "all mistakes of the file are told at once, from its top down, each with its place and key",
    "[settings]") {
  CHECK(settings_error("[htp]\n"
                       "[[robot]]\n"
                       "name = \"a b\"\n"
                       "description = \"a.toml\"\n"
                       "lisen = \"0.0.0.0:49152\"\n"
                       "recrod = true\n"
                       "silence_ms = 1\n"
                       "[robot.signals]\n"
                       "angles = []\n"
                       "[robot.recording]\n"
                       "rotate_s = \"60\"\n"
                       "[[robot.device]]\n"
                       "listen = \"5005\"\n"
                       "[[robot]]\n"
                       "name = \"b\"\n"
                       "description = \"b.toml\"\n"
                       "listen = \"0.0.0.0\"\n"
                       "output = 5\n"
                       "[http]\n"
                       "hosts = \"cell-pc\"\n"
                       "[publish]\n"
                       "broker = \"mqtt://a\"\n"
                       "site = \"b\"\n") ==
        "1:2: htp: unknown key: did you mean \"http\"?\n"
        "2:1: robot.output: missing: add it (folder under which recordings and results are kept, "
        "in OUTPUT/NAME/START)\n"
        "3:8: robot.name: expected a name of at most 64 letters, digits, - _ . that begins with "
        "none of - ., found the string \"a b\": choose one that can name a folder\n"
        "5:1: robot.lisen: unknown key: did you mean \"listen\"?\n"
        "6:1: robot.recrod: unknown key: did you mean \"record\"?\n"
        "7:14: robot.silence_ms: expected a whole number of milliseconds from 100 to 3600000, "
        "found the number 1: choose one in between\n"
        "9:10: robot.signals.angles: expected 1 to 12 signals, found an array of 0 values: name "
        "one a joint\n"
        "11:12: robot.recording.rotate_s: expected a whole number, found the string \"60\": write "
        "it without quotes\n"
        "12:1: robot.device.columns: missing: add it (what its lines hold, with commas between, as "
        "for identify --columns)\n"
        "13:10: robot.device.listen: expected udp:// or tcp://, an IPv4 address and a port (1 to "
        "65535), found the string \"5005\": write it like \"udp://0.0.0.0:5005\"\n"
        "17:10: robot.listen: expected an IPv4 address and a port (1 to 65535), found the string "
        "\"0.0.0.0\": write it like \"0.0.0.0:49152\"\n"
        "18:10: robot.output: expected a string, found the number 5: put it in quotes\n"
        "20:9: http.hosts: expected an array of strings, found the string \"cell-pc\": correct it\n"
        "21:1: publish.cell: missing: add it (the cell or hall of this machine, the third part)");
}

TEST_CASE("a key that belongs into another table is told where", "[settings]") {
  for (const std::string key : {"keep_days", "keep_day"})
    CHECK(settings_error(kRobotText + key + " = 3\n") ==
          "6:1: robot." + key + ": unknown key: did you mean \"keep_days\" of [robot.recording]?");
  CHECK(settings_error(kRobotText + "[http]\nsilence_ms = 300\n") ==
        "7:1: http.silence_ms: unknown key: did you mean \"silence_ms\" of [[robot]]?");
  CHECK(settings_error(kRobotText + "cell = \"1\"\n") ==
        "6:1: robot.cell: unknown key: did you mean \"cell\" of [publish]?");
  CHECK(settings_error(kRobotText + "[recording]\nkeep_days = 3\n") ==
        "6:2: recording: unknown key: did you mean [robot.recording]?");
  const std::string device = "listen = \"udp://0.0.0.0:5005\"\ncolumns = \"x_mm,y_mm,z_mm\"\n";
  CHECK(settings_error(kRobotText + "[[device]]\n" + device) ==
        "6:3: device: unknown key: did you mean [[robot.device]]?");
  CHECK(settings_error(kRobotText + "[[robot.device]]\n" + device + "column = \"x\"\n") ==
        "9:1: robot.device.column: unknown key: did you mean \"columns\"?");
  CHECK(settings_error(kRobotText + "[[robot.device]]\n" + device + "hosts = []\n") ==
        "9:1: robot.device.hosts: unknown key: did you mean \"hosts\" of [http]?");
}

TEST_CASE("a name that could not name a folder is refused", "[settings]") {
  const std::vector<std::string> wrong{"a/b", "..",   ".hidden", "-x",
                                       "a b", "a\\b", "ä",       std::string(65, 'x')};
  for (const auto& name : wrong)
    CHECK_THAT(settings_error(replaced(kRobotText, "\"a\"", '"' + name + '"')),
               Catch::Matchers::StartsWith("2:8: robot.name: expected a name"));
  CHECK(settings_error(replaced(kRobotText, "\"a\"", "\"KR5_arc-2.b\"")) == "no error");
}

TEST_CASE("addresses are checked", "[settings]") {
  CHECK(settings_error(replaced(kRobotText, "0.0.0.0:49152", "localhost:49152")) ==
        "4:10: robot.listen: expected an IPv4 address and a port (1 to 65535), found the string "
        "\"localhost:49152\": write it like \"0.0.0.0:49152\"");
  for (const auto* wrong : {"192.168.1.20:1", "0.0.0.0", "239.1.1.1", "robot"})
    CHECK_THAT(settings_error(kRobotText + "controller = \"" + wrong + "\"\n"),
               Catch::Matchers::StartsWith(
                   "6:14: robot.controller: expected the controller's IPv4 address"));
}

TEST_CASE("times and sizes are whole numbers within their ranges", "[settings]") {
  CHECK(settings_error(kRobotText + "silence_ms = \"abc\"\n") ==
        "6:14: robot.silence_ms: expected a whole number of milliseconds, found the string "
        "\"abc\": write it without quotes");
  for (const auto* text : {"queue_bytes = 65535", "queue_bytes = 1073741825", "queue_bytes = -1",
                           "silence_ms = 99", "silence_ms = 0"})
    CHECK_THAT(settings_error(kRobotText + text + "\n"),
               Catch::Matchers::ContainsSubstring("choose one in between"));
  CHECK(settings_error(kRobotText + "queue_bytes = 1073741824\nsilence_ms = 100\n") == "no error");
}

TEST_CASE("signals are an element, or an element and an attribute", "[settings]") {
  const auto position = [](const std::string& signals) {
    return settings_error(kRobotText + "[robot.signals]\nposition = " + signals + "\n");
  };
  CHECK_THAT(position("[\"X\", \"Y\"]"),
             Catch::Matchers::ContainsSubstring("expected three signals, found an array of 2"));
  CHECK_THAT(position("\"X\""), Catch::Matchers::ContainsSubstring("expected an array of strings"));
  for (const std::string wrong : {"", ".", "a.", ".a", "a.b.c", "a b", "<a>"})
    CHECK_THAT(position("[\"X\", \"Y\", \"" + wrong + "\"]"),
               Catch::Matchers::ContainsSubstring("found \"" + wrong + "\": write the element"));
  CHECK_THAT(settings_error(kRobotText + "[robot.signals]\nangles = []\n"),
             Catch::Matchers::ContainsSubstring("expected 1 to 12 signals"));
  CHECK(settings_error(kRobotText + "[robot.signals]\nangles = [\"E.A1\", \"E.A2\", \"E.A1\"]\n") ==
        "7:10: robot.signals.angles: expected each signal once, found \"E.A1\" twice: name the "
        "signal of each joint");
}

TEST_CASE("two robots share neither a name nor a port on one address", "[settings]") {
  std::string second = replaced(replaced(kRobotText, "\"a\"", "\"b\""), "49152", "49153");
  CHECK(settings_error(kRobotText + second) == "no error");
  CHECK(settings_error(kRobotText + replaced(second, "\"b\"", "\"a\"")) ==
        "7:8: robot.name: expected a name of its own, found the name of the robot in line 1: "
        "change one");
  CHECK(settings_error(kRobotText + replaced(second, "49153", "49152")) ==
        "9:10: robot.listen: expected an address and port of its own, found 0.0.0.0:49152, which "
        "collides with 0.0.0.0:49152 of the robot in line 1: choose another port");
  SECTION("0.0.0.0 takes a port on every address") {
    CHECK_THAT(settings_error(kRobotText + replaced(second, "0.0.0.0:49153", "10.0.0.1:49152")),
               Catch::Matchers::ContainsSubstring("collides with"));
  }
  SECTION("one port on two addresses is fine") {
    CHECK(settings_error(replaced(kRobotText, "0.0.0.0", "10.0.0.1") +
                         replaced(second, "0.0.0.0:49153", "10.0.0.2:49152")) == "no error");
  }
}

TEST_CASE("no two ports of the file are the same, whoever listens on them", "[settings]") {
  using Catch::Matchers::ContainsSubstring;
  const std::string second = replaced(replaced(kRobotText, "\"a\"", "\"b\""), "49152", "49153");
  const auto device = [](const std::string& listen) {
    return "[[robot.device]]\nlisten = \"" + listen + "\"\ncolumns = \"x_mm,y_mm,z_mm\"\n";
  };
  CHECK(settings_error(kRobotText + device("udp://0.0.0.0:5005") + second +
                       device("udp://10.0.0.1:5005")) ==
        "15:10: robot.device.listen: expected an address and port of its own, found "
        "udp://10.0.0.1:5005, which collides with 0.0.0.0:5005 of the device in line 6: choose "
        "another port");
  CHECK(settings_error(kRobotText + device("udp://0.0.0.0:5005") + second +
                       device("tcp://0.0.0.0:5005")) == "no error");
  CHECK_THAT(settings_error(kRobotText + device("udp://0.0.0.0:49153") + second),
             ContainsSubstring("collides with 0.0.0.0:49153 of the device in line 6"));
  CHECK_THAT(settings_error(kRobotText + second + device("udp://0.0.0.0:49152")),
             ContainsSubstring("collides with 0.0.0.0:49152 of the robot in line 1"));
  SECTION("a recording tells a device from its controller by the port alone") {
    CHECK_THAT(settings_error(kRobotText + device("tcp://0.0.0.0:49152")),
               ContainsSubstring("collides with 0.0.0.0:49152 of the robot in line 1"));
  }
  SECTION("the pages are on a TCP port, also where the file does not name it") {
    CHECK_THAT(settings_error(kRobotText + device("tcp://0.0.0.0:19152")),
               ContainsSubstring("collides with 127.0.0.1:19152 of the pages"));
    CHECK(settings_error(kRobotText + device("udp://0.0.0.0:19152")) == "no error");
    CHECK(settings_error(kRobotText + device("tcp://0.0.0.0:19152") +
                         "[http]\nlisten = \"off\"\n") == "no error");
  }
}

TEST_CASE("settings without a robot are refused", "[settings]") {
  CHECK_THAT(settings_error(""),
             Catch::Matchers::ContainsSubstring("missing: expected at least one table [[robot]]"));
}

TEST_CASE("the manual lists every option with its default and range", "[settings]") {
  const auto options = sweepd::robot_options();
  const auto option = [&](const std::string& key) {
    for (const auto& text : options)
      if (text.key == key) return text;
    FAIL("no option " + key);
    return options[0];
  };
  CHECK(options.size() == 25);
  CHECK(option("realtime").fallback == "\"try\"");
  CHECK(option("recording.keep_days").fallback == "0");
  CHECK(option("listen").required);
  CHECK(option("listen").fallback.empty());
  CHECK_FALSE(option("controller").required);
  CHECK(option("record").fallback == "true");
  CHECK(option("silence_ms").fallback == "2000");
  CHECK(option("queue_bytes").value == "whole number, 65536 to 1073741824");
  CHECK(option("signals.position").fallback == "[\"RIst.X\", \"RIst.Y\", \"RIst.Z\"]");
  for (const auto& text : options) CHECK_FALSE(text.help.empty());

  const auto http = sweepd::http_options();
  REQUIRE(http.size() == 2);
  CHECK(http[0].key == "listen");
  CHECK(http[0].value == "\"ADDRESS:PORT\" or \"off\"");
  CHECK(http[0].fallback == "\"127.0.0.1:19152\"");
  CHECK_FALSE(http[0].required);
  CHECK(http[1].key == "hosts");
  CHECK(http[1].fallback == "[]");
}

TEST_CASE("the pages are served on the loopback interface unless [http] says otherwise",
          "[settings]") {
  const auto http = [](const std::string& text) {
    const SettingsFile file(kRobotText + text);
    return load_settings(file.path).http;
  };
  CHECK(http("").listen == rsi::parse_endpoint("127.0.0.1:19152"));
  CHECK(http("").hosts.names.empty());
  CHECK(http("[http]\n").listen == rsi::parse_endpoint("127.0.0.1:19152"));
  CHECK_FALSE(http("[http]\nlisten = \"off\"\n").listen);
  const auto changed =
      http("[http]\nlisten = \"0.0.0.0:80\"\nhosts = [\"cell-pc\", \"10.0.0.5\"]\n");
  CHECK(changed.listen == rsi::parse_endpoint("0.0.0.0:80"));
  CHECK(changed.hosts.names == std::vector<std::string>{"cell-pc", "10.0.0.5"});
  CHECK(sweepd::change(http(""), http("")).of(TakesEffect::after_restart).empty());
  CHECK(sweepd::change(http(""), changed).of(TakesEffect::after_restart) ==
        std::vector<std::string>{"http.listen", "http.hosts"});
}

TEST_CASE("mistakes in [http] are found", "[settings]") {
  CHECK(settings_error("[htp]\n" + kRobotText) == "1:2: htp: unknown key: did you mean \"http\"?");
  CHECK(settings_error(kRobotText + "[http]\nlissen = \"off\"\n") ==
        "7:1: http.lissen: unknown key: did you mean \"listen\"?");
  CHECK(settings_error(kRobotText + "[http]\nlisten = \"localhost:80\"\n") ==
        "7:10: http.listen: expected an IPv4 address and a port (1 to 65535), or \"off\", found "
        "the string \"localhost:80\": write it like \"127.0.0.1:19152\"");
  for (const auto& wrong :
       std::vector<std::string>{"a b", "http://a", "a:80", "[::1]", std::string(254, 'a')})
    CHECK_THAT(settings_error(kRobotText + "[http]\nhosts = [\"" + wrong + "\"]\n"),
               Catch::Matchers::ContainsSubstring("write them without scheme and port"));
}

TEST_CASE("the shipped settings are valid", "[settings]") {
  const fs::path config = fs::path(SWEEPD_SOURCE_DIR) / "config";
  const auto settings = load_settings(config / "sweepd.toml");
  REQUIRE(settings.robots.size() == 1);
  const auto& robot = settings.robots[0];
  CHECK(robot.name == "kr5-arc");
  CHECK(robot.description == config / "robots" / "kr5_arc.toml");
  CHECK(robot.ethernet_config == config / "controller" / "krc4" / "sweepd_ethernet.xml");
  CHECK(robot.output == "/var/lib/sweepd");
  CHECK(robot.listen == rsi::parse_endpoint("0.0.0.0:49152"));
}

TEST_CASE("the shipped settings show every option, and the true default of each", "[settings]") {
  std::ifstream in(fs::path(SWEEPD_SOURCE_DIR) / "config" / "sweepd.toml");
  std::ostringstream content;
  content << in.rdbuf();
  const std::string text = content.str();
  auto options = sweepd::robot_options();
  for (auto& option : sweepd::http_options()) options.push_back(std::move(option));
  for (auto& option : sweepd::publish_options()) options.push_back(std::move(option));
  for (const auto& option : options) {
    const std::string key = option.key.substr(option.key.find('.') + 1);
    INFO(key);
    if (option.fallback.empty())
      CHECK_THAT(text, Catch::Matchers::ContainsSubstring("\n" + key + " = ") ||
                           Catch::Matchers::ContainsSubstring("\n#" + key + " = "));
    else
      CHECK_THAT(text, Catch::Matchers::ContainsSubstring("\n#" + key + " = " + option.fallback));
  }
  SECTION("and what they show in comments is valid when it is uncommented") {
    std::string shown;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      shown += (line.starts_with('#') && !line.starts_with("# ") ? line.substr(1) : line) + '\n';
    const SettingsFile file(shown);
    const auto robot = load_settings(file.path).robots.at(0);
    CHECK(robot.controller == rsi::parse_address("192.168.1.20"));
    CHECK(robot.plan == file.folder / "plans" / "kr5_arc_90deg.toml");
    CHECK(robot.signals.angles == sweepd::SignalNames{}.angles);
    const auto publish = load_settings(file.path).publish.value();
    CHECK(sweepd::text(publish.broker.address) == "mqtt://plant-server:1883");
    CHECK(publish.site.text == "north");
    CHECK(publish.broker.user == "hall-2");
    CHECK(publish.broker.password_file == "/etc/sweepd/mqtt-password");
    CHECK(publish.spool == "/var/lib/sweepd-publish");
  }
}

TEST_CASE("the documents tell which options need a restart", "[settings]") {
  std::ifstream in(fs::path(SWEEPD_SOURCE_DIR) / "docs" / "install.md");
  auto options = sweepd::robot_options();
  for (auto& option : sweepd::http_options()) options.push_back(std::move(option));
  std::size_t compared = 0;
  for (std::string line; std::getline(in, line) && line != "### `[publish]`";)
    for (const auto& option : options) {
      const std::string key = option.key.substr(option.key.find('.') + 1);
      if (!line.starts_with("| `" + key + "` |")) continue;
      INFO(line);
      CHECK((line.find("| yes |") != line.npos) ==
            (option.takes_effect == TakesEffect::after_restart));
      ++compared;
    }
  CHECK(compared >= options.size());
}

TEST_CASE("tags to be answered with zeros need the Ethernet file that has them",
          "[settings][issue11][point_1]") {
  CHECK_THAT(settings_error(kRobotText + "answers_with_zeros = [\"RKorr.X\"]\n"),
             Catch::Matchers::StartsWith("6:") &&
                 Catch::Matchers::ContainsSubstring("expected `ethernet_config` beside it"));
  CHECK(settings_error(kRobotText + "answers_with_zeros = []\n") == "no error");
}

TEST_CASE("real time and recording have keys of their own", "[settings]") {
  const SettingsFile file(kRobotText +
                          "realtime = \"require\"\nrealtime_priority = 42\ncpus = [2, 3]\n"
                          "[robot.recording]\nrotate_bytes = 1048576\nrotate_s = 60\n"
                          "keep_free_bytes = 0\nkeep_bytes = 5\nkeep_days = 30\n"
                          "memory_bytes = 2097152\n");
  const auto robot = load_settings(file.path).robots.front();
  CHECK(robot.real_time.wish == sweepd::RealTime::require);
  CHECK(robot.real_time.priority == 42);
  CHECK(robot.real_time.cpus == std::vector{2, 3});
  CHECK(robot.recording.rotate_bytes == 1 << 20);
  CHECK(robot.recording.rotate == std::chrono::seconds(60));
  CHECK(robot.recording.keep_free_bytes == 0);
  CHECK(robot.recording.keep_bytes == 5);
  CHECK(robot.recording.keep == std::chrono::days(30));
  CHECK(robot.recording.memory_bytes == 2 << 20);

  CHECK_THAT(settings_error(kRobotText + "realtime = \"yes\"\n"),
             Catch::Matchers::ContainsSubstring("expected \"require\", \"try\" or \"off\""));
  CHECK_THAT(settings_error(kRobotText + "cpus = [1.5]\n"),
             Catch::Matchers::ContainsSubstring("expected whole numbers from 0 to 1023"));
  CHECK_THAT(settings_error(kRobotText + "[robot.recording]\nkeep_dayz = 1\n"),
             Catch::Matchers::ContainsSubstring("keep_days"));
}

TEST_CASE("what differs between two settings is told, and what of it needs a restart",
          "[settings]") {
  sweepd::RobotSettings from;
  CHECK(sweepd::change(from, from).of(TakesEffect::next_session).empty());
  CHECK(sweepd::change(from, from).of(TakesEffect::after_restart).empty());
  auto to = from;
  to.silence = std::chrono::milliseconds(3000);
  to.plan = "plan.toml";
  to.signals.angles = {"E1"};
  to.recording.keep = std::chrono::days(7);
  to.listen.port = 1;
  to.controller = 2;
  to.ethernet_config = "e.xml";
  to.answers_with_zeros.names = {"RKorr.X"};
  to.queue_bytes = 1 << 20;
  to.real_time.wish = sweepd::RealTime::off;
  to.real_time.cpus = {1};
  const auto change = sweepd::change(from, to);
  CHECK(change.of(TakesEffect::next_session) ==
        std::vector<std::string>{"plan", "silence_ms", "signals.angles"});
  CHECK(change.of(TakesEffect::at_once) == std::vector<std::string>{"recording.keep_days"});
  CHECK(change.of(TakesEffect::after_restart) ==
        std::vector<std::string>{"listen", "controller", "ethernet_config", "answers_with_zeros",
                                 "queue_bytes", "realtime", "cpus"});

  // What is said to need no restart is what a sweepd that runs takes over.
  auto running = from;
  sweepd::take_over_live(running, to);
  CHECK(sweepd::change(running, to).of(TakesEffect::at_once).empty());
  CHECK(sweepd::change(running, to).of(TakesEffect::next_session).empty());
  CHECK(sweepd::change(running, to).of(TakesEffect::after_restart) ==
        change.of(TakesEffect::after_restart));
  CHECK(running.silence == to.silence);
  CHECK(running.listen == from.listen);
}

TEST_CASE("a robot may have a device that sends lines of text", "[settings]") {
  const std::string device =
      "[[robot.device]]\nlisten = \"udp://0.0.0.0:5005\"\ncolumns = \"x_mm,y_mm,z_mm\"\n";
  {
    const SettingsFile file(kRobotText + device);
    const auto robot = load_settings(file.path).robots.front();
    CHECK(robot.device.there());
    CHECK(text(robot.device.listen) == "udp://0.0.0.0:5005");
    CHECK(robot.device.columns.text == "x_mm,y_mm,z_mm");
  }
  {
    const SettingsFile file(kRobotText);
    CHECK_FALSE(load_settings(file.path).robots.front().device.there());
  }
  CHECK(sweepd::parse_text_port("10.0.0.1:5005") == sweepd::parse_text_port("udp://10.0.0.1:5005"));
  CHECK(sweepd::parse_text_port("tcp://10.0.0.1:5005")->tcp);
  CHECK_FALSE(sweepd::parse_text_port("http://10.0.0.1:5005"));
  using Catch::Matchers::ContainsSubstring;
  CHECK_THAT(settings_error(kRobotText + replaced(device, "udp://0.0.0.0:5005", "5005")),
             ContainsSubstring("write it like \"udp://0.0.0.0:5005\""));
  CHECK_THAT(settings_error(kRobotText + replaced(device, "5005", "49152")),
             ContainsSubstring("port of its own"));
  CHECK_THAT(settings_error(kRobotText + device + replaced(device, "5005", "5006")),
             ContainsSubstring("expected one [[robot.device]]"));
  CHECK_THAT(settings_error(kRobotText + "[[robot.device]]\nlisten = \"udp://0.0.0.0:5005\"\n"),
             ContainsSubstring("columns"));
}

TEST_CASE("the shipped settings of collect show every option", "[settings]") {
  const auto file = fs::path(SWEEPD_SOURCE_DIR) / "config" / "collect.toml";
  std::ifstream in(file);
  std::ostringstream content;
  content << in.rdbuf();
  for (const auto& option : sweepd::collect_options()) {
    INFO(option.key);
    CHECK_THAT(content.str(), Catch::Matchers::ContainsSubstring("\n" + option.key + " = ") ||
                                  Catch::Matchers::ContainsSubstring("\n#" + option.key + " = "));
  }
  const auto settings = sweepd::load_collect_settings(file);
  CHECK(settings.broker.address == sweepd::parse_broker("mqtt://127.0.0.1"));
  CHECK(settings.database.text == "host=/run/postgresql dbname=sweepd");
}

TEST_CASE("a broker has a scheme, a host and perhaps a port", "[settings]") {
  using sweepd::parse_broker;
  CHECK(text(parse_broker("mqtts://a").value()) == "mqtts://a:8883");
  CHECK(text(parse_broker("mqtt://a:2").value()) == "mqtt://a:2");
  for (const char* const wrong : {"", "a:1883", "tcp://a", "mqtt://", "mqtt://:1", "mqtt://a:0",
                                  "mqtt://a:65536", "mqtt://a:1x", "mqtt://a/b", "mqtt://u@a"})
    CHECK_FALSE(parse_broker(wrong));
  CHECK_THAT(settings_error(kRobotText + "[publish]\nbroker = \"a\"\nsite = \"b\"\ncell = \"c\"\n"),
             Catch::Matchers::ContainsSubstring("mqtt://plant-server:1883"));
  CHECK_THAT(settings_error(kRobotText + "[publish]\nbroker = \"mqtt://a\"\nsite = \"b\"\n"),
             Catch::Matchers::ContainsSubstring("cell: missing"));
}

TEST_CASE("a second collector has a name of its own at the broker", "[settings]") {
  const sweepd::test::TemporaryFolder folder;
  const std::string one = "[collect]\nbroker = \"mqtt://a\"\ndatabase = \"dbname=x\"\n";
  CHECK(sweepd::load_collect_settings(folder.write("a.toml", one)).client.text == "sweepd-collect");
  CHECK(sweepd::load_collect_settings(folder.write("b.toml", one + "client = \"second\"\n"))
            .client.text == "second");
}
