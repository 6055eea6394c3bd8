#include "daemon/settings/toml_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <tuple>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <toml++/toml.h>

#include "daemon/settings/toml_nesting.hpp"
#include "daemon/text/nearest_word.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

/// More than any file of ours; keeps a mistaken path (a capture, /dev/zero) from filling memory.
constexpr std::size_t kMostFileBytes = 1 << 20;
/// Our files have a table in a table.
constexpr std::size_t kDeepest = 32;

struct Unit {
  std::string_view suffix;
  std::string_view words;
};
constexpr std::array kUnits{
    Unit{"_ms", "milliseconds"},
    Unit{"_mm", "millimetres"},
    Unit{"_deg", "degrees"},
    Unit{"_arcsec", "arcseconds"},
    Unit{"_deg_s", "degrees per second"},
    Unit{"_deg_s2", "degrees per second squared"},
    Unit{"_bytes", "bytes"},
};

std::string unit_of(std::string_view key) {
  for (const Unit& unit : kUnits)
    if (key.ends_with(unit.suffix)) return " of " + std::string(unit.words);
  return "";
}

/// Text from a file inside a message: in quotes, on one line, not too long.
std::string in_quotes(std::string_view text) {
  return '"' + rsi::in_short(text) + '"';
}

std::string in_words(const toml::node* node) {
  if (!node) return "nothing";
  if (const auto* text = node->as_string()) return "the string " + in_quotes(text->get());
  if (const auto* whole = node->as_integer()) return fmt::format("the number {}", whole->get());
  if (const auto* number = node->as_floating_point()) {
    const auto text = number_text(number->get());
    const bool whole = text.find_first_not_of("-0123456789") == std::string::npos;
    return "the number " + text + (whole ? ".0" : "");
  }
  if (const auto* flag = node->as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node->as_array())
    return "an array of " + rsi::counted(array->size(), "value");
  return node->is_table() ? "a table" : "a date or a time";
}

/// What to write in the place of a number with a decimal point.
std::string without_decimals(double value) {
  constexpr double kMost = 1e15;
  if (value != std::floor(value) || std::abs(value) > kMost) return "write it without decimals";
  return fmt::format("write {}, without a decimal point", static_cast<std::int64_t>(value));
}

std::string place(const std::string& file, const toml::source_position& where) {
  return fmt::format("{}:{}:{}: ", file, where.line, where.column);
}

std::string text_of(const std::vector<Mistake>& mistakes) {
  std::string text;
  for (const Mistake& mistake : mistakes) text += (text.empty() ? "" : "\n") + mistake.text;
  return text;
}

}  // namespace

ConfigError::ConfigError(const std::string& text) : ConfigError(std::vector{Mistake{text}}) {}

ConfigError::ConfigError(std::vector<Mistake> mistakes)
    : std::runtime_error(text_of(mistakes)),
      mistakes_(std::make_shared<const std::vector<Mistake>>(std::move(mistakes))) {}

