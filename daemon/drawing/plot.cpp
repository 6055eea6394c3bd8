#include "daemon/drawing/plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

constexpr double kTick = 4;

bool holds_two_ticks(const Range& range, double step) {
  return std::floor(range.high / step + 1e-9) > std::ceil(range.low / step - 1e-9);
}

/// A smaller one than for `about` ticks where an axis would have one alone.
double step_of(const Range& range, std::size_t about) {
  const double rough = range.size() / static_cast<double>(std::max<std::size_t>(about, 1));
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0, 0.5})
    if (factor * power >= 0.999 * rough || !holds_two_ticks(range, step)) step = factor * power;
  return step;
}

/// What a tick at the logarithm `value` says.
std::string power_text(double value) {
  const double number = std::pow(10, value);
  return fixed(number, number < 1 ? static_cast<int>(std::ceil(-value)) : 0);
}

struct Tick {
  double at;
  std::string text;
};

/// Powers of ten or, where an axis would have fewer than two, round numbers.
std::vector<Tick> logarithmic_ticks(const Range& range, std::size_t about) {
  std::vector<Tick> all;
  const double first = std::ceil(range.low);
  for (int k = 0; first + k <= range.high; ++k) all.push_back({first + k, power_text(first + k)});
  if (all.size() > 1) return all;
  const Range numbers{std::pow(10, range.low), std::pow(10, range.high)};
  all.clear();
  for (const double value : ticks(numbers, about))
    all.push_back({std::log10(value), tick_text(value, step_of(numbers, about))});
  return all;
}

std::vector<Tick> ticks_of(const Plot::Axis& axis) {
  if (axis.ticks == 0) return {};
  if (axis.logarithmic) return logarithmic_ticks(axis.range, axis.ticks);
  std::vector<Tick> all;
  for (const double value : ticks(axis.range, axis.ticks))
    all.push_back({value, tick_text(value, step_of(axis.range, axis.ticks))});
  return all;
}

}  // namespace

Range Range::nothing() {
  return {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
}

void Range::include(double value) {
  if (!std::isfinite(value)) return;
  low = std::min(low, value);
  high = std::max(high, value);
}

Range Range::widened(double share) const {
  if (empty()) return {-1, 1};
  const double more = size() > 0 ? share * size() : std::max(std::abs(low), 1e-6) * 0.5;
  return {low - more, high + more};
}

std::vector<double> ticks(const Range& range, std::size_t about) {
  std::vector<double> all;
  if (!(range.size() > 0) || !std::isfinite(range.size())) return all;
  const double step = step_of(range, about);
  for (double k = std::ceil(range.low / step - 1e-9); k * step <= range.high + 1e-9 * step; ++k)
    all.push_back(k * step);
  return all;
}

std::string tick_text(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  return fixed(value, decimals);
}

Plot::Plot(Picture& picture, const Frame& frame, const Axis& x, const Axis& y)
    : frame_(frame), x_(x.range), y_(y.range), inside_(picture.inside(frame)) {
  for (const auto& [value, text] : ticks_of(x)) {
    const double at = spot(value, 0).x();
    inside_.line({at, frame.top}, {at, frame.bottom()}, "grid");
    picture.line({at, frame.bottom()}, {at, frame.bottom() + kTick}, "axis");
    picture.words({at, frame.bottom() + kTick + 9}, text, Anchor::middle, "small");
  }
  for (const auto& [value, text] : ticks_of(y)) {
    const double at = spot(0, value).y();
    inside_.line({frame.left, at}, {frame.right(), at}, "grid");
    picture.line({frame.left - kTick, at}, {frame.left, at}, "axis");
    picture.words({frame.left - kTick - 2, at + 3}, text, Anchor::end, "small");
  }
  picture.bar(frame, "hollow axis");
  if (!x.title.empty())
    picture.words({frame.middle().x(), frame.bottom() + 26}, x.title, Anchor::middle);
  if (!y.title.empty()) picture.words_upwards({frame.left - 40, frame.middle().y()}, y.title);
}

Spot Plot::spot(double x, double y) const {
  return {frame_.left + (x - x_.low) / x_.size() * frame_.width,
          frame_.bottom() - (y - y_.low) / y_.size() * frame_.height};
}

std::vector<Spot> Plot::spots(std::span<const std::pair<double, double>> points) const {
  std::vector<Spot> all;
  all.reserve(points.size());
  for (const auto& [x, y] : points) all.push_back(spot(x, y));
  return all;
}

void Plot::line(std::span<const std::pair<double, double>> points, std::string_view kind) {
  inside_.path(spots(points), kind);
}
void Plot::dots(std::span<const std::pair<double, double>> points, std::string_view kind) {
  inside_.dots(spots(points), kind);
}
void Plot::level(double y, std::string_view kind) {
  inside_.line(spot(x_.low, y), spot(x_.high, y), kind);
}
void Plot::mark(double x, std::string_view kind) {
  inside_.line(spot(x, y_.low), spot(x, y_.high), kind);
}

}  // namespace sweepd
