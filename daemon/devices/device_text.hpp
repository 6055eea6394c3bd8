#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/decimal.hpp"

namespace sweepd {

/// A file of points or axes is wrong. The text reads
///   FILE: line L, column C (NAME): what was expected, what was found: what to do
/// with as much of the place as is known.
class CsvError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The text of a file's bytes, without a byte order mark: with one of UTF-16 it is read so, in
/// either order, and what is no UTF-8 as Latin-1, which older programs write. Throws CsvError at
/// UTF-16 that is none, and at what is no text.
[[nodiscard]] std::string as_utf8(const std::filesystem::path& path, std::string bytes);

using Fields = std::vector<std::string_view>;

/// The text that a measuring device's program wrote, by lines, which end with LF or CR LF.
class DeviceText {
 public:
  /// Throws CsvError at UTF-16 that is none.
  DeviceText(std::filesystem::path path, std::string bytes);
  DeviceText(const DeviceText&) = delete;
  DeviceText& operator=(const DeviceText&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::size_t lines() const { return lines_.size(); }
  /// From 0, without its end and without blanks at its end; empty beyond the last.
  [[nodiscard]] std::string_view line(std::size_t number) const;
  /// The file ends without an end of line.
  [[nodiscard]] bool is_open() const { return is_open_; }

  /// A comment or nothing.
  [[nodiscard]] bool is_passed_over(std::size_t number) const;

  /// `line` counts from 0, and is told from 1.
  [[noreturn]] void fail(std::size_t line, const std::string& problem) const;
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::filesystem::path path_;
  std::string content_;
  std::vector<std::string_view> lines_;
  bool is_open_ = false;
};

/// The fields of a line, without blanks and quotes around them. Blanks separate as often as they
/// come; what stands in quotes separates nothing.
[[nodiscard]] Fields fields_of(std::string_view line, char separator);

/// A tab, a semicolon, a comma or, where `line` has none of them, a blank.
[[nodiscard]] char separator_in(std::string_view line);

[[nodiscard]] std::string lower(std::string_view text);
/// Whatever the case of its letters.
[[nodiscard]] bool contains(std::string_view text, std::string_view lower_case_word);

/// What one of this unit of length is in mm, of whatever case and number ("Meters", "mm"); 0 for
/// anything else.
[[nodiscard]] double length_unit_mm(std::string_view name);

/// A finite number as a file prints it. `decimals` are those of the value: 1.25e-3 has 5.
[[nodiscard]] std::optional<rsi::Decimal> printed_number(std::string_view text);

/// Whether a sign stands between thousands, or seems to: 1,234 and 1'234.5, and 1.234 too.
[[nodiscard]] bool may_be_thousands(std::string_view text);

/// A field for a message: in quotes and cut, or "nothing".
[[nodiscard]] std::string as_found(std::string_view text);

}  // namespace sweepd
