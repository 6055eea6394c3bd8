#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace sweepd {

/// Shows on the terminal how far long work is, in one line that is drawn anew at most ten times a
/// second and wiped at the end:
///   simulate  joint 3    42 %  [#########.............]  18 s left
class Progress {
 public:
  using Clock = std::chrono::steady_clock;
  using Terminal = std::function<void(std::string_view text)>;

  /// Draws on stderr if that is a terminal, else nowhere.
  [[nodiscard]] static Terminal standard_error();

  /// `work` stands at the beginning of the line. Without a terminal nothing is drawn.
  explicit Progress(std::string work, Terminal terminal = standard_error(),
                    Clock::time_point start = Clock::now());
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` steps are done, `detail` is what is being done. The time left is reckoned
  /// from the time since the start.
  void update(double done, double total, std::string_view detail = {},
              Clock::time_point now = Clock::now());
  /// Wipes the line, for other output to take its place.
  void clear();

 private:
  std::string work_;
  Terminal terminal_;
  Clock::time_point start_;
  std::optional<Clock::time_point> drawn_;
  bool visible_ = false;
};

}  // namespace sweepd
