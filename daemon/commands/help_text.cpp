#include "daemon/commands/help_text.hpp"

#include <cctype>
#include <functional>
#include <sstream>

#include <CLI/CLI.hpp>

#include "daemon/settings/settings.hpp"
#include "daemon/text/text_layout.hpp"

namespace sweepd {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

/// CLI11 tells in one text what is taken, and what of that: "FILE", "UINT:UINT in [1 - 12]",
/// "FLOAT:(0 or more)", "device|robot:{device,robot}".
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
  } else if (const auto words = type.find(":("); words != type.npos) {
    option.value = type.substr(0, words);
    option.range = type.substr(words + 2, type.size() - words - 3);
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

namespace {

/// Where explanations begin. help2man takes those on a line of their own from column 20 on.
constexpr std::size_t kExplained = 26;

std::string entry(const std::string& name, const std::string& text) {
  const auto label = left("  " + name, kExplained);
  // Two blanks at least part them.
  if (label[kExplained - 2] == ' ' && label[kExplained - 1] == ' ') return paragraph(label, text);
  return "  " + name + '\n' + paragraph(std::string(kExplained, ' '), text);
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const auto& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string option_entry(const CommandOption& option) {
  // -h, --help: the short one is first.
  const std::vector<std::string> names(option.names.rbegin(), option.names.rend());
  std::vector<std::string> notes;
  if (option.required && !option.positional()) notes.emplace_back("required");
  if (!option.needs.empty()) notes.push_back("together with " + joined(option.needs));
  if (!option.range.empty()) notes.push_back(option.range);
  if (!option.fallback.empty()) notes.push_back("default: " + option.fallback);
  return entry(joined(names) + (option.value.empty() ? "" : ' ' + option.value) +
                   (option.repeated ? "..." : ""),
               option.help + (notes.empty() ? "" : " (" + joined(notes) + ')'));
}

/// The entries of those options that `belong`, below a heading.
std::string section(const std::string& heading, const CommandText& command,
                    const std::function<bool(const CommandOption&)>& belong) {
  std::string text;
  for (const auto& option : command.options)
    if (belong(option)) text += option_entry(option);
  return text.empty() ? text : '\n' + heading + ":\n" + text;
}

std::string usage(const CommandText& command, const std::string& called) {
  std::string text = "Usage: " + called;
  if (!command.commands.empty()) text += " COMMAND";
  text += " [OPTION]...";
  for (const auto& option : command.options)
    if (option.positional())
      text += (option.required ? ' ' + option.names.front() : " [" + option.names.front() + ']') +
              (option.repeated ? "..." : "");
  return text + '\n';
}

std::string settings_section(const std::string& table, const std::vector<OptionText>& options) {
  std::string text;
  std::string last = "none";
  for (const auto& option : options) {
    const auto dot = option.key.find('.');
    const auto within = dot == option.key.npos ? "" : option.key.substr(0, dot);
    const std::string inner = within == "device" ? "[[robot.device]]" : "[robot." + within + ']';
    if (within != last) text += '\n' + (within.empty() ? table : inner) + ":\n";
    last = within;
    auto help = option.help;
    help.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(help.front())));
    help += help.back() == '.' ? "" : ".";
    if (option.required) help += " Required.";
    if (!option.fallback.empty()) help += " Default: " + option.fallback;
    text += "  " + (dot == option.key.npos ? option.key : option.key.substr(dot + 1)) + " = " +
            option.value + '\n' + paragraph(std::string(kExplained, ' '), help);
  }
  return text;
}

}  // namespace

std::string help_text(const CommandText& command, const std::string& called) {
  std::string text = usage(command, called) + '\n' + paragraph("", command.help + '.');
  for (const auto& details : command.details) text += '\n' + paragraph("", details);
  if (!command.commands.empty()) text += "\nCommands:\n";
  for (const auto& inner : command.commands) text += entry(inner.name, inner.help);
  text += section("Arguments", command, [](const auto& option) { return option.positional(); });
  text += section("Options", command, [](const auto& option) {
    return !option.positional() && option.alternative == 0;
  });
  text += section("One of these options has to be given", command,
                  [](const auto& option) { return option.alternative != 0; });
  return text + (command.footer.empty() ? "" : '\n' + command.footer);
}

std::string exit_status(const std::vector<ExitCode>& codes) {
  std::string text = "Exit status:\n";
  for (const auto& [code, meaning] : codes)
    text += paragraph(left("  " + std::to_string(code), 6), meaning);
  return text;
}

std::string settings_text() {
  return "Every key, by its table.\n" + settings_section("[[robot]]", robot_options()) +
         settings_section("[http]", http_options()) +
         settings_section("[publish]", publish_options()) +
         settings_section("[collect]", collect_options());
}

}  // namespace sweepd
