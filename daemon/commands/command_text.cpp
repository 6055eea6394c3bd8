#include "daemon/commands/command_text.hpp"

#include <sstream>

#include <CLI/CLI.hpp>

namespace sweepd {

namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

/// CLI11 tells in one text what is taken, and what of that: "FILE", "UINT:UINT in [1 - 12]",
/// "FLOAT:NONNEGATIVE", "device|robot:{device,robot}".
void describe_value(const std::string& type, CommandOption& option) {
  option.value = type;
  if (const auto set = type.find(":{"); set != type.npos) {
    option.value = type.substr(0, set);
    option.choices = split(type.substr(set + 2, type.size() - set - 3), ',');
  } else if (const auto range = type.find(" in ["); range != type.npos) {
    option.value = type.substr(0, type.rfind(':', range));
    const auto limits = type.substr(range + 5, type.size() - range - 6);
    const auto dash = limits.find(" - ");
    option.range = limits.substr(0, dash) + " to " + limits.substr(dash + 3);
  } else if (const auto least = type.find(":NONNEGATIVE"); least != type.npos) {
    option.value = type.substr(0, least);
    option.range = "0 or more";
  }
  if (option.value == "UINT" || option.value == "INT") option.value = "N";
  if (option.value == "FLOAT") option.value = "NUMBER";
}

CommandOption option_text(const CLI::Option& option) {
  CommandOption text;
  for (const auto& name : option.get_lnames()) text.names.push_back("--" + name);
  for (const auto& name : option.get_snames()) text.names.push_back("-" + name);
  if (text.names.empty()) text.names.push_back(option.get_name(true));
  if (option.get_items_expected_max() > 0 && !text.positional())
    describe_value(option.get_type_name(), text);
  text.fallback = option.get_default_str();
  text.required = option.get_required();
  text.repeated = option.get_expected_max() > 1;
  for (const auto* needed : option.get_needs()) text.needs.push_back(needed->get_name());
  text.help = option.get_description();
  return text;
}

}  // namespace

CommandText command_text(const CLI::App& app) {
  CommandText text{app.get_name(),   "", split(app.get_description(), '\n'),
                   app.get_footer(), {}, {}};
  if (!text.details.empty()) {
    text.help = text.details.front();
    text.details.erase(text.details.begin());
  }
  for (const auto* option : app.get_options())
    if (!option->get_group().empty()) text.options.push_back(option_text(*option));
  int alternative = 0;
  for (const auto* part : app.get_subcommands({})) {
    if (!part->get_name().empty()) {
      text.commands.push_back(command_text(*part));
      continue;
    }
    // An option group is a command without a name.
    const bool one_of = part->get_require_option_min() == 1 && part->get_require_option_max() == 1;
    if (one_of) ++alternative;
    for (const auto* option : part->get_options()) {
      if (option == part->get_help_ptr()) continue;
      text.options.push_back(option_text(*option));
      if (one_of) text.options.back().alternative = alternative;
    }
  }
  return text;
}

}  // namespace sweepd
