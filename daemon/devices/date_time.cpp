#include <charconv>
#include <chrono>
#include <string>
#include <utility>

#include "daemon/devices/device_words.hpp"
#include "rsi/ascii.hpp"
#include "rsi/telegram/decimal.hpp"

namespace sweepd {
namespace {

/// Takes what it recognises off the front of a text.
class Front {
 public:
  explicit Front(std::string_view text) : rest_(rsi::trimmed(text)) {}

  [[nodiscard]] bool is_empty() const { return rest_.empty(); }
  [[nodiscard]] bool begins(char c) const { return !rest_.empty() && rest_.front() == c; }
  bool take(char c) {
    if (!begins(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void skip_blanks() { rest_ = rsi::trimmed(rest_); }
  /// One to `most` digits.
  std::optional<int> whole(std::size_t most) {
    std::size_t digits = 0;
    while (digits < rest_.size() && digits < most && rsi::is_digit(rest_[digits])) ++digits;
    if (digits == 0) return std::nullopt;
    int value = 0;
    std::from_chars(rest_.data(), rest_.data() + digits, value);
    rest_.remove_prefix(digits);
    return value;
  }
  /// What is behind the point, as part of one.
  std::optional<double> fraction() {
    std::string digits = "0.";
    while (!rest_.empty() && rsi::is_digit(rest_.front())) {
      digits += rest_.front();
      rest_.remove_prefix(1);
    }
    return digits.size() > 2 ? rsi::number(digits) : std::nullopt;
  }
  bool word(std::string_view lower_case) {
    if (!rsi::equal_ignoring_case(rest_.substr(0, lower_case.size()), lower_case)) return false;
    rest_.remove_prefix(lower_case.size());
    return true;
  }

 private:
  std::string_view rest_;
};

/// Days from a day that all dates share.
std::optional<double> days(Front& front) {
  const auto first = front.whole(4);
  for (const char mark : {'-', '/', '.'}) {
    if (!first || !front.take(mark)) continue;
    const auto second = front.whole(2);
    if (!second || !front.take(mark)) return std::nullopt;
    const auto third = front.whole(4);
    if (!third) return std::nullopt;
    int year = *third, month = *first, day = *second;
    if (*first > 31) {
      year = *first, month = *second, day = *third;
    } else if (mark != '/' || *first > 12) {
      std::swap(month, day);
    }
    const std::chrono::year_month_day date(std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day)));
    if (!date.ok()) return std::nullopt;
    return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
  }
  return std::nullopt;
}

/// Of the day; hours count from 1 to 12 before AM and PM.
std::optional<double> seconds(Front& front) {
  const auto hour = front.whole(2);
  if (!hour || !front.take(':')) return std::nullopt;
  const auto minute = front.whole(2);
  if (!minute || *minute > 59) return std::nullopt;
  double second = 0;
  if (front.take(':')) {
    const auto whole = front.whole(2);
    if (!whole || *whole > 60) return std::nullopt;
    second = *whole;
    if (front.take('.') || front.take(',')) {
      const auto part = front.fraction();
      if (!part) return std::nullopt;
      second += *part;
    }
  }
  front.skip_blanks();
  int hours = *hour;
  const bool is_am = front.word("am");
  if (is_am || front.word("pm")) {
    if (hours < 1 || hours > 12) return std::nullopt;
    hours = hours % 12 + (is_am ? 0 : 12);
  }
  if (hours > 23) return std::nullopt;
  return 3600.0 * hours + 60.0 * *minute + second;
}

/// Of a time zone, east of Greenwich.
std::optional<double> zone(Front& front) {
  front.skip_blanks();
  if (front.is_empty() || front.word("z") || front.word("utc")) return 0;
  const double sign = front.begins('-') ? -1 : 1;
  if (!front.take('+') && !front.take('-')) return std::nullopt;
  const auto hours = front.whole(2);
  front.take(':');
  const auto minutes = front.whole(2);
  if (!hours) return std::nullopt;
  return sign * (3600.0 * *hours + 60.0 * minutes.value_or(0));
}

}  // namespace

std::optional<double> seconds_of_date(std::string_view text) {
  constexpr double kDay_s = 86400;
  Front front(text);
  Front with_date = front;
  const auto date = days(with_date);
  if (date) {
    front = with_date;
    if (!front.take('T') && !front.take(',')) front.skip_blanks();
    front.skip_blanks();
  }
  const auto time = seconds(front);
  if (!time) return std::nullopt;
  const auto offset = zone(front);
  if (!offset || !front.is_empty()) return std::nullopt;
  return date.value_or(0) * kDay_s + *time - *offset;
}

}  // namespace sweepd
