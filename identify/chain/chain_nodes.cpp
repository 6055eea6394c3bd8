#include "identify/chain/chain_nodes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <unordered_set>
#include <utility>

#include <Eigen/Geometry>

#include "identify/chain/chain_start.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/sweeps/home.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// The node's mean sample. `home_rad`: of joints that are in the chain.
ChainObservation mean_at(const StrokeMoments& stroke, const StrokeMoments::Node& node,
                         const std::vector<std::optional<double>>& home_rad) {
  ChainObservation seen;
  seen.joint = stroke.content.joint;
  seen.target = stroke.target;
  seen.falling = stroke.falling;
  seen.weight = node.sums(0, 0);
  const Index errors = stroke.content.orientation ? 6 : 3;
  VectorXd mean = VectorXd::Zero(node.sums.rows());
  if (seen.weight > 0) mean = node.sums.col(0) / seen.weight;
  const Matrix3d directions = stroke.directions(node.turn_rad);
  // Along the arc, not along its tangent.
  const double ahead = mean(3) / stroke.circle.radius_mm;
  const double told = node.turn_rad - (stroke.about ? stroke.sense * ahead : 0);
  seen.position_mm = stroke.place(node.turn_rad, {mean(1), mean(2), stroke.about ? 0.0 : mean(3)});
  if (errors == 6) {
    const Vector3d off = directions.transpose() * mean.segment<3>(4);
    const Matrix3d reference = stroke.turned(told - stroke.zero_rad) * stroke.orientation;
    seen.orientation = Eigen::AngleAxisd(off.norm(), off.stableNormalized()) * reference;
  }
  for (std::size_t k = 0; k < stroke.content.joints; ++k)
    if (home_rad[k])
      seen.turns[k] =
          stroke.locked_rad[k] + mean(1 + errors + static_cast<Index>(k)) - *home_rad[k];
  if (stroke.told && home_rad[seen.joint]) seen.turns[seen.joint] = told - *home_rad[seen.joint];
  seen.measured_turn = seen.turns[seen.joint];
  return seen;
}

/// Whether the strokes were seen at once.
bool together(const StrokeMoments& one, const StrokeMoments& other) {
  const double both = std::min(one.end_s, other.end_s) - std::max(one.begin_s, other.begin_s);
  const double shorter = std::min(one.end_s - one.begin_s, other.end_s - other.begin_s);
  return one.content.joint == other.content.joint && one.target != other.target &&
         one.squares == other.squares && both > shorter / 2;
}

/// Sorts the units by what swept in between. Returns whether they follow each other at all.
bool set_stands(ChainNodes& nodes) {
  const std::vector<std::size_t> in_time = nodes.in_time();
  nodes.stand.resize(in_time.size());
  double end_s = 0;  // of all before
  bool in_turn = in_time.size() > 1;
  for (std::size_t i = 0; i < in_time.size(); ++i) {
    const std::size_t unit = in_time[i], group = nodes.group[unit];
    // Where times begin anew with each sweep, nothing tells what follows what.
    const bool after = i > 0 && nodes.begin_s(unit) >= end_s;
    const bool follows = after && nodes.group[in_time[i - 1]] == group;
    if (i > 0 && !after) in_turn = false;
    if (!follows) nodes.group_of.push_back(group);
    nodes.stand[unit] = nodes.group_of.size() - 1;
    for (const std::size_t s : nodes.units[unit]) end_s = std::max(end_s, nodes.strokes[s].end_s);
  }
  return in_turn;
}

/// Sorts the units by what each joint has rested through.
void set_rests(ChainNodes& nodes) {
  nodes.rests.resize(nodes.homes.size());
  nodes.rest_of.resize(nodes.units.size());
  std::array<std::optional<std::size_t>, kMostJoints> now;
  std::size_t last_home = 0;
  for (const std::size_t unit : nodes.in_time()) {
    const std::size_t home = nodes.home_of[nodes.group[unit]];
    if (home != last_home) now.fill(std::nullopt);
    last_home = home;
    const std::size_t swept = nodes.strokes[nodes.units[unit].front()].content.joint;
    now[swept] = std::nullopt;
    for (std::size_t k = 0; k < nodes.known.size(); ++k) {
      if (k == swept || !nodes.known[k]) continue;
      if (!now[k]) {
        now[k] = nodes.rests[home].size();
        nodes.rests[home].push_back(k);
      }
    }
    nodes.rest_of[unit] = now;
  }
}

