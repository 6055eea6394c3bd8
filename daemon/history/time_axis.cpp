#include "daemon/history/time_axis.hpp"

#include "daemon/history/history.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using std::chrono::days;
using std::chrono::months;
using std::chrono::sys_days;

std::chrono::nanoseconds time_at(double years) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(years * kYear_s));
}

}  // namespace

std::vector<std::pair<double, std::string>> date_ticks(const Range& range, std::size_t about) {
  constexpr double kMonth = 1.0 / 12, kDay = 86400 / kYear_s;
  const double each = range.size() / static_cast<double>(about);
  const auto low =
      std::chrono::floor<days>(std::chrono::sys_time<std::chrono::nanoseconds>(time_at(range.low)));
  std::vector<std::pair<double, std::string>> ticks;
  const auto add = [&](std::chrono::sys_seconds when, std::size_t from, std::size_t length) {
    const std::chrono::nanoseconds time = when.time_since_epoch();
    const double at = years(time);
    if (at >= range.low && at <= range.high)
      ticks.emplace_back(at, utc_text(time).substr(from, length));
  };
  if (each < kDay) {
    constexpr double kMinute = kDay / 1440;
    int step = 1;
    for (const int next : {2, 5, 10, 15, 30, 60, 120, 180, 360, 720, 1440})
      if (each > step * kMinute) step = next;
    for (std::chrono::sys_seconds time = low; years(time.time_since_epoch()) <= range.high;
         time += std::chrono::minutes(step)) {
      const bool midnight = std::chrono::floor<days>(time) == time;
      add(time, midnight ? 5 : 11, 5);
    }
    return ticks;
  }
  if (each < kMonth) {
    int step = 1;
    for (const int next : {2, 5, 10, 15})
      if (each > step * kDay) step = next;
    for (sys_days day = low; years(day.time_since_epoch()) <= range.high; day += days(step))
      add(day, 5, 5);
    return ticks;
  }
  int step = 1;
  for (const int next : {2, 3, 6, 12, 24, 60, 120, 240, 600})
    if (each > step * kMonth) step = next;
  const std::chrono::year_month_day first(low);
  const int month_of_year = step < 12 ? static_cast<int>(static_cast<unsigned>(first.month())) : 1;
  const int begin = (month_of_year - 1) / step * step;
  int year = static_cast<int>(first.year());
  if (step >= 12) year -= year % (step / 12);
  for (std::chrono::year_month_day day =
           std::chrono::year(year) / std::chrono::January / 1 + months(begin);
       years(sys_days(day).time_since_epoch()) <= range.high; day += months(step))
    add(sys_days(day), 0, step < 12 ? 7 : 4);
  return ticks;
}

Plot plot_over_time(Picture& picture, const Frame& frame, const Range& range, const Plot::Axis& y,
                    std::size_t ticks) {
  Plot plot(picture, frame, {.range = range, .ticks = 0}, y);
  for (const auto& [at, name] : date_ticks(range, ticks)) {
    const double x = plot.spot(at, 0).x();
    plot.mark(at, "grid");
    picture.line({x, frame.bottom()}, {x, frame.bottom() + 4}, "axis");
    picture.words({x, frame.bottom() + 13}, name, Anchor::middle, "small");
  }
  return plot;
}

}  // namespace sweepd
