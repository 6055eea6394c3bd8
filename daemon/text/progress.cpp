#include "daemon/text/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <unistd.h>

namespace sweepd {
namespace {

constexpr std::chrono::milliseconds kBetweenDrawings{100};
constexpr std::size_t kBarWidth = 24;
constexpr std::string_view kWipe = "\r\x1b[K";  // ECMA-48: erase to the end of the line

std::string time_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  return whole < 100 ? std::to_string(whole) + " s" : std::to_string((whole + 59) / 60) + " min";
}

}  // namespace

Progress::Terminal Progress::standard_error() {
  if (isatty(STDERR_FILENO) != 1) return {};
  return [](std::string_view text) {
    // A line that is not drawn harms nobody.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
  };
}

Progress::Progress(std::string work, Terminal terminal, Clock::time_point start)
    : work_(std::move(work)), terminal_(std::move(terminal)), start_(start) {}

void Progress::update(double done, double total, std::string_view detail, Clock::time_point now) {
  if (!terminal_ || (drawn_ && now - *drawn_ < kBetweenDrawings)) return;
  drawn_ = now;
  visible_ = true;

  const double share = total > 0 ? std::clamp(done / total, 0.0, 1.0) : 0.0;
  const auto percent = std::to_string(static_cast<int>(100 * share));
  const auto filled = static_cast<std::size_t>(share * kBarWidth);
  std::string line(kWipe);
  line.append(work_).append("  ");
  if (!detail.empty()) line.append(detail).append("  ");
  line.append(3 - percent.size(), ' ').append(percent).append(" %  [");
  line.append(filled, '#').append(kBarWidth - filled, '.').append("]");
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  if (share > 0)
    line.append("  ").append(time_text(elapsed_s * (1 - share) / share)).append(" left");
  terminal_(line);
}

void Progress::clear() {
  if (!std::exchange(visible_, false)) return;
  drawn_.reset();
  terminal_(kWipe);
}

}  // namespace sweepd
