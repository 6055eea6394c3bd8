#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "daemon/drawing/plot.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/chain/chain_estimate.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

using Series = std::vector<std::pair<double, double>>;
using Eigen::Vector3d;

constexpr double kFigureWidth = 700;

/// What is drawn of the points of a joint: about so many means of neighbours.
constexpr std::size_t kBins = 320;

std::size_t joints_of(const ReportFolder& folder) {
  return list_of(folder.result, "joints").size();
}

const Json& joint_of(const ReportFolder& folder, std::size_t index) {
  static const Json kNone;
  const Json& joints = list_of(folder.result, "joints");
  return index < joints.size() ? joints.at(index) : kNone;
}

/// As report.txt has it; NaN where it is not known.
double error_rms_arcsec(const ReportFolder& folder, std::size_t index) {
  const Json& angles = list_of(part_of(part_of(folder.result, "estimates"), "chain"), "angles");
  return index < angles.size() ? number_of(angles.at(index), "error_rms_arcsec") : std::nan("");
}

/// The angle about the joint's circle, degrees, where the file has no angles; unwrapped.
void fill_in_angles(const ReportFolder& folder, Stroke& stroke) {
  if (stroke.points.empty() || std::isfinite(stroke.points.front().angle)) return;
  const Json& joint = joint_of(folder, stroke.joint);
  if (!part_of(joint, "circle").is_object()) {
    for (StrokePoint& point : stroke.points) point.angle = point.time_s;
    return;
  }
  const Vector3d centre = vector_of(part_of(part_of(joint, "circle"), "center"));
  const Vector3d normal = vector_of(part_of(part_of(joint, "circle"), "normal"));
  const Vector3d u = (stroke.points.front().position_mm - centre).normalized();
  const Vector3d v = normal.cross(u);
  double before = 0;
  for (StrokePoint& point : stroke.points) {
    const Vector3d from = point.position_mm - centre;
    double angle = degrees(std::atan2(v.dot(from), u.dot(from)));
    angle += 360 * std::round((before - angle) / 360);
    point.angle = before = angle;
  }
}

/// A stroke's values over the joint's angle, thinned to means; a gap at the end of each stroke.
template <typename Value>
void append(Series& series, const Stroke& stroke, std::size_t bins, const Value& value) {
  const std::size_t step = std::max<std::size_t>(1, stroke.points.size() / bins);
  for (std::size_t i = 0; i < stroke.points.size(); i += step) {
    double x = 0;
    double y = 0;
    std::size_t count = 0;
    for (std::size_t k = i; k < std::min(i + step, stroke.points.size()); ++k) {
      const double one = value(stroke.points[k]);
      if (!std::isfinite(one) || !std::isfinite(stroke.points[k].angle)) continue;
      x += stroke.points[k].angle;
      y += one;
      ++count;
    }
    if (count > 0)
      series.emplace_back(x / static_cast<double>(count), y / static_cast<double>(count));
  }
  series.emplace_back(kNothing, kNothing);
}

struct Curve {
  Series series;
  double rms = 0;  // of all points, not only of those that are drawn
};

template <typename Value>
Curve curve_of(const std::vector<Stroke>& strokes, double rms, const Value& value) {
  Curve curve{{}, rms};
  const std::size_t bins =
      std::max<std::size_t>(kBins / std::max<std::size_t>(strokes.size(), 1), 2);
  for (const Stroke& stroke : strokes) append(curve.series, stroke, bins, value);
  return curve;
}

void include(Range& x, Range& y, const Curve& curve) {
  for (const auto& [at, value] : curve.series) {
    x.include(at);
    y.include(value);
  }
  y.include(2 * curve.rms);
  y.include(-2 * curve.rms);
}

struct Drawn {
  const Curve* curve;
  std::string kind;
};

void draw_curves(Picture& picture, const Frame& frame, const std::string& title,
                 std::string_view x_title, std::string_view y_title,
                 const std::vector<Drawn>& curves) {
  Range x = Range::nothing();
  Range y = Range::nothing();
  for (const Drawn& drawn : curves) include(x, y, *drawn.curve);
  picture.words({frame.left, frame.top - 5}, title, Anchor::start, "small");
  if (x.empty()) {
    picture.bar(frame, "hollow axis");
    picture.words(frame.middle(), "no such figures in this run", Anchor::middle, "small");
    return;
  }
  Plot plot(picture, frame, {x.widened(0.02), x_title, false, 6},
            {y.widened(0.08), y_title, false, 4});
  plot.level(0, "zero");
  for (const Drawn& drawn : curves) {
    const double band = 2 * drawn.curve->rms;
    if (band > 0) {
      plot.level(band, drawn.kind + " hair");
      plot.level(-band, drawn.kind + " hair");
    }
    plot.line(drawn.curve->series, drawn.kind);
  }
}

using identify::Cause;

constexpr std::array kCauses{Cause::noise, Cause::home, Cause::drift,  Cause::figure, Cause::offset,
                             Cause::print, Cause::sag,  Cause::angles, Cause::height};

double share_of(const Json& row, Cause cause) {
  return number_of(row, std::string(text(cause)));
}

