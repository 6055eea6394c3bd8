#include "tests/daemon/plan/krl_checker.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "tests/daemon/plan/krl_names.hpp"

namespace sweepd::test {
namespace {

using Words = std::vector<std::string>;

bool starts_word(char c) {
  return (c >= 'A' && c <= 'Z') || c == '_' || c == '$' || c == '#';
}
bool in_word(char c) {
  return starts_word(c) || (c >= '0' && c <= '9');
}
bool is_number(const std::string& word) {
  return !word.empty() && ((word[0] >= '0' && word[0] <= '9') || word[0] == '.');
}
bool is_name(const std::string& word) {
  return !word.empty() && starts_word(word[0]);
}

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

std::optional<double> krl_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

class Checker {
 public:
  explicit Checker(const std::vector<JointLimits>& limits) : limits_(limits) {}

  void read(std::string_view text, const char* file) {
    file_ = file;
    line_ = 0;
    statements_ = false;
    while (!text.empty()) {
      ++line_;
      const auto end = text.find('\n');
      std::string_view line = text.substr(0, end);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      if (!line.ends_with('\r') || end == std::string_view::npos)
        mistake("expected CR LF at the end of the line");
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (std::any_of(line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; }))
        mistake("expected printable ASCII");
      read_line(line);
    }
    for (const auto& [opening, at] : blocks_)
      mistake(opening + " of line " + std::to_string(at) + " has no " + kBlocks.at(opening));
    for (const int at : folds_) mistake("FOLD of line " + std::to_string(at) + " has no ENDFOLD");
    blocks_.clear();
    folds_.clear();
  }

  KrlReport finish() {
    for (const auto& [name, variable] : variables_)
      if (!variable.used) report_.mistakes.push_back(variable.place + name + " is never used");
    return std::move(report_);
  }

 private:
  struct Variable {
    std::string place;
    bool used = false;
    std::optional<double> value{};
    std::optional<std::array<std::optional<double>, 6>> axes{};
  };

  void mistake(const std::string& text) { report_.mistakes.push_back(place() + text); }
  [[nodiscard]] std::string place() const {
    return std::string(file_) + ":" + std::to_string(line_) + ": ";
  }

  void read_line(std::string_view line) {
    if (line.starts_with('&')) {
      if (!blocks_.empty()) mistake("a header line inside the program");
      return;
    }
    const Words words = split(line);
    if (!words.empty()) statement(words);
  }

  /// The words, numbers, strings and signs of a line; its comment is read for folds.
  Words split(std::string_view line) {
    Words words;
    for (std::size_t i = 0; i < line.size();) {
      const char c = capitals(line.substr(i, 1))[0];
      std::size_t end = i + 1;
      if (c == ';') {
        fold(capitals(line.substr(i + 1)));
        break;
      }
      if (c == '"') {
        end = line.find('"', i + 1);
        if (end == std::string_view::npos) {
          mistake("a string does not end");
          break;
        }
        words.emplace_back(line.substr(i, ++end - i));
      } else if (c != ' ') {
        const bool digits = c >= '0' && c <= '9';
        if (starts_word(c) || digits)
          while (end < line.size() &&
                 (in_word(capitals(line.substr(end, 1))[0]) || (digits && line[end] == '.')))
            ++end;
        words.push_back(capitals(line.substr(i, end - i)));
      }
      i = end;
    }
    return words;
  }

  void fold(const std::string& comment) {
    const auto word = comment.substr(std::min(comment.find_first_not_of(' '), comment.size()));
    if (word.starts_with("FOLD")) folds_.push_back(line_);
    if (!word.starts_with("ENDFOLD")) return;
    if (folds_.empty())
      mistake("ENDFOLD without FOLD");
    else
      folds_.pop_back();
  }

