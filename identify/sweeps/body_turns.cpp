#include "identify/sweeps/body_turns.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

/// Axes of one joint as two targets see them, beside their uncertainties.
constexpr double kAlike_rad = 0.2 * kDegree;
constexpr double kAlike_mm = 1;
constexpr double kSigmas = 3;

bool one_axis(const Axis& first, const Axis& second) {
  const double unsure_rad =
      kSigmas * std::hypot(first.direction_sigma_rad(), second.direction_sigma_rad());
  const double sine = first.direction.cross(second.direction).norm();
  if (std::asin(std::min(1.0, sine)) > kAlike_rad + unsure_rad) return false;
  const Eigen::Vector3d between = second.point_mm - first.point_mm;
  const double along_mm = std::abs(first.direction.dot(between));
  return first.direction.cross(between).norm() <=
         kAlike_mm + kSigmas * std::hypot(first.point_sigma_mm(), second.point_sigma_mm()) +
             (kAlike_rad + unsure_rad) * along_mm;
}

/// By how much two spans overlap; negative: how far they are apart.
double overlap_s(const Sweep& first, const Sweep& second) {
  return std::min(first.last().time_s, second.last().time_s) -
         std::max(first.first().time_s, second.first().time_s);
}

double seconds(const Sweep& sweep) {
  return sweep.last().time_s - sweep.first().time_s;
}

}  // namespace

BodyTurns::BodyTurns(const std::vector<Sweep>& strokes, std::size_t joints) : strokes_(strokes) {
  std::map<std::size_t, std::vector<std::size_t>> targets;
  for (std::size_t s = 0; s < strokes.size(); ++s)
    if (!strokes[s].joint) targets[strokes[s].target].push_back(s);
  std::vector<std::vector<Turn>> parts;  // one a target
  for (const auto& [target, places] : targets) {
    auto turns = turns_in(strokes, places, joints);
    if (turns.size() < joints) {
      parts.push_back(std::move(turns));
      continue;
    }
    add(turns, false);
    to_tell_.push_back(std::move(turns));
  }
  if (to_tell_.empty() && parts.size() > 1) {
    for (const auto& turns : parts) add(turns, false);
    to_tell_.push_back(together());
    return;
  }
  const bool any_whole = !to_tell_.empty();
  for (auto& turns : parts)
    if (!any_whole || !add(turns, true)) to_tell_.push_back(std::move(turns));
}

double BodyTurns::end_s(const Turn& turn) const {
  return strokes_[turn.strokes.back().place].last().time_s;
}

bool BodyTurns::run_at_once(const Turn& first, const Turn& second) const {
  for (const Turn::Stroke& one : first.strokes)
    for (const Turn::Stroke& other : second.strokes) {
      const Sweep &a = strokes_[one.place], &b = strokes_[other.place];
      if (2 * overlap_s(a, b) > std::min(seconds(a), seconds(b))) return true;
    }
  return false;
}

const BodyTurns::Members* BodyTurns::seen_by_others(const Turn& turn) const {
  // Two joints may have one axis: the one counts that moved at the same time, else the nearest.
  const Members* nearest = nullptr;
  double least_s = std::numeric_limits<double>::infinity();
  for (const Members& members : turns_) {
    const auto is_same = [&](const Turn& other) { return one_axis(other.axis, turn.axis); };
    if (!std::all_of(members.begin(), members.end(), is_same)) continue;
    double apart_s = std::numeric_limits<double>::infinity();
    for (const Turn& other : members)
      apart_s = run_at_once(other, turn)
                    ? -1
                    : std::min(apart_s, std::max(other.begin_s() - end_s(turn),
                                                 turn.begin_s() - end_s(other)));
    if (apart_s >= least_s) continue;
    least_s = apart_s;
    nearest = &members;
  }
  return nearest;
}

