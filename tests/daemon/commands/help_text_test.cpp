#include "daemon/commands/help_text.hpp"

#include <algorithm>
#include <cctype>
#include <regex>
#include <sstream>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_line.hpp"
#include "daemon/settings/settings.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

namespace {

const std::filesystem::path kSource = SWEEPD_SOURCE_DIR;

/// In columns: what continues a character in UTF-8 takes none.
std::size_t help_width(const std::string& text) {
  std::istringstream lines(text);
  std::ptrdiff_t widest = 0;
  for (std::string line; std::getline(lines, line);)
    widest = std::max(widest, std::count_if(line.begin(), line.end(),
                                            [](unsigned char c) { return (c & 0xc0U) != 0x80U; }));
  return static_cast<std::size_t>(widest);
}

/// Each entry in one line, with one blank between words.
std::string in_one_line(const std::string& text) {
  return std::regex_replace(text, std::regex("\n +| +"), " ");
}

}  // namespace

TEST_CASE("the help of a command has an entry for each of its options, in 80 columns",
          "[help_text]") {
  const CommandLine line;
  const auto commands = line.app().get_subcommands({});
  CHECK(commands.size() >= 7);
  for (const auto* command : commands) {
    INFO(command->get_name());
    const auto help = command->help("sweepd");
    CHECK_THAT(help, StartsWith("Usage: sweepd " + command->get_name() + " [OPTION]..."));
    CHECK_THAT(help, ContainsSubstring("\n\nExit status:\n  0   "));
    CHECK(help_width(help) <= 80);
    for (const auto* option : command->get_options()) {
      INFO(option->get_name());
      const auto label = option->nonpositional() ? "--" + option->get_lnames().front()
                                                 : option->get_name() + R"((\.\.\.)?)";
      // Two blanks part it from its text, or a line of its own does.
      CHECK(std::regex_search(
          help, std::regex("\n  (-h, )?" + label + "( [^ \n]+)?(  +|\n {26})[A-Z][a-z]* ")));
    }
  }
  CHECK(help_width(line.app().help()) <= 80);
}

TEST_CASE("every text of the help is a phrase that begins with a capital and has no full stop",
          "[help_text]") {
  const auto check = [](const std::string& text) {
    INFO(text);
    REQUIRE(text.size() > 10);
    CHECK(std::isupper(static_cast<unsigned char>(text.front())) != 0);
    CHECK(text.back() != '.');
    CHECK(text.find(';') == std::string::npos);
  };
  for (const auto& command : command_text(CommandLine().app()).commands) {
    check(command.help);
    for (const auto& option : command.options) check(option.help);
  }
}

TEST_CASE("what an option needs, its limits and its default stand behind its text", "[help_text]") {
  const CommandLine line;
  const auto help = [&](const char* command) {
    return in_one_line(line.app().get_subcommand(command)->help("sweepd"));
  };
  CHECK_THAT(help("simulate"), ContainsSubstring("--robot FILE Read the robot description from "
                                                 "this file (required)"));
  CHECK_THAT(help("simulate"), ContainsSubstring("(0 to 15, default: 4)"));
  CHECK_THAT(help("simulate"),
             ContainsSubstring("\nOne of these options has to be given: --to ADDRESS:PORT "));
  CHECK_THAT(help("plan"), ContainsSubstring("(together with --propose)"));
  CHECK_THAT(help("replay"), StartsWith("Usage: sweepd replay [OPTION]... TRACE...\n"));
  CHECK_THAT(help("identify"), StartsWith("Usage: sweepd identify [OPTION]... [FILE]...\n"));
}

TEST_CASE("the program's help lists its commands, each with what it does", "[help_text]") {
  const CommandLine line;
  const auto help = in_one_line(line.app().help());
  CHECK_THAT(help, StartsWith("Usage: sweepd COMMAND [OPTION]..."));
  for (const auto& command : command_text(line.app()).commands)
    CHECK_THAT(help, ContainsSubstring(' ' + command.name + ' ' + command.help));
  CHECK_THAT(help, !ContainsSubstring("--bash-completion"));
}