/// "theta3_deg" as "θ₃" is written elsewhere: θ 3.
std::string number_name(const std::string& key) {
  std::string name = key.substr(0, key.find('_'));
  const std::string word = name.substr(0, name.find_first_of("0123456789"));
  for (const auto& of : identify::kDhNumbers)
    if (of.name == word) return std::string(of.symbol) + name.substr(word.size());
  return name;
}

void draw_histogram(Picture& picture, const Frame& frame, const Json& histogram,
                    const std::string& title, double cycle_us) {
  picture.words({frame.left, frame.top - 6}, title, Anchor::start, "strong");
  Range x = Range::nothing();
  double most = 0;
  struct Bin {
    double from, to, count;
  };
  std::vector<Bin> bins;
  for (const Json& bin : list_of(histogram, "histogram")) {
    const double to = std::log10(std::max(number_of(bin, "to_us"), 1e-3));
    const double above = number_of(bin, "above_us");
    const double from = above > 0 ? std::log10(above) : to - 0.3;
    bins.push_back({from, to, number_of(bin, "count")});
    x.include(from);
    x.include(to);
    most = std::max(most, bins.back().count);
  }
  if (bins.empty()) {
    picture.bar(frame, "hollow axis");
    picture.words(frame.middle(), "none in this run", Anchor::middle, "small");
    return;
  }
  if (cycle_us > 0) x.include(std::log10(cycle_us));
  x = {std::floor(x.low), std::ceil(x.high + 0.05)};
  const double top = std::ceil(std::log10(std::max(most, 1.0)) + 0.1);
  Plot plot(picture, frame, {x, "µs", true, 5}, {{-0.3, top}, "telegrams", true, 4});
  for (const Bin& bin : bins) {
    if (bin.count <= 0) continue;
    const Spot corner = plot.spot(bin.from, std::log10(bin.count));
    const Spot foot = plot.spot(bin.to, -0.3);
    plot.inside().bar({corner.x(), corner.y(), foot.x() - corner.x(), foot.y() - corner.y()},
                      joint_fill(0));
  }
  if (cycle_us > 0) {
    plot.mark(std::log10(cycle_us), "limit");
    picture.words(plot.spot(std::log10(cycle_us), top) + Spot(-4, 12), "cycle", Anchor::end,
                  "small");
  }
}

}  // namespace

void add_residual_figures(Markup parent, const ReportFolder& folder) {
  if (folder.strokes.empty()) return;
  auto figure = add_figure(
      parent, "Residuals along each arc.",
      "Left: how far the target stands from where the fit to all sweeps (chain) has it, along the "
      "axis (axial, blue, solid) and away from the axis (radial, red, dashed); of a linear joint "
      "the two directions across its line. Where that fit has none, the distances are those from "
      "the joint's fitted circle. Right: the error of the angle (blue, solid) and that part of it "
      "which repeats (red, dashed). Thin lines are two root mean squares. Where a file has no "
      "angles, the angle is the one about the fitted circle.");
  figure.set("class", "long");
  constexpr double kRow = 138;
  constexpr double kHeight = 84;
  std::vector<std::size_t> joints;
  for (std::size_t j = 0; j < joints_of(folder); ++j)
    if (j < folder.sums.size() &&
        std::any_of(folder.strokes.begin(), folder.strokes.end(),
                    [&](const Stroke& stroke) { return stroke.joint == j; }))
      joints.push_back(j);
  // A picture a joint: a page may end between them.
  for (const std::size_t j : joints) {
    std::vector<Stroke> strokes;
    for (const Stroke& stroke : folder.strokes)
      if (stroke.joint == j) fill_in_angles(folder, strokes.emplace_back(stroke));
    const std::string name = "Joint " + std::to_string(j + 1);
    Picture picture(figure, kFigureWidth + 16, kRow, "residuals of joint " + std::to_string(j + 1));
    const bool linear = is_linear(joint_of(folder, j));
    const char* const x_title = linear ? "place, mm" : "angle, deg";
    const PointSums& sums = folder.sums[j];
    const Curve axial = curve_of(strokes, 1000 * sums.axial_mm.root(),
                                 [](const auto& point) { return 1000 * point.axial_mm; });
    const Curve radial = curve_of(strokes, 1000 * sums.radial_mm.root(),
                                  [](const auto& point) { return 1000 * point.radial_mm; });
    const Curve error = curve_of(strokes, sums.along_arcsec.root(),
                                 [](const auto& point) { return point.along_arcsec; });
    const double error_arcsec = error_rms_arcsec(folder, j);
    const Curve curve = curve_of(strokes, 0, [](const auto& point) { return point.curve_arcsec; });
    draw_curves(
        picture, {56, 16, 280, kHeight},
        name + ": rms axial " + fixed(axial.rms, 2) + ", radial " + fixed(radial.rms, 2) + " µm",
        x_title, "µm", {{&axial, joint_line(0)}, {&radial, joint_line(1)}});
    draw_curves(picture, {412, 16, 280, kHeight},
                name + (std::isfinite(error_arcsec)
                            ? ": rms of the angle's error " + fixed(error_arcsec, 2) + " arcsec"
                            : ": error of the angle"),
                x_title, "arcsec", {{&error, joint_line(0)}, {&curve, joint_line(1)}});
  }
}

