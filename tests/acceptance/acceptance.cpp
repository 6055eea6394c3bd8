#include "tests/acceptance/acceptance.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "daemon/text/numbers.hpp"
#include "rsi/telegram/decimal.hpp"

namespace acceptance {

namespace fs = std::filesystem;

std::optional<fs::path> real_data(const std::string& folder) {
  const char* elsewhere = std::getenv("SWEEPD_ACCEPTANCE_DATA");
  const fs::path all = elsewhere != nullptr ? elsewhere : SWEEPD_ACCEPTANCE_DATA;
  if (fs::is_directory(all / folder)) return all / folder;
  std::cout << "acceptance data missing: no folder " << (all / folder).lexically_normal().string()
            << ": set SWEEPD_ACCEPTANCE_DATA to the folder that holds " << folder << std::endl;
  return std::nullopt;
}

fs::path shipped(const std::string& file) {
  return fs::path(SWEEPD_SOURCE_DIR) / "config" / file;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "sweepd-acceptance-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name + ": cannot be created");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::operator/(const std::string& name) const {
  return path_ / name;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const fs::path& file) {
  const std::string text = text_of(file);
  std::vector<std::string> lines;
  for (const auto line : fields(text, '\n')) lines.emplace_back(line);
  if (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

std::vector<std::string_view> fields(std::string_view line, char separator) {
  std::vector<std::string_view> all;
  while (true) {
    const auto end = line.find(separator);
    all.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return all;
    line.remove_prefix(end + 1);
  }
}

double number(std::string_view text) {
  const auto value = rsi::number(text);
  if (!value) throw std::runtime_error("no number: \"" + std::string(text) + "\"");
  return *value;
}

std::string left(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

std::string right(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string right(double value, int decimals, std::size_t width) {
  return right(sweepd::fixed(value, decimals), width);
}

}  // namespace acceptance
