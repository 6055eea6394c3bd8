#include <map>
#include <string_view>
#include <vector>

#include "daemon/commands/help_text.hpp"

namespace sweepd {

namespace {

/// `command` is the first word that is no option; `option` is the one that waits for its value, and
/// `last` the last one that was given. bash parts words at '='.
constexpr std::string_view kHead =
    R"(# bash completion for sweepd, written from the options that it reads.

_sweepd() {
  local word=${COMP_WORDS[COMP_CWORD]} before=$((COMP_CWORD - 1))
  local command='' option='' last='' words='' take='' i
  [[ $word == = ]] && word=
  [[ $word != = && ${COMP_WORDS[before]} == = ]] && before=$((before - 1))
  ((COMP_CWORD > 1)) && [[ ${COMP_WORDS[1]} != -* ]] && command=${COMP_WORDS[1]}
  [[ ${COMP_WORDS[before]} == -* ]] && option=${COMP_WORDS[before]}
  for ((i = 2; i < COMP_CWORD; i++)); do
    [[ ${COMP_WORDS[i]} == -* ]] && last=${COMP_WORDS[i]}
  done

)";

constexpr std::string_view kTail = R"(
  if [[ $take == words || $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  elif [[ $take == files ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  elif [[ $take == folders ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -d -- "$word")
  else
    COMPREPLY=()
  fi
}
complete -F _sweepd sweepd
)";

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : std::string(between)) + word;
  return text;
}

/// What stands in place of an option's value, as shell assignments.
std::string taken(const CommandOption& option) {
  const auto& what = option.positional() ? option.names.front() : option.value;
  if (!option.choices.empty()) return "take=words words='" + joined(option.choices, " ") + "'";
  if (what.find("DIR") != what.npos) return "take=folders";
  if (what.find("FILE") != what.npos || what.find("TRACE") != what.npos) return "take=files";
  return "take=nothing";
}

}  // namespace

std::string bash_completion(const CommandText& program) {
  std::vector<std::string> names;
  std::string commands;
  std::map<std::string, std::vector<std::string>> values;    // patterns by what they take
  std::map<std::string, std::vector<std::string>> repeated;  // and of options that take several
  for (const auto& command : program.commands) {
    names.push_back(command.name);
    std::vector<std::string> options;
    std::string operands;
    for (const auto& option : command.options) {
      if (option.positional()) operands = ' ' + taken(option);
      for (const auto& name : option.names) {
        if (name.starts_with("--")) options.push_back(name);
        if (option.positional() || option.value.empty()) continue;
        values[taken(option)].push_back("'" + command.name + ' ' + name + "'");
        if (option.repeated)
          repeated[taken(option)].push_back("'" + command.name + ' ' + name + "'");
      }
    }
    commands +=
        "    " + command.name + ") words='" + joined(options, " ") + "'" + operands + " ;;\n";
  }
  for (const auto& option : program.options)
    if (!option.positional()) names.push_back(option.names.front());

  const auto cases = [](const std::string& subject, const auto& kinds) {
    std::string text = "  case \"$command " + subject + "\" in\n";
    for (const auto& [assignments, patterns] : kinds)
      text += "    " + joined(patterns, " | ") + ") " + assignments + " ;;\n";
    return text + "  esac\n";
  };
  return std::string(kHead) + "  case $command in\n    '') words='" + joined(names, " ") +
         "' take=words ;;\n" + commands + "  esac\n" + cases("$last", repeated) +
         cases("$option", values) + std::string(kTail);
}

}  // namespace sweepd