  void statement(const Words& words) {
    const std::string& first = words[0];
    if (std::count(words.begin(), words.end(), "(") != std::count(words.begin(), words.end(), ")"))
      mistake("parentheses do not match");
    if (first == "DEF" || first == "DEFDAT" || first == "DEFFCT") return define(words);
    if (blocks_.empty()) return mistake("a statement outside DEF and END");
    if (first == "EXT") return;
    const std::size_t type = first == "DECL" ? 1 : 0;
    if (words.size() > type + 1 && kTypes.contains(words[type])) return declare(words, type + 1);
    block(words);
    statements_ = true;
    use(words);
    // What an IF guards is not what the program does when all is well.
    const bool in_if = std::any_of(blocks_.begin(), blocks_.end(),
                                   [](const auto& block) { return block.first == "IF"; });
    if (!in_if) perform(words);
  }

  void define(const Words& words) {
    blocks_.emplace_back(words[0], line_);
    if (words.size() < 2) return mistake(words[0] + " without a name");
    if (words[1].size() > 24) mistake("a name of more than 24 characters");
    if (report_.name.empty())
      report_.name = words[1];
    else if (report_.name != words[1])
      mistake("expected the name " + report_.name + ", found " + words[1]);
  }

  void declare(const Words& words, std::size_t at) {
    if (statements_) mistake("a declaration after the first statement");
    while (at < words.size()) {
      const std::string& name = words[at];
      if (!is_name(name)) return mistake("expected a name to declare, found " + name);
      if (name.size() > 24) mistake("a name of more than 24 characters");
      if (variables_.contains(name) || kKnown.contains(name) || kKeywords.contains(name))
        mistake(name + " is declared already");
      Variable variable{place()};
      ++at;
      if (at < words.size() && words[at] == "[")  // CHAR name[20]
        while (at < words.size() && words[at++] != "]") {
        }
      if (at + 1 < words.size() && words[at] == "=") {
        const Words value(words.begin() + static_cast<std::ptrdiff_t>(at) + 1, words.end());
        variable.value = scalar(value);
        variable.axes = aggregate(value);
        if (!variable.value && !variable.axes) mistake("no value that can be read: " + name);
        at = words.size();
      } else if (at < words.size() && words[at++] != ",") {
        mistake("expected , between declarations");
      }
      variables_.emplace(name, variable);
    }
  }

  void block(const Words& words) {
    const std::string& first = words[0];
    if (kBlocks.contains(first)) {
      if ((first == "IF") != (words.back() == "THEN")) mistake("IF and THEN belong in one line");
      blocks_.emplace_back(first, line_);
      return;
    }
    if (first == "ELSE" && blocks_.back().first != "IF") mistake("ELSE without IF");
    const bool closes = std::any_of(kBlocks.begin(), kBlocks.end(),
                                    [&](const auto& pair) { return pair.second == first; });
    if (!closes) return;
    if (kBlocks.at(blocks_.back().first) != first)
      mistake("expected " + kBlocks.at(blocks_.back().first) + " for " + blocks_.back().first +
              " of line " + std::to_string(blocks_.back().second) + ", found " + first);
    blocks_.pop_back();
  }

  /// Each name has to be known.
  void use(const Words& words) {
    bool braces = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
      const std::string& word = words[i];
      if (word == "{" || word == "}") braces = word == "{";
      if (!is_name(word) || braces || (i > 0 && words[i - 1] == ".")) continue;
      if (kKeywords.contains(word) || kBlocks.contains(word) || kKnown.contains(word) ||
          word.starts_with("END"))
        continue;
      if (word[0] == '$' ? kSystem.contains(word) : word[0] == '#' && kConstants.contains(word))
        continue;
      const auto variable = variables_.find(word);
      if (variable == variables_.end())
        mistake(word + " is not declared");
      else
        variable->second.used = true;
    }
  }