/// Sets when each node was seen. Of strokes' sums nobody knows it.
void set_times(ChainNodes& nodes, bool in_turn) {
  const double seconds = nodes.seconds();
  nodes.timed = in_turn && seconds > 0 &&
                std::all_of(nodes.strokes.begin(), nodes.strokes.end(),
                            [](const StrokeMoments& stroke) { return stroke.squares; });
  if (!nodes.timed) return;
  double begin_s = std::numeric_limits<double>::infinity();
  for (const StrokeMoments& stroke : nodes.strokes) begin_s = std::min(begin_s, stroke.begin_s);
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    const StrokeMoments& stroke = nodes.strokes[s];
    for (std::size_t n = 0; n < stroke.nodes.size(); ++n)
      nodes.observations[nodes.first[s] + n].times =
          drift_times(2 * (stroke.time_s(stroke.nodes[n].turn_rad) - begin_s) / seconds - 1);
  }
}

/// Sorts the strokes by what was seen at once, and by where their locked joints stood.
void set_groups(ChainNodes& nodes) {
  using Place = std::array<std::optional<double>, kMostJoints>;
  std::vector<Place> places(1);
  places.front().fill(0);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> groups;
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    const StrokeMoments& stroke = nodes.strokes[s];
    const auto unit =
        std::find_if(nodes.units.begin(), nodes.units.end(), [&](const auto& strokes) {
          return std::all_of(strokes.begin(), strokes.end(), [&](std::size_t other) {
            return together(stroke, nodes.strokes[other]);
          });
        });
    if (unit != nodes.units.end()) {
      unit->push_back(s);
      continue;
    }
    const Turns& turns = nodes.observations[nodes.first[s]].turns;
    const auto stood_at = [&](const Place& place) {
      for (std::size_t k = 0; k < stroke.content.joints; ++k)
        if (k != stroke.content.joint && place[k] && std::abs(turns[k] - *place[k]) > kSameHome_rad)
          return false;
      return true;
    };
    auto place = std::find_if(places.begin(), places.end(), stood_at);
    if (place == places.end()) place = places.insert(places.end(), Place{});
    for (std::size_t k = 0; k < stroke.content.joints; ++k)
      if (k != stroke.content.joint && !(*place)[k]) (*place)[k] = turns[k];
    const auto home = static_cast<std::size_t>(place - places.begin());
    const auto [group, fresh] = groups.try_emplace({home, stroke.content.joint}, groups.size());
    nodes.units.push_back({s});
    nodes.group.push_back(group->second);
    if (fresh) nodes.home_of.push_back(home);
  }
  const bool in_turn = set_stands(nodes);
  set_times(nodes, in_turn);
  for (const Place& place : places) {
    Turns turns{};
    for (std::size_t k = 0; k < kMostJoints; ++k) turns[k] = place[k].value_or(0);
    nodes.homes.push_back(turns);
  }
  if (in_turn) set_rests(nodes);
}

}  // namespace

std::vector<std::size_t> ChainNodes::in_time() const {
  std::vector<std::size_t> order(units.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return begin_s(a) < begin_s(b); });
  return order;
}

void ChainNodes::set_move(std::size_t unit, double part) {
  const StrokeMoments& during = strokes[units[unit].front()];
  const double moved_s = during.begin_s + part * (during.end_s - during.begin_s);
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    const StrokeMoments& stroke = strokes[s];
    const bool splits = part > 0 && stroke.begin_s < moved_s && moved_s < stroke.end_s;
    for (std::size_t n = 0; n < stroke.nodes.size(); ++n)
      observations[first[s] + n].before_move =
          splits ? stroke.time_s(stroke.nodes[n].turn_rad) < moved_s : stroke.begin_s < moved_s;
  }
}

std::size_t ChainNodes::most_rests() const {
  std::size_t most = 0;
  for (const auto& of_home : rests) most = std::max(most, of_home.size());
  return most;
}

bool ChainNodes::sweeps_again() const {
  std::set<std::size_t> joints;
  for (const auto& unit : units) joints.insert(strokes[unit.front()].content.joint);
  return units.size() > joints.size();
}

double ChainNodes::seconds() const {
  double begin_s = std::numeric_limits<double>::infinity(), end_s = -begin_s;
  for (const StrokeMoments& stroke : strokes) {
    begin_s = std::min(begin_s, stroke.begin_s);
    end_s = std::max(end_s, stroke.end_s);
  }
  return end_s - begin_s;
}

std::size_t ChainNodes::samples() const {
  std::size_t count = 0;
  for (const StrokeMoments& stroke : strokes) count += stroke.samples;
  return count;
}

