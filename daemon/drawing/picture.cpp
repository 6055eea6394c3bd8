#include "daemon/drawing/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/text/numbers.hpp"

namespace sweepd {
namespace {

constexpr double kTold_px = 0.4;  // what is closer is one spot
constexpr double kHead_px = 7;

/// Two decimals, none that say nothing.
void append_px(std::string& text, double value) {
  append_fixed(text, value, 2);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
}

std::string px(double value) {
  std::string text;
  append_px(text, value);
  return text;
}

void append_px(std::string& text, const Spot& spot) {
  append_px(text, spot.x());
  text += ' ';
  append_px(text, spot.y());
}

struct Look {
  std::string_view colour;
  std::string_view dash;
};

/// Okabe and Ito, Color Universal Design (2008), without their yellow, which white paper swallows.
// Behind the seventh the colours come again, with other dashes.
constexpr std::array<Look, 12> kLooks{{{"#0072b2", "none"},
                                       {"#d55e00", "7 3"},
                                       {"#009e73", "2 2"},
                                       {"#cc79a7", "9 3 2 3"},
                                       {"#e69f00", "12 4"},
                                       {"#56b4e9", "4 2 1 2"},
                                       {"#7f7f7f", "1 3"},
                                       {"#0072b2", "2 4 8 4"},
                                       {"#d55e00", "1 2"},
                                       {"#009e73", "14 3 2 3 2 3"},
                                       {"#cc79a7", "4 6"},
                                       {"#e69f00", "3 3 9 3 3 6"}}};

std::string look(char letter, std::size_t index) {
  return letter + std::to_string(index % kLooks.size() + 1);
}

}  // namespace

Frame Frame::within(double room) const {
  return {left + room, top + room, width - 2 * room, height - 2 * room};
}

bool Frame::holds(const Spot& spot) const {
  return spot.x() >= left && spot.x() <= right() && spot.y() >= top && spot.y() <= bottom();
}

Picture::Picture(Markup parent, double width, double height, std::string_view what)
    : svg_(parent.add("svg", {{"xmlns", "http://www.w3.org/2000/svg"},
                              {"viewBox", "0 0 " + px(width) + " " + px(height)},
                              {"width", px(width)},
                              {"role", "img"},
                              {"aria-label", what}})) {}

void Picture::line(const Spot& from, const Spot& to, std::string_view kind) {
  svg_.add("line", {{"x1", px(from.x())},
                    {"y1", px(from.y())},
                    {"x2", px(to.x())},
                    {"y2", px(to.y())},
                    {"class", kind}});
}

void Picture::path(std::span<const Spot> spots, std::string_view kind, bool closed) {
  std::string way;
  bool begun = false;
  Spot before(0, 0);
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const Spot& spot = spots[i];
    if (!spot.allFinite()) {
      begun = false;
      continue;
    }
    const bool last = i + 1 == spots.size() || !spots[i + 1].allFinite();
    if (begun && !last && (spot - before).norm() < kTold_px) continue;
    way += begun ? "L" : "M";
    append_px(way, spot);
    begun = true;
    before = spot;
  }
  if (way.empty()) return;
  if (closed) way += "Z";
  svg_.add("path", {{"d", way}, {"class", kind}});
}

void Picture::dots(std::span<const Spot> spots, std::string_view kind) {
  std::string way;
  std::set<std::pair<long, long>> taken;
  for (const Spot& spot : spots) {
    if (!spot.allFinite()) continue;
    const Spot cell = spot / (2 * kTold_px);
    if (!taken.emplace(std::lround(cell.x()), std::lround(cell.y())).second) continue;
    way += "M";
    append_px(way, spot);
    way += "h0";
  }
  if (!way.empty()) svg_.add("path", {{"d", way}, {"class", kind}});
}

void Picture::bar(const Frame& bar, std::string_view kind) {
  svg_.add("rect", {{"x", px(bar.left)},
                    {"y", px(bar.top)},
                    {"width", px(bar.width)},
                    {"height", px(bar.height)},
                    {"class", kind}});
}