bool BodyTurns::add(const std::vector<Turn>& turns, bool seen_before) {
  std::vector<const Members*> seen;
  seen.reserve(turns.size());
  for (const Turn& turn : turns) seen.push_back(seen_by_others(turn));
  if (seen_before && std::find(seen.begin(), seen.end(), nullptr) != seen.end()) return false;
  const Members* const first = turns_.data();
  std::vector<Members> own;
  for (std::size_t t = 0; t < turns.size(); ++t)
    if (seen[t] != nullptr)
      turns_[static_cast<std::size_t>(seen[t] - first)].push_back(turns[t]);
    else
      own.push_back({turns[t]});
  std::move(own.begin(), own.end(), std::back_inserter(turns_));
  return true;
}

std::vector<Turn> BodyTurns::together() const {
  std::vector<Turn> all;
  for (const Members& members : turns_) {
    const auto best =
        std::min_element(members.begin(), members.end(), [](const Turn& a, const Turn& b) {
          return a.axis.direction_sigma_rad() < b.axis.direction_sigma_rad();
        });
    Turn turn = *best;
    for (const Turn& other : members)
      for (Turn::Stroke stroke : other.strokes) {
        const Sweep& sweep = strokes_[stroke.place];
        if (std::any_of(turn.strokes.begin(), turn.strokes.end(), [&](const Turn::Stroke& taken) {
              return overlap_s(strokes_[taken.place], sweep) > 0;
            }))
          continue;
        if (other.axis.direction.dot(turn.axis.direction) < 0) stroke.angle_rad *= -1;
        stroke.gap_rad.reset();
        stroke.goes_on = false;
        turn.strokes.push_back(stroke);
      }
    std::sort(turn.strokes.begin(), turn.strokes.end(),
              [&](const Turn::Stroke& a, const Turn::Stroke& b) { return a.begin_s < b.begin_s; });
    all.push_back(std::move(turn));
  }
  std::stable_sort(all.begin(), all.end(),
                   [&](const Turn& a, const Turn& b) { return a.begin_s() < b.begin_s(); });
  return all;
}

void BodyTurns::spread(std::vector<Sweep>& strokes) const {
  for (const Members& members : turns_) {
    struct Known {
      std::size_t place;
      std::size_t joint;
      double sense;  // about the first member's axis
    };
    const auto way = [&](const Turn& turn, const Turn::Stroke& stroke) {
      return turn.axis.direction.dot(members.front().axis.direction) < 0 ? -stroke.angle_rad
                                                                         : stroke.angle_rad;
    };
    std::vector<Known> known;
    for (const Turn& turn : members)
      for (const Turn::Stroke& stroke : turn.strokes)
        if (const Sweep& sweep = strokes[stroke.place]; sweep.joint)
          known.push_back({stroke.place, *sweep.joint, sweep.direction * way(turn, stroke)});
    if (known.empty()) continue;
    for (const Turn& turn : members)
      for (const Turn::Stroke& stroke : turn.strokes) {
        Sweep& sweep = strokes[stroke.place];
        if (sweep.joint) continue;
        const auto nearest =
            std::max_element(known.begin(), known.end(), [&](const Known& a, const Known& b) {
              return overlap_s(strokes[a.place], sweep) < overlap_s(strokes[b.place], sweep);
            });
        sweep.joint = nearest->joint;
        sweep.direction = nearest->sense * way(turn, stroke) < 0 ? -1 : 1;
      }
  }
}

std::optional<std::string> moves_on_no_circle(const std::vector<Sweep>& strokes) {
  std::size_t moves = 0;
  double longest_s = 0;
  for (const Sweep& stroke : strokes) {
    if (stroke.joint || stroke.defect != SweepDefect::not_an_arc) continue;
    ++moves;
    longest_s = std::max(longest_s, seconds(stroke));
  }
  if (moves == 0) return std::nullopt;
  const bool one = moves == 1;
  return std::to_string(moves) +
         (one ? " move of the target, of " : " moves of the target, of up to ") +
         fixed(longest_s, 1) +
         (one ? " s, is on no circle, and tells no axis"
              : " s, are on no circle, and tell no axis") +
         ": several joints moved at once, or sweeps followed each other without a stop between "
         "them, as where a KRL program blends its motions (C_PTP, C_DIS): let the robot stop "
         "exactly at the end of each sweep and rest for half a second, or send joint angles "
         "(AIPos)";
}

}  // namespace identify