void add_budget_figure(Markup parent, const ReportFolder& folder) {
  const Json& budget = list_of(folder.result, "uncertainty_budget");
  if (budget.empty()) return;
  auto figure = add_figure(parent, "What the uncertainties come from.",
                           "Shares of the causes in each number's variance, per cent.");
  constexpr double kBar = 11;
  constexpr std::size_t kDarkCauses = 3;  // of the fills
  constexpr double kLeft = 40;
  std::vector<std::size_t> causes;
  for (std::size_t c = 0; c < kCauses.size(); ++c)
    if (std::any_of(budget.begin(), budget.end(),
                    [&](const Json& row) { return share_of(row, kCauses[c]) > 0; }))
      causes.push_back(c);
  const double rows = static_cast<double>(budget.size());
  const double keys = 16 * std::ceil(static_cast<double>(causes.size()) / 3) + 8;
  Picture picture(figure, kFigureWidth, keys + rows * (kBar + 3) + 34,
                  "budget of the uncertainties");
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const Spot at(kLeft + 220 * static_cast<double>(i % 3),
                  4 + 16 * std::floor(static_cast<double>(i) / 3));
    picture.bar({at.x(), at.y(), 12, 10}, joint_fill(i));
    picture.words(at + Spot(17, 9), words(kCauses[causes[i]]));
  }
  const Frame frame{kLeft, keys, kFigureWidth - kLeft - 20, rows * (kBar + 3) + 2};
  Plot plot(picture, frame, {{0, 100}, "share of the variance, %", false, 10},
            {{0, 1}, {}, false, 0});
  double y = keys + 2;
  for (const Json& row : budget) {
    picture.words({kLeft - 6, y + 9}, number_name(text_of(row, "number")), Anchor::end, "small");
    double x = 0;
    for (std::size_t i = 0; i < causes.size(); ++i) {
      const double share = 100 * share_of(row, kCauses[causes[i]]);
      if (!(share > 0)) continue;
      const double left = plot.spot(x, 0).x();
      const double right = plot.spot(x + share, 0).x();
      picture.bar({left, y, right - left, kBar}, joint_fill(i));
      if (share > 8 && causes.size() > 1)
        picture.words({(left + right) / 2, y + 9}, fixed(share, 0), Anchor::middle,
                      "small " + std::string(i < kDarkCauses ? "light" : "dark"));
      x += share;
    }
    y += kBar + 3;
  }
}

void add_link_figure(Markup parent, const ReportFolder& folder) {
  if (!folder.link.is_object()) return;
  const double cycle_us = 1000 * number_of(folder.link, "cycle_ms");
  auto figure = add_figure(parent, "The link.",
                           "How long replies took, and how far telegrams came from their cycle. "
                           "Both axes are logarithmic.");
  Picture picture(figure, kFigureWidth + 16, 190, "latency and jitter");
  draw_histogram(picture, {56, 20, 280, 130}, part_of(folder.link, "latency"),
                 "Latency of the replies", cycle_us);
  draw_histogram(picture, {412, 20, 280, 130}, part_of(folder.link, "jitter"),
                 "Jitter of the telegrams", cycle_us);
}

void add_time_figure(Markup parent, const ReportFolder& folder) {
  Range time = Range::nothing();
  const Json joints = list_of(folder.result, "joints");
  for (const Json& joint : joints)
    for (const Json& sweep : list_of(joint, "sweeps")) {
      time.include(number_of(sweep, "start_s"));
      time.include(number_of(sweep, "end_s"));
    }
  if (time.empty() || !(time.size() > 0)) return;
  auto figure = add_figure(parent, "Sweeps on a time line.",
                           "Filled: used for the circles. Hollow: positioning moves, and sweeps "
                           "that are not used there.");
  constexpr double kLane = 20;
  constexpr double kLeft = 40;
  const Frame frame{kLeft, 6, kFigureWidth - kLeft - 20,
                    kLane * static_cast<double>(joints.size())};
  Picture picture(figure, kFigureWidth, frame.bottom() + 36, "sweeps of each joint over time");
  Plot plot(picture, frame, {time.widened(0.01), "s", false, 10}, {{0, 1}, {}, false, 0});
  double y = frame.top;
  for (std::size_t j = 0; j < joints.size(); ++j, y += kLane) {
    picture.words({kLeft - 6, y + 14}, "A" + std::to_string(j + 1), Anchor::end);
    for (const Json& sweep : list_of(joints[j], "sweeps")) {
      const double from = plot.spot(number_of(sweep, "start_s"), 0).x();
      const double to = plot.spot(number_of(sweep, "end_s"), 0).x();
      if (!std::isfinite(from) || !std::isfinite(to)) continue;
      plot.inside().bar({from, y + 4, std::max(to - from, 1.0), kLane - 8},
                        flag_of(sweep, "used") ? joint_fill(j) : "hollow");
    }
  }
}

}  // namespace sweepd