void Picture::circle(const Spot& middle, double radius, std::string_view kind) {
  svg_.add("circle",
           {{"cx", px(middle.x())}, {"cy", px(middle.y())}, {"r", px(radius)}, {"class", kind}});
}

void Picture::arrow(const Spot& from, const Spot& to, std::string_view kind) {
  line(from, to, kind);
  const double length = (to - from).norm();
  if (!(length > 1.2 * kHead_px)) return;
  const Spot along = (to - from) / length;
  const Spot across(-along.y(), along.x());
  const std::array<Spot, 3> head{to - kHead_px * along + 0.4 * kHead_px * across, to,
                                 to - kHead_px * along - 0.4 * kHead_px * across};
  path(head, std::string(kind) + " whole");
}

void Picture::words(const Spot& at, std::string_view text, Anchor anchor, std::string_view kind) {
  const char* const side = anchor == Anchor::start    ? "start"
                           : anchor == Anchor::middle ? "middle"
                                                      : "end";
  auto words = svg_.add("text", {{"x", px(at.x())}, {"y", px(at.y())}, {"text-anchor", side}});
  if (!kind.empty()) words.set("class", kind);
  words.text(text);
}

void Picture::words_upwards(const Spot& at, std::string_view text) {
  svg_.add("text", {{"transform", "translate(" + px(at.x()) + " " + px(at.y()) + ") rotate(-90)"},
                    {"text-anchor", "middle"}})
      .text(text);
}

Picture Picture::inside(const Frame& frame) {
  auto cut = svg_.add("svg", {{"x", px(frame.left)},
                              {"y", px(frame.top)},
                              {"width", px(frame.width)},
                              {"height", px(frame.height)},
                              {"viewBox", px(frame.left) + " " + px(frame.top) + " " +
                                              px(frame.width) + " " + px(frame.height)}});
  return Picture(cut);
}

std::string joint_line(std::size_t index) {
  return look('l', index);
}
std::string joint_dots(std::size_t index) {
  return look('d', index);
}
std::string joint_fill(std::size_t index) {
  return look('f', index);
}

std::string depth_fill(std::size_t depth) {
  return "depth" + std::to_string(std::min(depth, kDepths - 1));
}

std::string drawing_style() {
  std::string css =
      "svg{max-width:100%;height:auto;font:11px sans-serif;overflow:visible}"
      "svg svg{overflow:hidden}"
      "text{fill:currentColor;stroke:none}"
      ".small{font-size:9px}.strong{font-weight:bold}"
      "line,path{fill:none;stroke:currentColor;stroke-width:1}"
      ".axis{stroke-width:.8}.grid{stroke-width:.5;opacity:.25}"
      ".zero{stroke-width:.8;opacity:.7}.limit{stroke-dasharray:5 3;opacity:.7}"
      ".hair{stroke-width:.7;opacity:.55}.arm{stroke-width:5;opacity:.3;"
      "stroke-linecap:round;stroke-linejoin:round}"
      "rect{stroke:currentColor;stroke-width:.5}.hollow{fill:none;stroke-width:1}"
      ".plain{fill:currentColor;stroke:none}"
      "circle{fill:currentColor;stroke:none}circle.hollow{fill:none;stroke:currentColor}";
  for (std::size_t i = 0; i < kLooks.size(); ++i) {
    css += fmt::format(
        ".{0}{{stroke:{3};stroke-width:1.3;stroke-dasharray:{4}}}.{1}{{stroke:{3};"
        "stroke-width:3.2;stroke-linecap:round}}.{2}{{fill:{3}}}",
        look('l', i), look('d', i), look('f', i), kLooks[i].colour, kLooks[i].dash);
  }
  for (std::size_t depth = 0; depth < kDepths; ++depth)
    css += ".depth" + std::to_string(depth) + "{fill:#0072b2;stroke:none;fill-opacity:" +
           px(0.12 + 0.88 * static_cast<double>(depth) / (kDepths - 1)) + "}";
  return css +
         ".light{fill:#fff}.dark{fill:#000}.whole{"
         "stroke-dasharray:none}"
         ".hair{stroke-width:.7}";
}

}  // namespace sweepd
