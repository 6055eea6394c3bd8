#include "daemon/commands/command_text.hpp"

#include <CLI/CLI.hpp>

#include "daemon/commands/command_line.hpp"
#include "tests/catch.hpp"

using namespace sweepd;

namespace {

CommandOption option_of(const std::string& command, const std::string& name) {
  for (const auto& text : command_text(CommandLine().app()).commands)
    for (const auto& option : text.options)
      if (text.name == command && option.names.front() == name) return option;
  FAIL(command << " has no " << name);
  return {};
}

}  // namespace

TEST_CASE("what an option takes is told in words, whichever checks are made of it",
          "[command_text]") {
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

TEST_CASE("an option without a group is hidden", "[command_text]") {
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
