#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/drawing/picture.hpp"

namespace sweepd {

/// From where to where an axis of a plot goes.
struct Range {
  double low = 0;
  double high = 0;

  void include(double value);
  [[nodiscard]] bool empty() const { return !(low <= high); }
  [[nodiscard]] double size() const { return high - low; }
  /// Nothing yet.
  [[nodiscard]] static Range nothing();
  /// A little more on both sides; something even where there was nothing.
  [[nodiscard]] Range widened(double share) const;
};

/// Round numbers within `range`, about so many: 1, 2 or 5 times a power of ten apart.
[[nodiscard]] std::vector<double> ticks(const Range& range, std::size_t about);
/// As many decimals as tell ticks apart.
[[nodiscard]] std::string tick_text(double value, double step);

/// A rectangle with two axes, into which lines, dots and bars go.
class Plot {
 public:
  struct Axis {
    Range range;
    std::string_view title = {};  ///< with its unit
    bool logarithmic = false;     ///< the range is of the logarithm to base 10
    std::size_t ticks = 5;        ///< about so many; 0: none
  };

  /// Draws the axes, ticks and titles; `frame` is the inner rectangle, titles and ticks are
  /// outside.
  Plot(Picture& picture, const Frame& frame, const Axis& x, const Axis& y);

  [[nodiscard]] Spot spot(double x, double y) const;
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// What is drawn here stays within the frame.
  [[nodiscard]] Picture& inside() { return inside_; }
  void line(std::span<const std::pair<double, double>> points, std::string_view kind);
  void dots(std::span<const std::pair<double, double>> points, std::string_view kind);
  void level(double y, std::string_view kind);
  void mark(double x, std::string_view kind);

 private:
  [[nodiscard]] std::vector<Spot> spots(std::span<const std::pair<double, double>> points) const;

  Frame frame_;
  Range x_;
  Range y_;
  Picture inside_;
};

}  // namespace sweepd
