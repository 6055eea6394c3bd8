#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

/// One thing that is wrong with a file.
struct Mistake {
  std::string text;
  std::uint32_t line = 0;  ///< 0: no place is known
  std::uint32_t column = 0;
};

/// Something that a user edits is wrong: settings, a robot description, a sweep plan. The text
/// reads
///   FILE:LINE:COLUMN: key: what was expected, what was found: what to do
/// with as much of the place as is known, and has a line for each mistake. The program ends with
/// exit code 78 on it.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(const std::string& text);
  /// With the same text, a mistake in each line.
  explicit ConfigError(std::vector<Mistake> mistakes);

  [[nodiscard]] const std::vector<Mistake>& mistakes() const { return *mistakes_; }

 private:
  std::shared_ptr<const std::vector<Mistake>> mistakes_;  ///< a copy must not fail
};

/// Keeps what is wrong with a file until all of it is known.
class Mistakes {
 public:
  /// Keeps those of `read`.
  template <typename Read>
  void of(const Read& read) {
    try {
      read();
    } catch (const ConfigError& error) {
      all_.insert(all_.end(), error.mistakes().begin(), error.mistakes().end());
    }
  }
  /// Throws a ConfigError with all of them, if there are any, from the top of the file down.
  void tell() const;

 private:
  std::vector<Mistake> all_;
};

/// A key that has its place in another table of the file.
struct KeyElsewhere {
  std::string key;
  std::string words;  ///< `"keep_days" of [robot.recording]`
};

/// A table of a TOML file, read strictly: every mistake is a ConfigError that names file, line,
/// column and key. Copies are cheap and keep the file's content alive.
///
/// Units stand at the end of a key (`_ms`, `_mm`, `_deg` ...) and are named in the errors. A
/// function that reads a key throws where the key is missing, except has(), found() and table().
class TomlTable {
 public:
  /// The top table of `file`; throws if it cannot be read or is not TOML.
  [[nodiscard]] static TomlTable load(const std::filesystem::path& file);
  /// The same from memory; `file` is what errors name.
  [[nodiscard]] static TomlTable parse(std::string_view text, const std::filesystem::path& file);

  /// Throws with all keys, from the top, that are not one of `keys`, and with those that were
  /// probably meant.
  void allow_only(const std::vector<std::string_view>& keys) const;
  /// Adds the same to `mistakes`. What was meant may also be a key from `elsewhere`. Returns those
  /// of `keys` that were.
  std::vector<std::string_view> check_keys(const std::vector<std::string_view>& keys,
                                           const std::vector<KeyElsewhere>& elsewhere,
                                           Mistakes& mistakes) const;

  [[nodiscard]] bool has(std::string_view key) const;
  /// A string with something in it.
  [[nodiscard]] std::string text(std::string_view key) const;
  [[nodiscard]] bool flag(std::string_view key) const;
  /// A finite number, whole or not, from `least` to `most`.
  [[nodiscard]] double number(std::string_view key, double least, double most) const;
  [[nodiscard]] std::int64_t whole_number(std::string_view key, std::int64_t least,
                                          std::int64_t most) const;
  /// An array of finite numbers from `least` to `most`, perhaps empty.
  [[nodiscard]] std::vector<double> numbers(std::string_view key, double least, double most) const;
  /// An array of strings, perhaps empty.
  [[nodiscard]] std::vector<std::string> texts(std::string_view key) const;
  /// The tables [[key]] in order of appearance, at least one.
  [[nodiscard]] std::vector<TomlTable> tables(std::string_view key) const;
  /// The table [key], if it is there.
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key) const;

  /// Line on which this table begins, from 1.
  [[nodiscard]] int line() const;
  /// The value of `key` in words, for errors: `the string "abc"`, `the number 5`, `nothing`.
  [[nodiscard]] std::string found(std::string_view key) const;
  /// What errors at the value of `key` begin with, up to the key: `FILE:LINE:COLUMN: robot.`
  [[nodiscard]] std::string place(std::string_view key) const;
  /// Throws a ConfigError at the value of `key`, or at this table if there is none.
  [[noreturn]] void fail(std::string_view key, const std::string& problem) const;

 private:
  struct Node;
  explicit TomlTable(std::shared_ptr<const Node> node);

  std::shared_ptr<const Node> node_;
};

/// A number as a person writes it: the shortest text that reads back as `value`, in any locale.
[[nodiscard]] std::string number_text(double value);

}  // namespace sweepd