void Mistakes::tell() const {
  if (all_.empty()) return;
  std::vector<Mistake> ordered = all_;
  std::stable_sort(ordered.begin(), ordered.end(), [](const Mistake& a, const Mistake& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  throw ConfigError(std::move(ordered));
}

struct TomlTable::Node {
  std::shared_ptr<const toml::table> root;  ///< owns everything
  const toml::table* table;
  std::string file;
  std::string prefix;  ///< of its keys in errors: "robot."

  [[nodiscard]] const toml::node& get(std::string_view key, const std::string& expected,
                                      const std::string& remedy = "add it to this table") const {
    if (const toml::node* node = table->get(key)) return *node;
    fail(key, *table, "missing: expected " + expected + ": " + remedy);
  }

  /// The table that `value` is, which stands under `key` of this one.
  [[nodiscard]] std::shared_ptr<const Node> child(std::string_view key,
                                                  const toml::node& value) const {
    return std::make_shared<const Node>(
        Node{root, value.as_table(), file, prefix + rsi::in_short(key) + '.'});
  }

  [[noreturn]] void fail(std::string_view key, const toml::source_position& where,
                         const std::string& problem) const {
    throw ConfigError({Mistake{
        sweepd::place(file, where) + prefix + rsi::in_short(key) + ": " + rsi::printable(problem),
        where.line, where.column}});
  }

  [[noreturn]] void fail(std::string_view key, const toml::node& node,
                         const std::string& problem) const {
    fail(key, node.source().begin, problem);
  }

  [[noreturn]] void wrong_type(std::string_view key, const toml::node& node,
                               const std::string& expected) const {
    std::string remedy = "correct it";
    const std::string* text = node.is_string() ? &node.as_string()->get() : nullptr;
    if (text != nullptr && expected.find("number") != std::string::npos)
      remedy = text->find_first_of("0123456789") == 0 && text->find(' ') != std::string::npos
                   ? "write the number alone, without unit and quotes"
                   : "write it without quotes";
    else if (node.is_floating_point() && expected.find("whole") != std::string::npos)
      remedy = without_decimals(node.as_floating_point()->get());
    else if (node.is_number() && expected.find("string") != std::string::npos)
      remedy = "put it in quotes";
    fail(key, node, "expected " + expected + ", found " + in_words(&node) + ": " + remedy);
  }

  [[nodiscard]] double number(std::string_view key, const toml::node& node, double least,
                              double most) const {
    const std::string expected = "a number" + unit_of(key);
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value)) wrong_type(key, node, expected);
    if (*value < least || *value > most)
      fail(key, node,
           "expected " + expected + " from " + number_text(least) + " to " + number_text(most) +
               ", found " + in_words(&node) + ": choose one in between");
    return *value;
  }

  [[nodiscard]] const toml::array& array(std::string_view key, const std::string& expected) const {
    const toml::node& node = get(key, expected);
    if (!node.is_array()) wrong_type(key, node, expected);
    return *node.as_array();
  }
};

TomlTable::TomlTable(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

TomlTable TomlTable::load(const std::filesystem::path& file) {
  const auto text = rsi::file_bytes<ConfigError>(file, kMostFileBytes);
  if (text.size() > kMostFileBytes)
    throw ConfigError(file.string() +
                      ": expected a TOML file of at most 1 MiB, found more: " + "check the path");
  return parse(text, file);
}

TomlTable TomlTable::parse(std::string_view text, const std::filesystem::path& file) {
  const std::string name = file.string();
  if (const auto where = too_deep(text, kDeepest))
    throw ConfigError(
        fmt::format("{}:{}:{}: keys, tables or arrays are nested more than {} deep: correct the "
                    "file",
                    name, where->line, where->column, kDeepest));
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(text, name));
    const toml::table* top = root.get();
    return TomlTable(std::make_shared<const Node>(Node{std::move(root), top, name, ""}));
  } catch (const toml::parse_error& error) {
    const bool twice =
        error.description().find("redefine existing table") != std::string_view::npos;
    throw ConfigError(sweepd::place(name, error.source().begin) +
                      "not valid TOML: " + rsi::printable(error.description()) + ": " +
                      (twice ? "write double brackets, [[...]], where there are several of them"
                             : "correct the syntax"));
  }
}

void TomlTable::allow_only(const std::vector<std::string_view>& keys) const {
  Mistakes mistakes;
  check_keys(keys, {}, mistakes);
  mistakes.tell();
}

std::vector<std::string_view> TomlTable::check_keys(const std::vector<std::string_view>& keys,
                                                    const std::vector<KeyElsewhere>& elsewhere,
                                                    Mistakes& mistakes) const {
  std::vector<const toml::key*> unknown;
  for (const auto& [key, value] : *node_->table)
    if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) unknown.push_back(&key);
  // The table is sorted by name; a reader goes from top to bottom.
  std::sort(unknown.begin(), unknown.end(), [](const toml::key* a, const toml::key* b) {
    return a->source().begin < b->source().begin;
  });
  std::vector<std::string_view> others;
  others.reserve(elsewhere.size());
  for (const KeyElsewhere& other : elsewhere) others.push_back(other.key);
  std::vector<std::string_view> meant;
  for (const toml::key* key : unknown) {
    const auto near = nearest_word(key->str(), keys);
    auto other = std::find(others.begin(), others.end(), key->str());
    if (near.empty() && other == others.end())
      other = std::find(others.begin(), others.end(), nearest_word(key->str(), others));
    std::string problem = "unknown key: ";
    if (other != others.end()) {
      problem +=
          "did you mean " + elsewhere[static_cast<std::size_t>(other - others.begin())].words;
      problem += '?';
    } else if (!near.empty()) {
      problem += "did you mean " + in_quotes(near) + "?";
      meant.push_back(near);
    } else {
      problem += "this table may have";
      for (const auto known : keys)
        problem += (known == keys.front() ? " " : ", ") + std::string(known);
    }
    mistakes.of([&] { node_->fail(key->str(), key->source().begin, problem); });
  }
  return meant;
}

