#pragma once

#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "daemon/drawing/markup.hpp"

namespace sweepd {

/// A place in a picture: to the right and down, in the picture's units (a px of the page).
using Spot = Eigen::Vector2d;

/// A part of a picture that is drawn into, in the picture's units.
struct Frame {
  double left = 0;
  double top = 0;
  double width = 0;
  double height = 0;

  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
  [[nodiscard]] Spot middle() const { return {left + width / 2, top + height / 2}; }
  /// Without so much on each side.
  [[nodiscard]] Frame within(double room) const;
  [[nodiscard]] bool holds(const Spot& spot) const;
};

enum class Anchor { start, middle, end };

/// A drawing as SVG inside a page. What a stroke or a fill looks like is up to the page's style
/// sheet, by class (see drawing_style()); numbers have two decimals.
class Picture {
 public:
  /// `what` is what it shows, for who cannot see it.
  Picture(Markup parent, double width, double height, std::string_view what);

  void line(const Spot& from, const Spot& to, std::string_view kind);
  /// Not a number is a gap. Spots that nobody could tell apart are left out.
  void path(std::span<const Spot> spots, std::string_view kind, bool closed = false);
  /// Each a dot as wide as the stroke. One dot where many would lie on each other.
  void dots(std::span<const Spot> spots, std::string_view kind);
  void bar(const Frame& bar, std::string_view kind);
  void circle(const Spot& middle, double radius, std::string_view kind);
  /// A line with a head at `to`; no head where it is too short for one.
  void arrow(const Spot& from, const Spot& to, std::string_view kind);
  /// `at` is on the base line.
  void words(const Spot& at, std::string_view text, Anchor anchor = Anchor::start,
             std::string_view kind = {});
  /// Read from below to above, its middle at `at`.
  void words_upwards(const Spot& at, std::string_view text);

  /// From now on nothing is drawn outside `frame`, until the end of what this returns.
  [[nodiscard]] Picture inside(const Frame& frame);

 private:
  explicit Picture(Markup group) : svg_(group) {}
  Markup svg_;
};

/// Classes of the lines, dots and fills of joint `index`, counted from 0: colours by Okabe and Ito,
/// which also people see who do not see all colours, and a dash of its own, for print in grey.
[[nodiscard]] std::string joint_line(std::size_t index);
[[nodiscard]] std::string joint_dots(std::size_t index);
[[nodiscard]] std::string joint_fill(std::size_t index);

/// How strongly something is shaded, from 0 to kDepths - 1: of one colour, so that it is told apart
/// in grey and on dark pages, too.
inline constexpr std::size_t kDepths = 6;
[[nodiscard]] std::string depth_fill(std::size_t depth);

/// The style sheet of all pictures. No `>` in it.
[[nodiscard]] std::string drawing_style();

}  // namespace sweepd
