#include "identify/dh/base_height.hpp"

#include <algorithm>
#include <cmath>

#include "identify/dh/placed_axes.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;
using Axes = std::vector<std::optional<Axis>>;

/// The base stands within so much of the height at which it is taken.
constexpr double kMostAside_mm = 1000;
/// What so much changes by less than this (mm, rad) does not hang on it.
constexpr double kNoChange = 1e-6;
constexpr double kHeightStep_mm = 10;
/// A b that goes along with the height does so mm by mm.
constexpr double kWithHeight = 0.5;
/// Where that b is as wanted, but for rounding, it gives the height.
constexpr double kAtHeight_mm = 1e-3;

/// Axes without a gap between them, from the first one to before the end.
struct Stretch {
  std::size_t first = 0;
  std::size_t end = 0;
};

std::vector<Stretch> stretches_of(const Axes& z) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (!z[i]) continue;
    if (i == 0 || !z[i - 1]) stretches.push_back({i, i});
    stretches.back().end = i + 1;
  }
  return stretches;
}

double wanted_mm(const std::vector<DhRow>& specified, std::size_t row) {
  return specified.empty() ? 0 : specified[row].b_mm;
}

Vector3d upwards(const Axes& z, const Stretch& of) {
  return z[of.first]->line().direction;
}

/// With the origin so much higher.
Axes lowered(Axes z, const Stretch& of, double by_mm) {
  const Vector3d by = by_mm * upwards(z, of);
  for (std::size_t i = of.first; i < of.end; ++i) z[i]->point_mm -= by;
  return z;
}

/// What each number (b, theta, a, alpha, beta of each row) gains with a mm of height.
class Slopes {
 public:
  Slopes(const Axes& z, const Stretch& of, double size_mm, const std::vector<DhRow>& specified)
      : of_(of),
        above_(placed_table(lowered(z, of, kHeightStep_mm), specified, size_mm)),
        below_(placed_table(lowered(z, of, -kHeightStep_mm), specified, size_mm)) {}

  [[nodiscard]] double at(std::size_t row, const DhNumberName& of) const {
    const double change = (above_[row].*of.number).value - (below_[row].*of.number).value;
    return (of.length ? change : wrapped(change)) / (2 * kHeightStep_mm);
  }

  /// Where the base stands, and how the first X lies, is not the arm's.
  [[nodiscard]] bool hangs(const std::vector<DhEstimate>& table, std::size_t row,
                           const DhNumberName& of) const {
    if (row == of_.first && (of.number == &DhEstimate::b_mm || of.number == &DhEstimate::theta_rad))
      return false;
    const DhNumber& number = table[row].*of.number;
    return is_placed(table[row], of) &&
           std::abs(at(row, of)) * kMostAside_mm > std::max(number.sigma, kNoChange);
  }

  [[nodiscard]] bool any_hangs(const std::vector<DhEstimate>& table) const {
    for (std::size_t row = of_.first; row < of_.end; ++row)
      for (const DhNumberName& of : kDhNumbers)
        if (hangs(table, row, of)) return true;
    return false;
  }

  /// The row whose b goes along with the height.
  [[nodiscard]] std::optional<std::size_t> gives_height(
      const std::vector<DhEstimate>& table) const {
    for (std::size_t row = of_.first + 1; row < of_.end; ++row)
      if (is_placed(table[row], kDhNumbers[0]) && std::abs(at(row, kDhNumbers[0])) > kWithHeight)
        return row;
    return std::nullopt;
  }

 private:
  /// b of a linear joint is by convention, since its axis has no place, and is one all the same.
  [[nodiscard]] static bool is_placed(const DhEstimate& row, const DhNumberName& of) {
    return (row.*of.number).knowledge == Knowledge::identified ||
           (row.linear && of.number == &DhEstimate::b_mm);
  }

  Stretch of_;
  std::vector<DhEstimate> above_, below_;
};

}  // namespace

Axes seen_from_base(Axes z, double size_mm, const std::vector<DhRow>& specified) {
  if (!z.empty() && z.front()) z.front()->x_is_free = true;
  for (const Stretch& of : stretches_of(z)) {
    if (!Slopes(z, of, size_mm, specified).any_hangs(placed_table(z, specified, size_mm))) continue;
    z = lowered(z, of, upwards(z, of).dot(z[of.first]->point_mm));
    for (int round = 0; round < 2; ++round) {  // the second takes away what the tilt leaves
      const auto table = placed_table(z, specified, size_mm);
      const Slopes slopes(z, of, size_mm, specified);
      const auto row = slopes.gives_height(table);
      if (!row) break;
      z = lowered(
          z, of,
          (wanted_mm(specified, *row) - table[*row].b_mm.value) / slopes.at(*row, kDhNumbers[0]));
    }
  }
  return z;
}

void leave_to_height(std::vector<DhEstimate>& table, const Axes& z, double size_mm,
                     const std::vector<DhRow>& specified) {
  const auto set = [](DhNumber& number) { number = {number.value, 0, Knowledge::by_convention}; };
  for (const Stretch& of : stretches_of(z)) {
    const Slopes slopes(z, of, size_mm, specified);
    const auto row = slopes.gives_height(table);
    if (row && std::abs(table[*row].b_mm.value - wanted_mm(specified, *row)) < kAtHeight_mm) {
      set(table[*row].b_mm);
      continue;
    }
    for (std::size_t i = of.first; i < of.end; ++i)
      for (const DhNumberName& of_row : kDhNumbers)
        if (slopes.hangs(table, i, of_row)) set(table[i].*of_row.number);
  }
}

std::string change_with_height(const std::vector<DhEstimate>& table, std::size_t row) {
  double off = 0;
  for (; row + 1 < table.size() && table[row].relation == Relation::parallel; ++row)
    off = std::max(off, std::hypot(std::remainder(table[row].alpha_rad.value, kPi),
                                   table[row].beta_rad.value));
  if (1000 * std::tan(off) < kNoChange)
    return "No height changes them, since the axes are exactly parallel";
  return "They change by up to " + brief(1000 * std::tan(off)) +
         " mm for each metre along the axes, which are " + brief(off / kDegree) + "° off parallel";
}

}  // namespace identify
