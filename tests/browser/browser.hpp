#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/types.h>

#include "tests/daemon/temporary_folder.hpp"

namespace sweepd::test {

/// Chromium without a window, driven through chromedriver by W3C WebDriver. Throws
/// std::runtime_error with what the driver says.
class Browser {
 public:
  using Json = nlohmann::json;

  /// Whether both are installed.
  [[nodiscard]] static bool is_here();

  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void open(const std::string& url);
  /// What the body of a function returns.
  Json run(const std::string& script);
  /// What it passes on to the function that is its last argument.
  Json run_later(const std::string& script);
  /// What an expression is, as text.
  std::string text(const std::string& expression);
  /// Whether the expression becomes true within `seconds`.
  bool becomes(const std::string& expression, int seconds = 20);

  void size(int width, int height, bool phone);
  void scheme(bool dark);
  void key(const std::string& name);
  /// Of the window, or of the whole page.
  void screenshot(const std::filesystem::path& file, bool whole = false);

  /// What the console has said since the last call, a line each.
  std::vector<std::string> console();
  /// Every address that was asked for since the last call.
  std::vector<std::string> requested();

 private:
  Json command(const std::string& method, const std::string& path, const Json& body);
  Json in_session(const std::string& path, const Json& body);
  Json devtools(const std::string& name, const Json& parameters);

  TemporaryFolder folder_;
  std::uint16_t port_;
  pid_t driver_ = -1;
  std::string session_;
};

}  // namespace sweepd::test
