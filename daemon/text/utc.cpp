#include "daemon/text/utc.hpp"

#include <algorithm>
#include <charconv>

namespace sweepd {
namespace {

// Nanoseconds in 64 bits reach from 1678 to 2261.
constexpr int kFirstYear = 1700;
constexpr int kLastYear = 2200;

std::string digits(std::int64_t value, std::size_t width) {
  std::string text = std::to_string(value);
  return text.size() < width ? std::string(width - text.size(), '0') + text : text;
}

/// Takes a number of so many digits from the front; -1 where there is none.
int take_number(std::string_view& text, std::size_t digits) {
  int value = -1;
  const auto end = text.data() + std::min(digits, text.size());
  if (text.size() < digits || text.front() == '-' ||
      std::from_chars(text.data(), end, value).ptr != end)
    return -1;
  text.remove_prefix(digits);
  return value;
}

bool take(std::string_view& text, char c) {
  if (!text.starts_with(c)) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::string utc_text(std::chrono::nanoseconds since_epoch) {
  using namespace std::chrono;
  const sys_time<milliseconds> time(floor<milliseconds>(since_epoch));
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(time - day);
  return digits(static_cast<int>(date.year()), 4) + "-" +
         digits(static_cast<unsigned>(date.month()), 2) + "-" +
         digits(static_cast<unsigned>(date.day()), 2) + "T" + digits(clock.hours().count(), 2) +
         ":" + digits(clock.minutes().count(), 2) + ":" + digits(clock.seconds().count(), 2) + "." +
         digits(clock.subseconds().count(), 3) + "Z";
}

std::string utc_name(std::chrono::nanoseconds since_epoch) {
  std::string name = utc_text(since_epoch);
  name.erase(name.find('.'), 4);
  std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
  return name;
}

std::optional<std::chrono::nanoseconds> parse_utc(std::string_view text) {
  using namespace std::chrono;
  const int year = take_number(text, 4);
  take(text, '-');
  const int month = take_number(text, 2);
  take(text, '-');
  const int day = take_number(text, 2);
  if (year < kFirstYear || year > kLastYear || month < 0 || day < 0) return std::nullopt;
  const year_month_day date{std::chrono::year(year),
                            std::chrono::month(static_cast<unsigned>(month)),
                            std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  nanoseconds time = sys_days(date).time_since_epoch();
  if (text.empty()) return time;
  if (!take(text, 'T') && !take(text, ' ')) return std::nullopt;
  const int hour = take_number(text, 2);
  take(text, ':');
  const int minute = take_number(text, 2);
  if (hour < 0 || hour > 23 || minute < 0 || minute > 59) return std::nullopt;
  time += hours(hour) + minutes(minute);
  take(text, ':');
  if (!text.empty() && text != "Z") {
    const int second = take_number(text, 2);
    if (second < 0 || second > 59) return std::nullopt;
    time += seconds(second);
    if (take(text, '.'))
      for (nanoseconds unit = milliseconds(100); !text.empty() && text != "Z"; unit /= 10) {
        const int digit = take_number(text, 1);
        if (digit < 0) return std::nullopt;
        time += digit * unit;
      }
  }
  take(text, 'Z');
  return text.empty() ? std::optional(time) : std::nullopt;
}

}  // namespace sweepd
