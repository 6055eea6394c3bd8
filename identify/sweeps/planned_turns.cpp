#include "identify/sweeps/planned_turns.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

// Chi squared of a stroke that no plan has, and of a planned one that was not seen.
constexpr double kStray = 25;
constexpr double kUnseen = 5;
constexpr double kNever = 1e300;

std::size_t whole_strokes(const Turn& turn) {
  return static_cast<std::size_t>(
      std::count_if(turn.strokes.begin(), turn.strokes.end(),
                    [](const Turn::Stroke& stroke) { return !stroke.gap_rad; }));
}

std::pair<Turn, Turn> halves(const Turn& turn, std::size_t cut) {
  Turn head = turn, tail = turn;
  const auto at = static_cast<std::ptrdiff_t>(cut);
  head.strokes.erase(head.strokes.begin() + at, head.strokes.end());
  tail.strokes.erase(tail.strokes.begin(), tail.strokes.begin() + at);
  tail.strokes.front().gap_rad.reset();
  tail.strokes.front().goes_on = false;
  return {head, tail};
}

/// In what is allowed for. A stroke that was not seen whole may have been any longer.
double difference(double angle, double wanted, bool whole, double unsure) {
  if (!whole && angle * wanted > 0 && std::abs(angle) < std::abs(wanted)) return 0;
  return (angle - wanted) / (kDegree + (0.02 + unsure) * std::abs(wanted));
}

/// The cheapest way to lay the strokes that were seen beside the planned ones, which may have been
/// run several times: the edit distance. What the stream saw in pieces may be one stroke, and so
/// may what paused.
double distance(const std::vector<double>& planned, const Turn& turn, int sense) {
  const auto& seen = turn.strokes;
  const std::size_t repeats =
      std::max<std::size_t>(1, (whole_strokes(turn) + planned.size() / 2) / planned.size());
  std::vector<std::vector<double>> cost(seen.size() + 1,
                                        std::vector<double>(1 + repeats * planned.size()));
  for (std::size_t k = 1; k < cost[0].size(); ++k) cost[0][k] = cost[0][k - 1] + kUnseen;
  for (std::size_t i = 1; i <= seen.size(); ++i) {
    cost[i][0] = cost[i - 1][0] + kStray;
    for (std::size_t k = 1; k < cost[i].size(); ++k) {
      const double wanted = planned[(k - 1) % planned.size()];
      cost[i][k] = std::min(cost[i - 1][k] + kStray, cost[i][k - 1] + kUnseen);
      double angle = 0;
      for (std::size_t first = i; first-- > 0;) {
        angle += seen[first].angle_rad;
        const bool whole = seen[first].begin_seen && seen[i - 1].end_seen;
        const double off = difference(sense * angle, wanted, whole, turn.unsure);
        cost[i][k] = std::min(cost[i][k], cost[first][k - 1] + off * off);
        if (!seen[first].gap_rad && !seen[first].goes_on) break;
        angle += seen[first].gap_rad.value_or(0);
      }
    }
  }
  return cost.back().back();
}

}  // namespace

PlannedTurns::PlannedTurns(const Campaign& campaign)
    : strokes_(campaign.joints), first_(campaign.joints, 0) {
  const auto slides = [&](std::size_t joint) {
    return campaign.specified && campaign.specified->is_linear(joint);
  };
  for (const DeclaredJoint& turn : campaign.order) {
    if (turn.joint >= campaign.joints || slides(turn.joint)) continue;
    if (std::find(order_.begin(), order_.end(), turn.joint) == order_.end()) {
      order_.push_back(turn.joint);
      first_[turn.joint] = turn.first_direction;
    }
    strokes_[turn.joint].insert(strokes_[turn.joint].end(), turn.strokes_rad.begin(),
                                turn.strokes_rad.end());
  }
  given_ = !order_.empty();
  if (given_) return;
  for (std::size_t j = 0; j < campaign.joints; ++j)
    if (!slides(j)) order_.push_back(j);
}

double PlannedTurns::misfit(const Turn& turn, std::size_t joint, int sense) const {
  constexpr double kHint = 1e-3;  // where nothing else tells, the first stroke is seen
  const bool begins_otherwise = first_[joint] * sense * turn.strokes.front().angle_rad < 0;
  if (strokes_[joint].empty()) return begins_otherwise ? kStray : 0;
  return distance(strokes_[joint], turn, sense) + (begins_otherwise ? kHint : 0);
}

