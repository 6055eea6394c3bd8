#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/devices/device_text.hpp"
#include "rsi/telegram/decimal.hpp"

namespace sweepd {

/// What stands between the commas; nothing of an empty text.
[[nodiscard]] std::vector<std::string> column_names(std::string_view columns);

/// A text file of columns, read a line at a time.
///
/// Commas stand between the fields or, where the first line has none, semicolons, tabs, or blanks.
/// Lines that are empty or begin with # are passed over; a byte order mark and CR LF are taken off,
/// and quotes around a field, which may then hold anything (RFC 4180). UTF-8 or, with its mark,
/// UTF-16. A file that may have been cut within its last field is refused: its last line has no
/// end, and that field is shorter than all before it. All functions that read throw CsvError.
class CsvFile {
 public:
  /// Reads the whole file. The first line names the columns, unless `columns` does; then a first
  /// line without any number in the columns that have a name is passed over as a header.
  explicit CsvFile(const std::filesystem::path& path, std::vector<std::string> columns = {});
  /// The same of a file whose content was read already. Without a path, `columns` are not those of
  /// the command line.
  CsvFile(std::filesystem::path path, std::string content, std::vector<std::string> columns);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The columns' names in order and in lower case; empty where a column is to be skipped (named -
  /// or _, or nothing).
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }

  /// Goes to the next line of data, which has as many fields as there are columns. False at the
  /// end.
  bool next();
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::size_t bytes_read() const { return at_; }

  // Of the current line; `column` counts from 0.
  [[nodiscard]] std::string_view text(std::size_t column) const { return fields_[column]; }
  /// Finite, and no larger than any measurement; nothing where the field is empty. `decimals` are
  /// those of the value: 1.25e-3 has 5.
  [[nodiscard]] std::optional<rsi::Decimal> decimal(std::size_t column) const;
  /// As above, but a field that must be there.
  [[nodiscard]] double number(std::size_t column) const;
  [[nodiscard]] std::size_t whole_number(std::size_t column, std::size_t least,
                                         std::size_t most) const;

  [[noreturn]] void fail(std::size_t column, const std::string& problem) const;
  /// At the line that names the columns. Throws std::invalid_argument where `columns` did.
  [[noreturn]] void fail_header(const std::string& problem) const;
  [[noreturn]] void fail_header(std::size_t column, const std::string& problem) const;

 private:
  /// What the lines before show of the last column.
  struct LastColumn {
    std::string_view newest;
    std::size_t decimals;  // the fewest
    std::size_t digits;
  };
  void check_end();
  bool next_line();
  bool next_field();
  [[nodiscard]] std::string_view quoted_field();
  [[nodiscard]] std::string place() const;
  [[nodiscard]] std::string header_place() const;
  [[nodiscard]] bool any_number() const;

  std::filesystem::path path_;
  bool declared_;  // the columns, outside of the file
  std::vector<std::string> columns_;
  std::string content_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  std::size_t header_line_ = 0;
  char separator_ = 0;
  bool waiting_ = false;  // the current line is data that next() has not yet gone to
  std::vector<std::string_view> fields_;
  std::optional<LastColumn> last_;  // nothing before the first line of data
};

}  // namespace sweepd
