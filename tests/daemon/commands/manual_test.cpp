#include "daemon/commands/manual.hpp"

#include <regex>
#include <set>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_line.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;

namespace {

const std::filesystem::path kSource = SWEEPD_SOURCE_DIR;

/// What a reader sees of a page, but for its layout.
std::string plain(const std::string& roff) {
  return std::regex_replace(std::regex_replace(roff, std::regex(R"(\\f[BIR])"), ""),
                            std::regex(R"(\\([-&]))"), "$1");
}

/// The long options that --help of a command tells.
std::set<std::string> long_options(const CLI::App& command) {
  static const std::regex kOption("--[a-z][a-z-]*");
  std::set<std::string> names;
  // What the footer mentions is no entry of its own.
  auto help = command.help();
  help.resize(help.size() - std::min(help.size(), command.get_footer().size()));
  for (std::sregex_iterator at(help.begin(), help.end(), kOption), end; at != end; ++at)
    names.insert(at->str());
  return names;
}

std::string section(const std::string& page, const std::string& name) {
  const auto begin = page.find(".SS " + name + "\n");
  REQUIRE(begin != page.npos);
  return page.substr(begin, page.find("\n.SS ", begin + 1) - begin);
}

CommandOption option_of(const std::string& command, const std::string& name) {
  for (const auto& text : command_text(CommandLine().app()).commands)
    for (const auto& option : text.options)
      if (text.name == command && option.names.front() == name) return option;
  FAIL(command << " has no " << name);
  return {};
}

}  // namespace

TEST_CASE("the manual has a section for every command and in it an entry for every option",
          "[manual]") {
  const CommandLine line;
  const auto page = plain(commands_roff(command_text(line.app())));
  const auto commands = line.app().get_subcommands({});
  CHECK(commands.size() >= 7);
  for (const auto* command : commands) {
    INFO(command->get_name());
    const auto text = section(page, command->get_name());
    CHECK_THAT(text, ContainsSubstring("sweepd " + command->get_name()));
    for (const auto& option : long_options(*command)) {
      if (option == "--help") continue;
      INFO(option);
      CHECK(std::regex_search(text, std::regex("\n\\.TP\n" + option + "( .*)?\n[A-Z0-9]")));
    }
  }
  const auto own = plain(options_roff(command_text(line.app())));
  CHECK_THAT(own, ContainsSubstring("-h, --help\n") && ContainsSubstring("--version\n"));
}

TEST_CASE("what an option takes is told in words, whichever checks are made of it", "[manual]") {
  for (const auto& command : command_text(CommandLine().app()).commands)
    for (const auto& option : command.options) {
      INFO(command.name << ' ' << option.names.front() << ' ' << option.value);
      CHECK_FALSE(option.help.empty());
      CHECK(option.value.find_first_of(" []{}") == std::string::npos);
      for (const auto* type : {"INT", "FLOAT"}) CHECK(option.value.find(type) == std::string::npos);
    }
  CHECK(option_of("identify", "--joints").range == "1 to 12");
  CHECK(option_of("identify", "--joints").value == "N");
  CHECK(option_of("simulate", "--wobble-deg").range == "0 or more");
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

TEST_CASE("a command is shown as it is called", "[manual]") {
  const auto page = plain(commands_roff(command_text(CommandLine().app())));
  CHECK_THAT(page, ContainsSubstring("\nsweepd replay [OPTION ...] TRACE ...\n"));
  CHECK_THAT(page, ContainsSubstring("\nsweepd simulate --robot FILE --plan FILE "
                                     "{--to ADDRESS:PORT | --write TRACE.pcap} [OPTION ...]\n"));
}

TEST_CASE("every key of the settings stands in the section of its table, with range and default",
          "[manual]") {
  const auto check = [](const char* table, const std::vector<OptionText>& options) {
    const auto page = plain(settings_roff(table, options));
    CHECK_FALSE(options.empty());
    for (const auto& option : options) {
      INFO(option.key);
      const auto dot = option.key.find('.');
      const auto within =
          dot == std::string::npos ? table : "[robot." + option.key.substr(0, dot) + "]";
      const auto text = section(page, within);
      const auto key = "\n.TP\n" + option.key.substr(dot + 1) + " = " + option.value + "\n";
      const auto at = text.find(key);
      REQUIRE(at != std::string::npos);
      const auto entry = text.substr(at + 1, text.find("\n.TP\n", at + 1) - at);
      CHECK((entry.find("Required.") != std::string::npos) == option.required);
      if (!option.fallback.empty()) CHECK_THAT(entry, ContainsSubstring(option.fallback));
    }
  };
  check("[[robot]]", robot_options());
  check("[http]", http_options());
}

TEST_CASE("text cannot become a request to the formatter", "[manual]") {
  const CommandText program{
      "x", "", "", {}, {{"run", ".so /etc/passwd \\n(xx `a-b` re-read --all-of", "", {}, {}}}};
  CHECK_THAT(
      commands_roff(program),
      ContainsSubstring("\\&.so /etc/passwd \\en(xx \\fBa\\-b\\fR re-read \\-\\-all\\-of.\n"));
}

TEST_CASE("a page takes each part where it says so, and has none left over", "[manual]") {
  CHECK(manual_page("a\n@X@\nb @Y@.", {{"X", "1\n"}, {"Y", "2"}}) == "a\n1\nb 2.");
  CHECK_THROWS_WITH(manual_page("@X@", {}), ContainsSubstring("X"));
  CHECK_THROWS_WITH(manual_page("", {{"X", ""}}), ContainsSubstring("@X@"));
}

TEST_CASE("the example of sweepd.toml(5) is valid", "[manual]") {
  const auto page = test::content(kSource / "daemon/commands/sweepd.toml.5.in");
  const auto begin = page.find(".RS 4\n", page.find(".SH EXAMPLE")) + 6;
  const test::TemporaryFolder folder;
  const auto settings = load_settings(
      folder.write("sweepd.toml", page.substr(begin, page.find(".RE", begin) - begin)));
  CHECK(settings.robots.size() == 2);
  CHECK(settings.robots.at(1).recording.keep.count() == 30);
}