bool TomlTable::has(std::string_view key) const {
  return node_->table->contains(key);
}

std::string TomlTable::text(std::string_view key) const {
  const toml::node& node = node_->get(key, "a string");
  const auto* text = node.as_string();
  if (!text) node_->wrong_type(key, node, "a string");
  if (text->get().empty())
    node_->fail(key, node, "expected a string, found an empty one: fill it in");
  return text->get();
}

bool TomlTable::flag(std::string_view key) const {
  const toml::node& node = node_->get(key, "true or false");
  const auto* flag = node.as_boolean();
  if (!flag) node_->wrong_type(key, node, "true or false");
  return flag->get();
}

double TomlTable::number(std::string_view key, double least, double most) const {
  return node_->number(key, node_->get(key, "a number" + unit_of(key)), least, most);
}

std::int64_t TomlTable::whole_number(std::string_view key, std::int64_t least,
                                     std::int64_t most) const {
  const std::string expected = "a whole number" + unit_of(key);
  const toml::node& node = node_->get(key, expected);
  const auto* value = node.as_integer();
  if (!value) node_->wrong_type(key, node, expected);
  if (value->get() < least || value->get() > most)
    node_->fail(key, node,
                fmt::format("expected {} from {} to {}, found {}: choose one in between", expected,
                            least, most, in_words(&node)));
  return value->get();
}

std::vector<double> TomlTable::numbers(std::string_view key, double least, double most) const {
  std::vector<double> values;
  for (const toml::node& node : node_->array(key, "an array of numbers" + unit_of(key)))
    values.push_back(node_->number(key, node, least, most));
  return values;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
  std::vector<std::string> values;
  for (const toml::node& node : node_->array(key, "an array of strings")) {
    const auto* text = node.as_string();
    if (!text) node_->wrong_type(key, node, "a string");
    values.push_back(text->get());
  }
  return values;
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  const std::string header = "[[" + std::string(key) + "]]";
  const std::string expected = "at least one table " + header;
  const toml::node& node = node_->get(key, expected, "add one for each " + std::string(key));
  if (node.is_table())
    node_->fail(key, node,
                "expected " + header + ", found a single table: double the square brackets");
  std::vector<TomlTable> tables;
  for (const toml::node& element : node_->array(key, expected)) {
    if (!element.is_table()) node_->wrong_type(key, element, "a table " + header);
    tables.push_back(TomlTable(node_->child(key, element)));
  }
  if (tables.empty()) node_->wrong_type(key, node, expected);
  return tables;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const toml::node* node = node_->table->get(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) node_->wrong_type(key, *node, "a table [" + std::string(key) + "]");
  return TomlTable(node_->child(key, *node));
}

int TomlTable::line() const {
  return static_cast<int>(node_->table->source().begin.line);
}

std::string TomlTable::found(std::string_view key) const {
  return in_words(node_->table->get(key));
}

std::string TomlTable::place(std::string_view key) const {
  const toml::node* value = node_->table->get(key);
  return sweepd::place(node_->file, (value ? *value : *node_->table).source().begin) +
         node_->prefix;
}

void TomlTable::fail(std::string_view key, const std::string& problem) const {
  const toml::node* value = node_->table->get(key);
  node_->fail(key, value ? *value : *node_->table, problem);
}

std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

}  // namespace sweepd
