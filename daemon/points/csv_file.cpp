#include "daemon/points/csv_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_text.hpp"
#include "daemon/text/units.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

/// What stands in quotes separates nothing.
char separator_of(std::string_view line) {
  std::string outside;
  bool inside = false;
  for (const char c : line) {
    if (c == '"') inside = !inside;
    if (!inside) outside += c;
  }
  for (const char separator : {',', ';', '\t'})
    if (outside.find(separator) != std::string::npos) return separator;
  return ' ';
}

std::size_t decimals_in(std::string_view field) {
  const auto point = field.find('.');
  return point == std::string_view::npos ? 0 : field.size() - point - 1;
}

}  // namespace

CsvFile::CsvFile(const std::filesystem::path& path, std::vector<std::string> columns)
    : CsvFile(path, rsi::file_bytes<CsvError>(path), std::move(columns)) {}

CsvFile::CsvFile(std::filesystem::path path, std::string content, std::vector<std::string> columns)
    : path_(std::move(path)),
      declared_(!columns.empty()),
      columns_(std::move(columns)),
      content_(as_utf8(path_, std::move(content))) {
  waiting_ = next_line();
  if (!waiting_)
    throw CsvError(path_.string() + ": expected lines of numbers, found none: give another file");
  header_line_ = line_;
  if (!declared_) {
    if (std::all_of(fields_.begin(), fields_.end(), [](auto field) { return rsi::number(field); }))
      throw CsvError(place() +
                     ": expected a header that names the columns, found numbers alone: name the "
                     "columns with --columns");
    columns_.assign(fields_.begin(), fields_.end());
    waiting_ = false;
  }
  for (auto& name : columns_) name = name == "-" || name == "_" ? "" : lower(name);
  if (declared_ && !any_number()) waiting_ = false;
}

bool CsvFile::next() {
  if (!std::exchange(waiting_, false) && !next_line()) return false;
  if (fields_.size() == columns_.size()) {
    check_end();
    return true;
  }
  throw CsvError(fmt::format(
      "{}: expected {}, as {}, found {}: {}", place(), rsi::counted(columns_.size(), "column"),
      declared_ ? "named with --columns" : fmt::format("in line {}", header_line_), fields_.size(),
      declared_ ? "name all of them, - for one to skip" : "correct the line"));
}

/// Many programs leave off the last end of a line. A file that was copied while it was written may
/// lack it too, and then end within a number, which is another number.
void CsvFile::check_end() {
  const std::string_view field = fields_.back();
  const std::size_t decimals = decimals_in(field);
  const std::size_t digits = field.size() - (field.starts_with('-') ? 1 : 0);
  // Behind a quote, a blank or an end of line a field is whole.
  const bool is_open = !field.empty() && !columns_.back().empty() &&
                       field.data() + field.size() == content_.data() + content_.size();
  const LastColumn before = last_.value_or(LastColumn{{}, decimals, digits});
  const bool is_as_long = last_ && !field.ends_with('.') &&
                          (decimals == 0 && before.decimals == 0 ? digits >= before.digits
                                                                 : decimals >= before.decimals);
  if (is_open && !is_as_long && !(last_ && field == before.newest))
    fail(columns_.size() - 1,
         fmt::format("expected {}the end of the line, found {} and the end of the file: the file "
                     "may be cut, copy or export it again, or end its last line if it is whole",
                     last_ && before.decimals > 0
                         ? rsi::counted(before.decimals, "decimal") + " or more and "
                         : "",
                     as_found(field)));
  last_ = {field, std::min(before.decimals, decimals), std::min(before.digits, digits)};
}

bool CsvFile::next_line() {
  while (at_ < content_.size()) {
    const auto end = std::min(content_.find('\n', at_), content_.size());
    const auto line = rsi::trimmed(std::string_view(content_).substr(at_, end - at_));
    ++line_;
    if (line.empty() || line.front() == '#') {
      at_ = std::min(end + 1, content_.size());
      continue;
    }
    if (separator_ == 0) separator_ = separator_of(line);
    fields_.clear();
    while (next_field()) {
    }
    return true;
  }
  return false;
}

