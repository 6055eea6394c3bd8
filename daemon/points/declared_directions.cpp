#include "daemon/points/declared_directions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "daemon/text/units.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {

using identify::Sweep;
using identify::SweepDefect;

namespace {

/// Squared departure from a declared stroke that no stroke of its has.
constexpr double kNoMatch = 100;

/// How far strokes, turned by these angles one after the other, are from the declared ones, which
/// may have been repeated: the mean square, in what planned arcs may be off by.
double misfit(const std::vector<double>& seen_rad, double sense,
              const std::vector<double>& declared_rad) {
  if (declared_rad.empty()) return kNoMatch;
  double sum = 0;
  for (std::size_t i = 0; i < seen_rad.size(); ++i) {
    const double declared = declared_rad[i % declared_rad.size()];
    const double off = (sense * seen_rad[i] - declared) / (radians(1) + 0.05 * std::abs(declared));
    sum += std::min(off * off, kNoMatch);
  }
  return sum / static_cast<double>(seen_rad.size());
}

/// Ways to write down what the plan has for a joint, stroke by stroke: the sweeps alone, each of
/// them there and back, or also the ways from home and to it.
using Styles = std::array<std::vector<double>, 3>;

/// One joint's strokes of one target, and what the plan has for the joint.
struct Declared {
  std::vector<Sweep*> strokes;
  std::vector<double> seen_rad;
  Styles styles;
};

/// Whether the joint's angle rises about the normal from which the strokes are counted (+1), falls
/// (-1), or nothing tells (0).
int sense_of(double rises, double falls) {
  if (std::min(rises, falls) > kNoMatch / 4 || std::abs(rises - falls) < 1) return 0;
  return rises < falls ? 1 : -1;
}

/// Where one joint's strokes may be of either sense, in one style or the other, those styles count
/// that explain all joints best.
int declared_sense(const Declared& turn, const std::vector<std::size_t>& likely) {
  const auto as = [&](double sense, std::size_t style) {
    return misfit(turn.seen_rad, sense, turn.styles[style]);
  };
  const auto least = [&](double sense) {
    return std::min({as(sense, 0), as(sense, 1), as(sense, 2)});
  };
  if (const int sense = sense_of(least(1), least(-1)); sense != 0) return sense;
  std::optional<int> told;
  for (const std::size_t style : likely) {
    const int sense = sense_of(as(1, style), as(-1, style));
    if (told && *told != sense) return 0;
    told = sense;
  }
  return told.value_or(0);
}

/// The styles that explain all joints as well as the best one does.
std::vector<std::size_t> likely_styles(const std::vector<Declared>& turns) {
  std::array<double, 3> sums{};
  for (const Declared& turn : turns)
    for (std::size_t style = 0; style < sums.size(); ++style)
      sums[style] += std::min(misfit(turn.seen_rad, 1, turn.styles[style]),
                              misfit(turn.seen_rad, -1, turn.styles[style]));
  const double least = *std::min_element(sums.begin(), sums.end());
  std::vector<std::size_t> likely;
  for (std::size_t style = 0; style < sums.size(); ++style)
    if (sums[style] < least + 1) likely.push_back(style);
  return likely;
}

}  // namespace

void declare_directions(std::vector<Sweep>& sweeps, const SweepPlan& plan,
                        const std::vector<identify::DeclaredJoint>& order) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Sweep*>> turns;  // by joint and target
  for (Sweep& sweep : sweeps)
    if (sweep.joint && sweep.direction == 0 && sweep.defect == SweepDefect::none)
      turns[{*sweep.joint, sweep.target}].push_back(&sweep);
  std::vector<Declared> all;
  for (const auto& [which, strokes] : turns) {
    const std::size_t joint = which.first;
    Declared turn{strokes, {}, {}};
    auto& [sweeps_alone, there_and_back, whole] = turn.styles;
    std::size_t ways = 0;  // before the first sweep
    for (const PlannedSweep& sweep : plan.sweeps) {
      if (sweep.joint != joint + 1) continue;
      for (const PlannedMove& move : moves_of(plan, sweep)) {
        if (!move.measures) {
          if (sweeps_alone.empty() && move.to_deg != move.from_deg) ++ways;
          continue;
        }
        sweeps_alone.push_back(radians(move.to_deg - move.from_deg));
        there_and_back.push_back(sweeps_alone.back());
        there_and_back.push_back(-sweeps_alone.back());
      }
    }
    for (const auto& declared : order)
      if (declared.joint == joint)
        whole.insert(whole.end(), declared.strokes_rad.begin(), declared.strokes_rad.end());
    std::optional<Eigen::Vector3d> normal;
    for (const Sweep* stroke : strokes) {
      const auto circle = identify::fit_circle(identify::positions(*stroke->samples));
      if (!circle) continue;
      if (!normal) normal = circle->normal;
      turn.seen_rad.push_back(circle->normal.dot(*normal) > 0 ? circle->arc_rad : -circle->arc_rad);
    }
    // Who wrote down the way to a sweep wrote down the sweep, too.
    if (turn.seen_rad.size() <= ways) whole.clear();
    if (turn.seen_rad.size() == strokes.size()) all.push_back(std::move(turn));
  }
  const auto likely = likely_styles(all);
  for (const Declared& turn : all) {
    const int sense = declared_sense(turn, likely);
    for (std::size_t i = 0; i < turn.strokes.size(); ++i)
      turn.strokes[i]->direction = turn.seen_rad[i] > 0 ? sense : -sense;
  }
}

}  // namespace sweepd