TEST_CASE("every key of the settings stands in the section of its table, with range and default",
          "[help_text]") {
  CHECK(help_width(settings_text()) <= 80);
  const auto page = in_one_line(settings_text());
  const auto check = [&](const std::string& table, const std::vector<OptionText>& options) {
    CHECK_FALSE(options.empty());
    for (const auto& option : options) {
      INFO(option.key);
      const auto dot = option.key.find('.');
      auto within = dot == std::string::npos ? table : "[robot." + option.key.substr(0, dot) + "]";
      if (option.key.starts_with("device.")) within = '[' + within + ']';
      const auto begin = page.find('\n' + within + ':');
      REQUIRE(begin != std::string::npos);
      const auto section = page.substr(begin, page.find("\n\n", begin) - begin);
      auto entry = ' ' + option.key.substr(dot + 1) + " = " + option.value + ' ';
      const auto at = section.find(entry);
      REQUIRE(at != std::string::npos);
      entry = section.substr(at + entry.size());
      entry.resize(std::min(entry.size(), entry.find(" = ")));
      CHECK_THAT(entry, ContainsSubstring(option.help.substr(1)));
      CHECK((entry.find("Required.") != std::string::npos) == option.required);
      if (!option.fallback.empty())
        CHECK_THAT(entry, ContainsSubstring("Default: " + option.fallback));
    }
  };
  check("[[robot]]", robot_options());
  check("[http]", http_options());
  check("[publish]", sweepd::publish_options());
  check("[collect]", sweepd::collect_options());
}

TEST_CASE("the example of sweepd.toml(5) is valid", "[help_text]") {
  auto page = test::content(kSource / "daemon/commands/sweepd.toml.5.in");
  const auto begin = page.find(".RS 4\n", page.find("[EXAMPLE]")) + 6;
  page = page.substr(begin, page.find(".RE", begin) - begin);
  page = std::regex_replace(page, std::regex(R"(\\&|\.sp\n)"), "");
  const test::TemporaryFolder folder;
  const auto settings = load_settings(folder.write("sweepd.toml", page));
  CHECK(settings.robots.size() == 2);
  CHECK(settings.robots.at(1).recording.keep.count() == 30);
}

namespace {

CommandOption option_of(const std::string& command, const std::string& name) {
  for (const auto& text : command_text(CommandLine().app()).commands)
    for (const auto& option : text.options)
      if (text.name == command && option.names.front() == name) return option;
  FAIL(command << " has no " << name);
  return {};
}

}  // namespace

TEST_CASE("what an option takes is told in words, whichever checks are made of it", "[help_text]") {
  for (const auto& command : command_text(CommandLine().app()).commands)
    for (const auto& option : command.options) {
      INFO(command.name << ' ' << option.names.front() << ' ' << option.value);
      CHECK_FALSE(option.help.empty());
      CHECK(option.value.find_first_of(" []{}") == std::string::npos);
      for (const auto* type : {"INT", "FLOAT"}) CHECK(option.value.find(type) == std::string::npos);
    }
  CHECK(option_of("identify", "--joints").range == "1 to 12");
  CHECK(option_of("identify", "--joints").value == "N");
  CHECK(option_of("simulate", "--wobble-deg").range == "0 to 1");
  CHECK(option_of("plan", "--arm-radius-mm").range == "0 or more");
  CHECK(option_of("plan", "--column-mm").range == "more than 0");
  CHECK(option_of("plan", "--column-mm").value == "R");
  CHECK(option_of("plan", "--krl-tool").range == "1 to 128");
  CHECK(option_of("plan", "--device").needs == std::vector<std::string>{"--poses"});
  CHECK(option_of("listen", "--lines").range == "1 or more");
  CHECK(option_of("history", "--of").value == "arm|model");
  CHECK(option_of("history", "--level").range == "0.000001 to 0.5");
  CHECK(option_of("simulate", "--wobble-deg").fallback == "0.0001");
  CHECK(option_of("identify", "--frame").choices == std::vector<std::string>{"device", "robot"});
  CHECK(option_of("plan", "--write-plan").needs == std::vector<std::string>{"--propose"});
  CHECK(option_of("run", "--config").fallback == "/etc/sweepd/sweepd.toml");
  CHECK(option_of("run", "--listen").value == "ADDRESS:PORT");
  CHECK(option_of("replay", "--quiet").value.empty());
  CHECK(option_of("replay", "TRACE").required);
  CHECK(option_of("replay", "TRACE").repeated);
  CHECK(option_of("simulate", "--to").alternative == 1);
  CHECK(option_of("simulate", "--write").alternative == 1);
}