std::size_t ChainNodes::outliers() const {
  std::size_t count = 0;
  for (const StrokeMoments& stroke : strokes) count += stroke.outliers;
  return count;
}

namespace {

/// Without angles no joint was known when the sums were made.
bool like(const StrokeContent& made, const StrokeContent& wanted) {
  return made.joints == wanted.joints && (made.joint == wanted.joint || made.joints == 0) &&
         made.orientation == wanted.orientation && made.linear == wanted.linear;
}

/// Of printed positions, those that a joint's strokes had. A stroke whose samples fall on the very
/// places of those before it is rounded as they are, and tells nothing that they do not.
class KnownPlaces {
 public:
  /// Which share of the stroke's places is new; from then on none of them is.
  double share_of_new(const Sweep& sweep) {
    constexpr double kLeast = 1e-3;
    const auto places = places_of(sweep);
    std::size_t news = 0;
    for (const std::size_t place : places) news += known_.insert(place).second ? 1U : 0U;
    if (places.empty()) return 1;
    return std::max(kLeast, static_cast<double>(news) / static_cast<double>(places.size()));
  }

 private:
  /// A number for each place of this joint and target.
  static std::vector<std::size_t> places_of(const Sweep& sweep) {
    constexpr std::size_t kSpread = 0x9e3779b97f4a7c15;
    std::vector<std::size_t> places;
    for (const Sample& sample : *sweep.samples) {
      if (!sample.has_position) continue;
      std::size_t place = kMostJoints * sweep.target + *sweep.joint;
      for (const double value : sample.position_mm)
        place = place * kSpread + std::hash<double>()(value);
      places.push_back(place);
    }
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
  }
  std::unordered_set<std::size_t> known_;
};

}  // namespace

ChainNodes nodes_of(std::vector<StrokeMoments> strokes,
                    const std::vector<std::optional<double>>& home_rad, std::vector<bool> known) {
  ChainNodes nodes;
  nodes.strokes = std::move(strokes);
  nodes.known = std::move(known);
  auto home = home_rad;
  for (std::size_t k = 0; k < home.size(); ++k)
    if (!nodes.known[k]) home[k] = std::nullopt;
  nodes.with_angles = nodes.with_orientation = true;
  for (std::size_t s = 0; s < nodes.strokes.size(); ++s) {
    const StrokeMoments& stroke = nodes.strokes[s];
    nodes.targets = std::max(nodes.targets, stroke.target + 1);
    if (stroke.content.joints == 0) nodes.with_angles = false;
    if (!stroke.content.orientation) nodes.with_orientation = false;
    nodes.first.push_back(nodes.observations.size());
    for (const StrokeMoments::Node& node : stroke.nodes) {
      nodes.observations.push_back(mean_at(stroke, node, home));
      nodes.observations.back().sweep = s;
    }
  }
  set_groups(nodes);
  return nodes;
}

ChainNodes chain_nodes(const CircleEstimate& circles,
                       const std::vector<std::optional<ChainAxis>>& axes,
                       const Resolution& printed) {
  const auto sweeps = chain_sweeps(circles, axes);
  const std::size_t joints = circles.joints.size();
  bool with_angles = true, with_orientation = true;
  for (const ChainSweep& one : sweeps)
    for (const Sample& sample : *one.sweep->samples) {
      if (sample.joints < joints) with_angles = false;
      if (!sample.has_orientation) with_orientation = false;
    }
  auto home = circles.home_rad;
  home.resize(joints);
  KnownPlaces known_places;
  std::vector<StrokeMoments> strokes;
  for (const ChainSweep& one : sweeps) {
    const StrokeContent content{one.joint, with_angles ? joints : 0, with_orientation,
                                axes[one.joint]->linear, printed};
    auto stroke = moments_of(*one.sweep, content);
    if (!stroke) continue;
    // A joint that was never seen locked is at home where its first sweep begins.
    if (with_angles && !home[one.joint]) home[one.joint] = one.sweep->first().angles_rad[one.joint];
    if (printed.position_mm > 0) stroke->correlation /= known_places.share_of_new(*one.sweep);
    strokes.push_back(std::move(*stroke));
    if (const auto& repeats = one.sweep->repeats; repeats && like(repeats->content, content)) {
      const StrokeRounding rounding = strokes.back().rounding;
      strokes.push_back(*repeats);
      strokes.back().content = content;
      strokes.back().rounding = rounding;  // alike, as the repeats of a motion are
    }
  }
  return nodes_of(std::move(strokes), home, known_of(axes));
}

}  // namespace identify