  void perform(const Words& words) {
    if (words[0] == "PTP") return move({words.begin() + 1, words.end()});
    if (words[0] == "WAIT") {
      const auto seconds = words.size() > 2 && words[1] == "SEC"
                               ? scalar({words.begin() + 2, words.end()})
                               : std::nullopt;
      if (!seconds || *seconds < 0) return mistake("expected WAIT SEC with a time");
      KrlEvent event = next(KrlEvent::Kind::wait);
      event.seconds = *seconds;
      report_.events.push_back(event);
      return;
    }
    if (words.size() == 6 && words[0] == "$VEL_AXIS" && words[4] == "=") {
      const auto axis = krl_number(words[2]);
      const auto percent = krl_number(words[5]);
      if (!axis || !percent || *percent < 1 || *percent > 100)
        return mistake("expected a speed of 1 to 100 per cent");
      speeds_[static_cast<int>(*axis)] = static_cast<int>(*percent);
      return;
    }
    const auto open = std::find(words.begin(), words.end(), "(");
    if (open == words.end() || open == words.begin() || words[0] == "IF" || words[0] == "GLOBAL")
      return;
    KrlEvent event = next(KrlEvent::Kind::call);
    event.function = *(open - 1);
    for (auto word = open + 1; word != words.end() && *word != ")"; ++word) event.text += *word;
    report_.events.push_back(event);
  }

  void move(const Words& target) {
    KrlEvent event = next(KrlEvent::Kind::move);
    if (target.empty()) return mistake("PTP without a target");
    if (target.back().starts_with("C_")) mistake("approximation: the robot would not stop there");
    const auto variable = variables_.find(target[0]);
    if (const auto axes = aggregate(target))
      event.axes_deg = *axes;
    else if (variable != variables_.end() && variable->second.axes)
      event.axes_deg = *variable->second.axes;
    else if (target[0] != "$AXIS_ACT" && target[0] != "$POS_ACT")
      return mistake("expected axis angles for PTP, found " + target[0]);
    for (std::size_t i = 0; i < event.axes_deg.size() && i < limits_.size(); ++i)
      if (event.axes_deg[i] && !limits_[i].contain(*event.axes_deg[i]))
        mistake("A" + std::to_string(i + 1) + " beyond its limit");
    report_.events.push_back(event);
  }

  [[nodiscard]] KrlEvent next(KrlEvent::Kind kind) const {
    KrlEvent event;
    event.kind = kind;
    event.line = line_;
    event.speed_percent = speeds_;
    return event;
  }

  /// A number, or a variable that was declared with one.
  [[nodiscard]] std::optional<double> scalar(const Words& words) const {
    if (words.size() == 2 && words[0] == "-") {
      const auto value = krl_number(words[1]);
      return value ? std::optional(-*value) : std::nullopt;
    }
    if (words.size() != 1) return std::nullopt;
    if (is_number(words[0])) return krl_number(words[0]);
    const auto variable = variables_.find(words[0]);
    return variable == variables_.end() ? std::nullopt : variable->second.value;
  }

  /// {A1 0.0,A2 -90.0} or {AXIS: A1 ...}
  static std::optional<std::array<std::optional<double>, 6>> aggregate(const Words& words) {
    if (words.size() < 4 || words.front() != "{" || words.back() != "}") return std::nullopt;
    std::array<std::optional<double>, 6> axes{};
    std::size_t i = 1;
    if (words[2] == ":") i = 3;
    while (i + 1 < words.size()) {
      const std::string& name = words[i++];
      if (name.size() != 2 || name[0] != 'A' || name[1] < '1' || name[1] > '6') return std::nullopt;
      const double sign = words[i] == "-" ? -1 : 1;
      if (sign < 0) ++i;
      const auto value = i < words.size() ? krl_number(words[i]) : std::nullopt;
      if (!value) return std::nullopt;
      axes[static_cast<std::size_t>(name[1] - '1')] = sign * *value;
      if (words[++i] == ",") ++i;
    }
    return axes;
  }

  const std::vector<JointLimits>& limits_;
  KrlReport report_;
  const char* file_ = "";
  int line_ = 0;
  bool statements_ = false;
  std::vector<std::pair<std::string, int>> blocks_;
  std::vector<int> folds_;
  std::map<std::string, Variable> variables_;
  std::map<int, int> speeds_;
};

}  // namespace

KrlReport check_krl(std::string_view src, std::string_view dat,
                    const std::vector<JointLimits>& limits) {
  Checker checker(limits);
  if (!dat.empty()) checker.read(dat, "dat");
  checker.read(src, "src");
  return checker.finish();
}

}  // namespace sweepd::test