TEST_CASE("a value that an option does not take is told beside what it takes", "[help_text]") {
  const auto refused = [](std::initializer_list<const char*> given) {
    std::vector<const char*> words{"sweepd"};
    for (const char* word : given) words.push_back(word);
    std::string said = "nothing";
    try {
      static_cast<void>(CommandLine().execute(static_cast<int>(words.size()), words.data()));
    } catch (const std::invalid_argument& error) {
      said = error.what();
    }
    return said;
  };
  const auto simulate = [&](const char* option, const char* value) {
    return refused({"simulate", "--robot", "r", "--plan", "p", option, value});
  };
  CHECK_THAT(simulate("--to", "localhost:4000"),
             StartsWith("--to: expected an IPv4 address and a port (1 to 65535), as "
                        "192.168.1.10:49152, found localhost:4000: "));
  CHECK_THAT(simulate("--seed", "-1"), StartsWith("--seed: expected 0 or more, found -1: "));
  CHECK_THAT(simulate("--wobble-deg", "-1"),
             StartsWith("--wobble-deg: expected 0 to 1, found -1: "));
  CHECK_THAT(refused({"replay", "x", "--controller", "robot"}),
             StartsWith("--controller: expected an IPv4 address, as 192.168.1.20, found robot: "));
  CHECK_THAT(refused({"replay", "x", "--port", "99999"}),
             StartsWith("--port: expected 1 to 65535, found 99999: "));
  CHECK_THAT(refused({"listen", "udp://localhost:5005"}),
             StartsWith("PORT: expected udp:// or tcp://, "));
  CHECK_THAT(refused({"listen", "udp://0.0.0.0:5005", "--lines", "0"}),
             StartsWith("--lines: expected 1 or more, found 0: "));
  CHECK_THAT(refused({"plan", "--robot", "r", "--poses", "40", "--column-mm", "-1"}),
             StartsWith("--column-mm: expected more than 0, found -1: "));
  CHECK_THAT(refused({"plan", "--robot", "r", "--plan", "p", "--krl-tool", "200"}),
             StartsWith("--krl-tool: expected 1 to 128, found 200: "));
  CHECK_THAT(refused({"plan", "--robot", "r", "--plan", "p", "--device", "1,2,3"}),
             StartsWith("--device requires --poses: "));
}

TEST_CASE("an option without a group is hidden", "[help_text]") {
  CLI::App app("Do it\nOnce.\nAnd again.", "doer");
  bool given = false;
  app.add_flag("--seen", given, "See it");
  app.add_flag("--hidden", given, "Hide it")->group("");
  const auto text = command_text(app);
  REQUIRE(text.options.size() == 2);
  CHECK(text.options.at(0).names == std::vector<std::string>{"--help", "-h"});
  CHECK(text.options.at(1).names == std::vector<std::string>{"--seen"});
  CHECK(text.help == "Do it");
  CHECK(text.details == std::vector<std::string>{"Once.", "And again."});
}