/// Takes a field and the separator behind it off the line. False after the last field.
bool CsvFile::next_field() {
  const auto skip_blanks = [this] {
    at_ = std::min(content_.find_first_not_of(separator_ == '\t' ? " \r" : " \t\r", at_),
                   content_.size());
  };
  const auto at_end = [this] { return at_ == content_.size() || content_[at_] == '\n'; };
  skip_blanks();
  if (!at_end() && content_[at_] == '"') {
    fields_.push_back(quoted_field());
    skip_blanks();
    if (separator_ != ' ' && !at_end() && content_[at_] != separator_)
      throw CsvError(place() + ": expected the next field after a closing quote, found more of " +
                     "the same: write a quote inside of quotes twice");
  } else {
    const std::array ends{separator_, '\n'};
    const auto begin = at_;
    at_ = std::min(content_.find_first_of(ends.data(), at_, ends.size()), content_.size());
    fields_.push_back(rsi::trimmed(std::string_view(content_).substr(begin, at_ - begin)));
    if (separator_ == ' ') skip_blanks();
  }
  const bool last = at_end();
  if (at_ < content_.size() && (last || separator_ != ' ')) ++at_;
  return !last;
}

/// What stands in quotes may hold separators, ends of lines, and quotes that are written twice.
std::string_view CsvFile::quoted_field() {
  const std::size_t begin = ++at_;
  std::size_t end = begin;  // the text takes the place of what it is written as
  const std::size_t first_line = line_;
  while (true) {
    if (at_ == content_.size())
      throw CsvError(fmt::format(
          "{}: line {}: expected a closing quote, found none up to the end of the file: add it",
          path_.string(), first_line));
    const char c = content_[at_++];
    if (c == '\n') ++line_;
    if (c == '"') {
      if (at_ == content_.size() || content_[at_] != '"') break;
      ++at_;
    }
    content_[end++] = c;
  }
  return rsi::trimmed(std::string_view(content_).substr(begin, end - begin));
}

bool CsvFile::any_number() const {
  for (std::size_t k = 0; k < std::min(fields_.size(), columns_.size()); ++k)
    if (!columns_[k].empty() && rsi::number(fields_[k])) return true;
  return false;
}

std::optional<rsi::Decimal> CsvFile::decimal(std::size_t column) const {
  const auto text = fields_[column];
  if (text.empty()) return std::nullopt;
  const auto number = printed_number(text);
  if (!number)
    fail(column, "expected a number, found " + as_found(text) +
                     (may_be_thousands(text) ? ": write nothing between thousands, and a decimal "
                                               "point"
                      : text.find(',') != std::string_view::npos
                          ? ": write a decimal point"
                          : ": correct it, or leave it empty if the value is missing"));
  if (std::abs(number->value) > kLargestMeasured)
    fail(column, "expected a measured number, found " + as_found(text) + ": correct it");
  return number;
}

double CsvFile::number(std::size_t column) const {
  const auto found = decimal(column);
  if (!found) fail(column, "expected a number, found nothing: fill it in");
  return found->value;
}

std::size_t CsvFile::whole_number(std::size_t column, std::size_t least, std::size_t most) const {
  const double value = number(column);
  if (value == std::floor(value) && value >= static_cast<double>(least) &&
      value <= static_cast<double>(most))
    return static_cast<std::size_t>(value);
  fail(column, fmt::format("expected a whole number from {} to {}, found {}: correct it", least,
                           most, as_found(fields_[column])));
}

void CsvFile::fail(std::size_t column, const std::string& problem) const {
  throw CsvError(fmt::format("{}, column {} ({}): {}", place(), column + 1,
                             rsi::in_short(columns_[column]), problem));
}

void CsvFile::fail_header(const std::string& problem) const {
  const std::string text = header_place() + ": " + problem;
  if (declared_) throw std::invalid_argument(text);
  throw CsvError(text);
}

void CsvFile::fail_header(std::size_t column, const std::string& problem) const {
  const auto text = fmt::format("{}, column {} ({}): {}", header_place(), column + 1,
                                rsi::in_short(columns_[column]), problem);
  if (declared_) throw std::invalid_argument(text);
  throw CsvError(text);
}

std::string CsvFile::place() const {
  return fmt::format("{}: line {}", path_.string(), line_);
}

std::string CsvFile::header_place() const {
  if (declared_) return path_.empty() ? "columns" : "--columns";
  return fmt::format("{}: line {}", path_.string(), header_line_);
}

std::vector<std::string> column_names(std::string_view columns) {
  std::vector<std::string> all;
  while (!columns.empty() || !all.empty()) {
    const auto end = columns.find(',');
    all.emplace_back(columns.substr(0, end));
    if (end == std::string_view::npos) break;
    columns.remove_prefix(end + 1);
  }
  return all;
}

}  // namespace sweepd
