#include "daemon/csv_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

/// Beyond what anyone measures in mm, degrees or seconds, and harmless to the numerics.
constexpr double kLargest = 1e12;

std::string read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  // A folder can be opened, but not read.
  if (file && !std::filesystem::is_directory(path)) content << file.rdbuf();
  if (!file || std::filesystem::is_directory(path))
    throw CsvError(path.string() + ": cannot be read: give a text file of columns");
  return std::move(content).str();
}

char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

std::string_view unquoted(std::string_view field) {
  field = rsi::trimmed(field);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
    field = rsi::trimmed(field.substr(1, field.size() - 2));
  return field;
}

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  while (true) {
    const auto end = line.find(separator);
    fields.push_back(unquoted(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
    if (separator == ' ') line = rsi::trimmed(line);
  }
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  if (text.empty()) return "nothing";
  return '"' + rsi::printable(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "") +
         '"';
}

/// Digits after the point, were the number written without an exponent.
int decimals_of(std::string_view text, int decimals) {
  // A zero may be written with any exponent; no number that is taken has more digits than these.
  constexpr int kLeastExponent = -400;
  constexpr int kMostExponent = 12;
  const auto e = text.find_first_of("eE");
  if (e == std::string_view::npos) return decimals;
  const auto digits = text.substr(e + 1 + (text.substr(e + 1).starts_with('+') ? 1 : 0));
  int exponent = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  return decimals - std::clamp(exponent, kLeastExponent, kMostExponent);
}

}  // namespace

CsvFile::CsvFile(std::filesystem::path path, std::vector<std::string> columns)
    : path_(std::move(path)),
      declared_(!columns.empty()),
      columns_(std::move(columns)),
      content_(read(path_)) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (content_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
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
  for (auto& name : columns_)
    if (name == "-" || name == "_") name.clear();
  if (declared_ && !any_number()) waiting_ = false;
}

bool CsvFile::next() {
  if (!std::exchange(waiting_, false) && !next_line()) return false;
  if (fields_.size() == columns_.size()) return true;
  throw CsvError(place() + ": expected " + std::to_string(columns_.size()) + " columns, as " +
                 (declared_ ? "named with --columns" : "in line " + std::to_string(header_line_)) +
                 ", found " + std::to_string(fields_.size()) +
                 (declared_ ? ": name all of them, - for one to skip" : ": correct the line"));
}

bool CsvFile::next_line() {
  while (at_ < content_.size()) {
    const auto end = std::min(content_.find('\n', at_), content_.size());
    const auto line = std::string_view(content_).substr(at_, end - at_);
    at_ = std::min(end + 1, content_.size());
    ++line_;
    const auto text = rsi::trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    if (separator_ == 0) separator_ = separator_of(text);
    // Between tabs, what is empty at the end is a field too.
    const auto end_of_text = line.ends_with('\r') ? line.size() - 1 : line.size();
    split(separator_ == ' ' ? text : line.substr(0, end_of_text), separator_, fields_);
    return true;
  }
  return false;
}

bool CsvFile::any_number() const {
  for (std::size_t k = 0; k < std::min(fields_.size(), columns_.size()); ++k)
    if (!columns_[k].empty() && rsi::number(fields_[k])) return true;
  return false;
}

std::optional<rsi::Decimal> CsvFile::decimal(std::size_t column) const {
  const auto text = fields_[column];
  if (text.empty()) return std::nullopt;
  auto number = rsi::decimal(text);
  if (!number)
    fail(column, "expected a number, found " + quoted(text) +
                     (text.find(',') != std::string_view::npos
                          ? ": write a decimal point"
                          : ": correct it, or leave it empty if the value is missing"));
  if (std::abs(number->value) > kLargest)
    fail(column, "expected a measured number, found " + quoted(text) + ": correct it");
  number->decimals = decimals_of(text, number->decimals);
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
  fail(column, "expected a whole number from " + std::to_string(least) + " to " +
                   std::to_string(most) + ", found " + quoted(fields_[column]) + ": correct it");
}

void CsvFile::fail(std::size_t column, const std::string& problem) const {
  throw CsvError(place() + ", column " + std::to_string(column + 1) + " (" +
                 rsi::printable(columns_[column]) + "): " + problem);
}

void CsvFile::fail_header(const std::string& problem) const {
  const std::string text = header_place() + ": " + problem;
  if (declared_) throw std::invalid_argument(text);
  throw CsvError(text);
}

void CsvFile::fail_header(std::size_t column, const std::string& problem) const {
  const std::string text = header_place() + ", column " + std::to_string(column + 1) + " (" +
                           rsi::printable(columns_[column]) + "): " + problem;
  if (declared_) throw std::invalid_argument(text);
  throw CsvError(text);
}

std::string CsvFile::place() const {
  return path_.string() + ": line " + std::to_string(line_);
}

std::string CsvFile::header_place() const {
  return declared_ ? "--columns" : path_.string() + ": line " + std::to_string(header_line_);
}

}  // namespace sweepd