bool PlannedTurns::explains(const Turn& turn, std::size_t joint, int sense) const {
  const auto unseen =
      kUnseen * static_cast<double>(strokes_[joint].size() -
                                    std::min(strokes_[joint].size(), whole_strokes(turn)));
  return misfit(turn, joint, sense) < kStray + unseen;
}

bool PlannedTurns::tells(const Turn& turn, std::size_t joint, int sense) const {
  return explains(turn, joint, sense) ||
         (begins(turn, joint, sense) && !begins(turn, joint, -sense));
}

bool PlannedTurns::begins(const Turn& turn, std::size_t joint, int sense) const {
  constexpr double kAsLong = 0.8;
  const auto& planned = strokes_[joint];
  const auto longest = std::max_element(
      planned.begin(), planned.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (longest == planned.end()) return false;
  Turn head = turn;
  const auto first =
      std::find_if(head.strokes.begin(), head.strokes.end(), [&](const Turn::Stroke& stroke) {
        return std::abs(stroke.angle_rad) > kAsLong * std::abs(*longest);
      });
  if (first == head.strokes.end()) return false;
  head.strokes.erase(first + 1, head.strokes.end());
  return distance({planned.begin(), longest + 1}, head, sense) < kStray;
}

double PlannedTurns::misfit(const std::vector<Turn>& turns, const JointOrder& order) const {
  double sum = 0;
  for (std::size_t t = 0; given_ && t < turns.size(); ++t)
    if (order.joints[t] != kNoJoint) sum += misfit(turns[t], order.joints[t], order.senses[t]);
  return sum;
}

bool PlannedTurns::explains(const std::vector<Turn>& turns, const JointOrder& order) const {
  for (std::size_t t = 0; t < turns.size(); ++t)
    if (order.joints[t] != kNoJoint && !explains(turns[t], order.joints[t], order.senses[t]))
      return false;
  return true;
}

bool PlannedTurns::tells_sense(std::size_t joint) const {
  return !strokes_[joint].empty() || first_[joint] != 0;
}

double PlannedTurns::misfit(const Turn& turn, std::size_t joint) const {
  return std::min(misfit(turn, joint, 1), misfit(turn, joint, -1));
}

bool PlannedTurns::part(std::vector<Turn>& turns, bool whole) const {
  if (!given_) return false;
  const auto explained = [&](const Turn& turn, std::size_t joint) {
    return explains(turn, joint, 1) || explains(turn, joint, -1);
  };
  double least = whole ? kUnseen : kNever;
  bool found = false;
  std::size_t place = 0;
  std::pair<Turn, Turn> best;
  for (std::size_t t = 0; t < turns.size(); ++t)
    for (std::size_t cut = 1; cut < turns[t].strokes.size(); ++cut) {
      const auto [head, tail] = halves(turns[t], cut);
      for (std::size_t p = 0; p + 1 < order_.size(); ++p) {
        if (strokes_[order_[p]].empty() || strokes_[order_[p + 1]].empty()) continue;
        const double cost = misfit(head, order_[p]) + misfit(tail, order_[p + 1]);
        if (cost >= least || !explained(head, order_[p]) || !explained(tail, order_[p + 1]))
          continue;
        least = cost;
        found = true;
        place = t;
        best = {head, tail};
      }
    }
  if (!found) return false;
  turns[place] = best.first;
  turns.insert(turns.begin() + static_cast<std::ptrdiff_t>(place) + 1, best.second);
  return true;
}

std::vector<std::size_t> PlannedTurns::joints_of(const std::vector<Turn>& turns) const {
  // Of so many turns and so many joints.
  std::vector<std::vector<double>> cost(turns.size() + 1,
                                        std::vector<double>(order_.size() + 1, kNever));
  cost[0][0] = 0;
  for (std::size_t t = 1; t < cost.size(); ++t) {
    cost[t][0] = 0;
    for (std::size_t p = 1; p <= std::min(t, order_.size()); ++p)
      cost[t][p] =
          std::min(cost[t - 1][p], cost[t - 1][p - 1] + misfit(turns[t - 1], order_[p - 1]));
  }
  std::vector<std::size_t> joints(turns.size(), kNoJoint);
  std::size_t t = turns.size();
  for (std::size_t p = order_.size(); p > 0; --p) {
    while (cost[t - 1][p] <= cost[t][p]) --t;
    joints[--t] = order_[p - 1];
  }
  return joints;
}

}  // namespace identify
