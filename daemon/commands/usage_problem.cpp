#include <algorithm>
#include <regex>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_line.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/text/nearest_word.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

std::string needs_value(const CLI::App& command, const std::string& name) {
  std::string value = "one";
  for (const auto& option : command_text(command).options)
    for (const auto& own : option.names)
      if (own == name) value = option.value + (option.range.empty() ? "" : ", " + option.range);
  const bool several = value.find(',') < value.find(", ");
  return name + (several ? " needs all of its values" : " needs a value") + ": give " + value;
}

/// Where the rest is told.
std::string help_of(const CLI::App& command) {
  return ": `sweepd " + command.get_name() + " --help` tells how it is used";
}

std::string not_expected(const CLI::App& command, const std::string& word) {
  if (!word.starts_with('-'))
    return rsi::in_short(word) + " is one argument too many" + help_of(command);
  std::vector<std::string> names;
  for (const auto& option : command_text(command).options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  const std::vector<std::string_view> known(names.begin(), names.end());
  const auto meant = nearest_word(word, known);
  return rsi::in_short(word) + " is no option" +
         (meant.empty() ? help_of(command) : ": did you mean " + std::string(meant) + "?");
}

}  // namespace

std::string no_command(const CLI::App& app, const std::string& word) {
  const std::string help = ": `sweepd --help` tells how it is used";
  if (word.empty()) return "name a command" + help;
  if (word.starts_with('-')) return rsi::in_short(word) + " is no option" + help;
  const auto commands = app.get_subcommands({});
  std::vector<std::string_view> known;
  known.reserve(commands.size());
  for (const auto* command : commands) known.push_back(command->get_name());
  const auto meant = nearest_word(word, known);
  return rsi::in_short(word) + " is no command" +
         (meant.empty() ? help : ": did you mean " + std::string(meant) + "?");
}

std::string usage_problem(const CLI::App& command, const CLI::ParseError& problem) {
  static const std::regex kTooOften("(.*): At Most 1 required but received (\\d+)");
  static const std::regex kNoValue("(.*): \\d+ required .* missing");
  static const std::regex kNoneOf("(.*): ([^]*) not in \\{(.*)\\}");
  static const std::regex kOneOf("Exactly 1 option from \\[(.*)\\] is required(.*)");
  const std::string said = problem.what();
  constexpr std::size_t kLongest = 1000;  // std::regex takes stack for each character
  if (said.size() > kLongest) return rsi::printable(said.substr(0, kLongest)) + "...";
  // An option whose name is wrong is also one that is missing.
  const auto extra = command.remaining();
  const auto wrong =
      std::ranges::find_if(extra, [](const std::string& word) { return word.starts_with('-'); });
  if (wrong != extra.end()) return not_expected(command, *wrong);
  std::smatch part;
  const auto is = [&](const std::regex& what) { return std::regex_match(said, part, what); };
  const auto listed = [](const std::string& names, const char* between) {
    return std::regex_replace(names, std::regex(","), between);
  };
  if (is(kTooOften))
    return part.str(1) + " is given " + (part.str(2) == "2" ? "twice" : part.str(2) + " times") +
           ": give it once";
  if (is(kNoValue)) return needs_value(command, part.str(1));
  if (is(kNoneOf))
    return part.str(1) + " takes " + listed(part.str(3), ", ") + ": found " +
           rsi::in_short(part.str(2)) + help_of(command);
  if (is(kOneOf))
    return "give " + listed(part.str(1), " or ") + (part.str(2).empty() ? "" : ", and only one") +
           help_of(command);
  if (dynamic_cast<const CLI::ExtrasError*>(&problem) != nullptr)
    return not_expected(command, command.remaining().front());
  return said + help_of(command);
}

}  // namespace sweepd
