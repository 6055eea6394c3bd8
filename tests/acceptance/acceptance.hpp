#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace acceptance {

/// A folder of the real data; nothing, said in the words that ctest takes for "skipped", where it
/// is absent. The data lie where the environment variable SWEEPD_ACCEPTANCE_DATA says, or else the
/// CMake variable of the same name.
[[nodiscard]] std::optional<std::filesystem::path> real_data(const std::string& folder);

/// Settings, robots and plans as they are shipped.
[[nodiscard]] std::filesystem::path shipped(const std::string& file);

/// A folder of its own that goes away with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const;

 private:
  std::filesystem::path path_;
};

/// Throws std::runtime_error if the file cannot be read.
[[nodiscard]] std::string text_of(const std::filesystem::path& file);
/// Without their ends of line.
[[nodiscard]] std::vector<std::string> lines_of(const std::filesystem::path& file);
/// The fields of a line; `separator` stands between two.
[[nodiscard]] std::vector<std::string_view> fields(std::string_view line, char separator);
/// Throws std::runtime_error unless all of `text` is a number.
[[nodiscard]] double number(std::string_view text);

/// For the columns of tables in the test log.
[[nodiscard]] std::string left(std::string text, std::size_t width);
[[nodiscard]] std::string right(std::string text, std::size_t width);
[[nodiscard]] std::string right(double value, int decimals, std::size_t width);

}  // namespace acceptance
