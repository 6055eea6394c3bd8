#include "daemon/krl/krl_data.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

namespace sweepd {
namespace {

constexpr std::string_view kKrlBlanks = " \t\r";

[[noreturn]] void fail(std::size_t line, const std::string& what) {
  throw KrlError("line " + std::to_string(line) + ": " + what);
}

std::string_view without_blanks(std::string_view text) {
  const auto from = text.find_first_not_of(kKrlBlanks);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kKrlBlanks) - from + 1);
}

/// Where the first of `any` is outside of quotes and of braces that open on the way.
std::size_t find_outside(std::string_view text, std::string_view any, std::size_t from = 0) {
  bool quoted = false;
  int depth = 0;
  for (std::size_t i = from; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (depth == 0 && any.find(text[i]) != std::string_view::npos) return i;
    if (text[i] == '{') ++depth;
    if (text[i] == '}') --depth;
  }
  return std::string_view::npos;
}

std::string_view first_word(std::string_view text) {
  return text.substr(0, text.find_first_of(kKrlBlanks));
}

/// `inside`: what is in the braces, which begins at `at` in the file.
void read_fields(std::string_view inside, std::size_t at, KrlAggregate& into) {
  if (const auto colon = find_outside(inside, ":"); colon != std::string_view::npos) {
    into.type = in_capitals(without_blanks(inside.substr(0, colon)));
    inside.remove_prefix(colon + 1);
    at += colon + 1;
  }
  while (!without_blanks(inside).empty()) {
    const auto comma = std::min(find_outside(inside, ","), inside.size());
    const std::string_view field = without_blanks(inside.substr(0, comma));
    const std::string_view name = first_word(field);
    const std::string_view value = without_blanks(field.substr(name.size()));
    if (!value.empty())
      into.fields.push_back(
          {in_capitals(name), value, at + static_cast<std::size_t>(value.data() - inside.data())});
    const auto taken = std::min(comma + 1, inside.size());
    inside.remove_prefix(taken);
    at += taken;
  }
}

/// A name without its index, which no blanks stand before.
std::string base_name(std::string_view name) {
  return in_capitals(without_blanks(name.substr(0, name.find('['))));
}

class KrlReader {
 public:
  explicit KrlReader(std::string_view text) : text_(text) {}

  std::vector<KrlAggregate> read() {
    if (text_.find('\0') != std::string_view::npos)
      throw KrlError("is no KRL text, or in UTF-16: save it as the controller writes it");
    bool open = false;
    for (std::size_t at = 0; at < text_.size();) {
      const auto end = std::min(text_.find('\n', at), text_.size());
      ++line_;
      const std::string_view line = text_.substr(at, end - at);
      const std::string word = in_capitals(first_word(without_blanks(line)));
      if (word == "DEFDAT") open = true;
      if (word == "ENDDAT") open = false;
      if (!word.starts_with('&')) read_line(line, at);
      at = end + 1;
    }
    if (open) fail(line_, "the file ends before ENDDAT: it was cut, copy it again");
    return std::move(found_);
  }

 private:
  void read_line(std::string_view line, std::size_t at) {
    line = line.substr(0, std::min(find_outside_quotes(line, ';'), line.size()));
    const auto equals = find_outside_quotes(line, '=');
    std::string_view left = without_blanks(line.substr(0, std::min(equals, line.size())));
    std::string type;
    for (std::string word = in_capitals(first_word(left));
         word == "DECL" || word == "GLOBAL" || word == "CONST" || word == "PUBLIC";
         word = in_capitals(first_word(left)))
      left = without_blanks(left.substr(word.size()));
    if (const auto word = first_word(left);
        word.size() < left.size() && without_blanks(left.substr(word.size())).front() != '[') {
      type = in_capitals(word);
      left = without_blanks(left.substr(word.size()));
    }
    if (!type.empty()) declare(left, type);
    if (equals == std::string_view::npos) return;
    const std::string_view right = without_blanks(line.substr(equals + 1));
    if (!right.starts_with('{')) return;
    KrlAggregate aggregate{type, in_capitals(left), line_, {}};
    std::erase_if(aggregate.name,
                  [](char c) { return kKrlBlanks.find(c) != std::string_view::npos; });
    const auto close = find_outside(right, "}", 1);
    if (close == std::string_view::npos)
      fail(line_, "the braces or quotes of " + aggregate.name +
                      " are not closed: the file was cut, or somebody edited the line");
    const std::string_view inside = right.substr(1, close - 1);
    read_fields(inside, at + static_cast<std::size_t>(inside.data() - line.data()), aggregate);
    if (const auto known = types_.find(base_name(left));
        aggregate.type.empty() && known != types_.end())
      aggregate.type = known->second;
    found_.push_back(std::move(aggregate));
  }

  static std::size_t find_outside_quotes(std::string_view line, char wanted) {
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '"') quoted = !quoted;
      if (!quoted && line[i] == wanted) return i;
    }
    return std::string_view::npos;
  }

  /// Arrays are declared in one line and get their values in others.
  void declare(std::string_view names, const std::string& type) {
    while (!names.empty()) {
      const auto comma = names.find(',');
      types_[base_name(names.substr(0, comma))] = type;
      names = comma == std::string_view::npos ? "" : names.substr(comma + 1);
    }
  }

  std::string_view text_;
  std::size_t line_ = 0;
  std::map<std::string, std::string> types_;
  std::vector<KrlAggregate> found_;
};

}  // namespace

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  for (char& c : capitals)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return capitals;
}

std::optional<double> KrlField::number() const {
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::optional<unsigned> KrlField::bits() const {
  std::string_view digits = text;
  int base = 10;
  if (digits.size() > 3 && digits.front() == '\'' && digits.back() == '\'') {
    const char kind = in_capitals(digits.substr(1, 1)).front();
    if (kind != 'B' && kind != 'H') return std::nullopt;
    base = kind == 'B' ? 2 : 16;
    digits = digits.substr(2, digits.size() - 3);
  }
  unsigned value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
  if (error != std::errc() || end != digits.data() + digits.size() || value > 0xFFFF)
    return std::nullopt;
  return value;
}

const KrlField* KrlAggregate::find(std::string_view field) const {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const KrlField& one) { return one.name == field; });
  return found != fields.end() ? &*found : nullptr;
}

std::vector<KrlAggregate> krl_aggregates(std::string_view text) {
  return KrlReader(text).read();
}

KrlAggregate krl_aggregate(std::string_view text) {
  text = without_blanks(text);
  if (text.starts_with('{') != text.ends_with('}') || text.size() == 1)
    throw KrlError("its braces are not closed: write { before it and } behind it");
  if (text.starts_with('{')) text = text.substr(1, text.size() - 2);
  KrlAggregate aggregate;
  aggregate.line = 1;
  read_fields(text, 0, aggregate);
  return aggregate;
}

}  // namespace sweepd
