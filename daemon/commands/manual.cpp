#include "daemon/commands/manual.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>

#include "daemon/text/ascii.hpp"

namespace sweepd {

namespace {

/// Text as roff. What stands in backticks becomes bold. The dash of an option or a file's name is
/// one that a reader can copy; in a word as "re-read" it is a hyphen.
std::string roff(std::string_view text) {
  std::string out;
  bool bold = false;
  bool dashed = false;  // within a word like --write-plan
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ' ') dashed = false;
    if (c == '`')
      out += (bold = !bold) ? "\\fB" : "\\fR";
    else if (c == '\\')
      out += "\\e";
    else if (c == '-' && !bold && !dashed && i > 0 && i + 1 < text.size() &&
             is_letter(text[i - 1]) && is_letter(text[i + 1]))
      out += '-';
    else if (c == '-') {
      out += "\\-";
      dashed = true;
    } else if ((c == '.' || c == '\'') && (i == 0 || text[i - 1] == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

/// Capitals stand for something, all else is meant as it is: `FILE`, `device|robot`.
std::string value_roff(const std::string& value) {
  std::string out;
  bool capitals = false;
  for (const char c : value) {
    const bool capital = std::isupper(static_cast<unsigned char>(c)) != 0;
    if (capital != capitals) out += capital ? "\\fI" : "\\fR";
    capitals = capital;
    out += c == '-' ? "\\-" : std::string(1, c);
  }
  return capitals ? out + "\\fR" : out;
}

std::string sentence(std::string text) {
  if (text.empty()) return text;
  text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  if (text.back() != '.') text += '.';
  return roff(text);
}

/// An option as it is typed: --output DIR.
std::string typed(const CommandOption& option) {
  if (option.positional())
    return value_roff(option.names.front()) + (option.repeated ? " ..." : "");
  return bold(option.names.front()) + (option.value.empty() ? "" : " " + value_roff(option.value)) +
         (option.repeated ? " ..." : "");
}

std::string entry(const CommandOption& option) {
  std::string out = ".TP\n";
  for (std::size_t i = 1; i < option.names.size(); ++i) out += bold(option.names[i]) + ", ";
  out += typed(option) + '\n' + sentence(option.help) + '\n';
  for (const auto& needed : option.needs) out += "Together with " + bold(needed) + ".\n";
  if (!option.range.empty()) out += sentence(option.range) + '\n';
  if (!option.fallback.empty()) out += "Default: " + roff(option.fallback) + ".\n";
  return out;
}

bool is_help(const CommandOption& option) {
  return option.names.front() == "--help";
}

/// What has to be typed in full, what stands for the other options in one word.
std::string synopsis(const std::string& program, const CommandText& command) {
  std::string required;
  std::string positionals;
  bool more = false;
  int alternative = 0;
  for (const auto& option : command.options) {
    if (is_help(option)) continue;
    if (option.positional())
      positionals += option.required ? ' ' + typed(option) : " [" + typed(option) + ']';
    else if (option.alternative != 0) {
      required += option.alternative == alternative ? " | " : " {";
      required += typed(option);
      alternative = option.alternative;
    } else if (option.required)
      required += ' ' + typed(option);
    else
      more = true;
  }
  if (alternative != 0) required += '}';
  return bold(program + ' ' + command.name) + required + (more ? " [\\fIOPTION\\fR ...]" : "") +
         positionals;
}

/// Lines of --help: an empty one parts paragraphs, what is indented stays a line of its own.
std::string paragraphs(const std::string& lines) {
  std::string out = ".PP\n";
  std::istringstream stream(lines);
  bool indented = false;
  for (std::string line; std::getline(stream, line);) {
    const bool indent = line.starts_with("  ");
    if (indent != indented) out += indent ? ".RS 4\n" : ".RE\n";
    indented = indent;
    if (line.empty())
      out += ".PP\n";
    else
      out += roff(indent ? line.substr(2) : line) + '\n';
  }
  return indented ? out + ".RE\n" : out;
}

}  // namespace

std::string options_roff(const CommandText& program) {
  std::string out;
  for (const auto& option : program.options) out += entry(option);
  return out;
}

std::string commands_roff(const CommandText& program) {
  std::string out;
  for (const auto& command : program.commands) {
    out += ".SS " + roff(command.name) + "\n" + synopsis(program.name, command) + "\n.PP\n" +
           sentence(command.help) + '\n';
    for (const auto& option : command.options)
      if (!is_help(option)) out += entry(option);
    if (!command.footer.empty()) out += paragraphs(command.footer);
  }
  return out;
}

std::string settings_roff(std::string_view table, const std::vector<OptionText>& options) {
  const auto name = table.substr(0, table.find_last_not_of(']') + 1);
  const std::string inner(name.substr(name.find_first_not_of('[')));
  std::string out;
  std::string section = "none";
  for (const auto& option : options) {
    const auto dot = option.key.find('.');
    const auto key = dot == option.key.npos ? option.key : option.key.substr(dot + 1);
    const auto within = dot == option.key.npos ? "" : option.key.substr(0, dot);
    if (within != section)
      out += ".SS " + roff(within.empty() ? std::string(table) : '[' + inner + '.' + within + ']') +
             '\n';
    section = within;
    out += ".TP\n" + bold(key) + " = \\fI" + roff(option.value) + "\\fR\n" + sentence(option.help);
    if (option.required) out += "\nRequired.";
    if (!option.fallback.empty()) out += "\nDefault: " + roff(option.fallback);
    out += '\n';
  }
  return out;
}

std::string manual_page(const std::string& page, const std::map<std::string, std::string>& parts) {
  std::string out;
  std::set<std::string> used;
  std::size_t at = 0;
  for (std::size_t begin; (begin = page.find('@', at)) != page.npos;) {
    const auto end = page.find('@', begin + 1);
    const auto name = page.substr(begin + 1, end - begin - 1);
    const auto part = parts.find(name);
    if (end == page.npos || part == parts.end())
      throw std::runtime_error("a manual page has a place @" + name +
                               "@, for which there is nothing: name it otherwise");
    used.insert(name);
    out.append(page, at, begin - at).append(part->second);
    at = end + 1;
    if (part->second.ends_with('\n') && page[at] == '\n') ++at;
  }
  for (const auto& [name, part] : parts)
    if (!used.contains(name))
      throw std::runtime_error("a manual page has no place for " + name + ": give it @" + name +
                               '@');
  return out.append(page, at);
}

}  // namespace sweepd
