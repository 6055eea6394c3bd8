#include "identify/sweeps/planned_turns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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

/// In what is allowed for. A stroke that was not seen whole may have been any longer.
double difference(double angle, double wanted, bool whole, double unsure) {
  if (!whole && angle * wanted > 0 && std::abs(angle) < std::abs(wanted)) return 0;
  return (angle - wanted) / (kDegree + (0.02 + unsure) * std::abs(wanted));
}

/// How strokes that were seen lie beside planned ones.
struct Laid {
  double cost = 0;
  /// For each that was seen, the planned one that it is or is a piece of, counted over all rounds
  /// of the plan; nothing where no plan has it.
  std::vector<std::optional<std::size_t>> as;
};

/// The cheapest way to lay the strokes that were seen beside the planned ones (rad about the turn's
/// axis), which may have been run several times: the edit distance. What the stream saw in pieces
/// may be one stroke, and so may what paused.
Laid lay(const std::vector<double>& planned, const Turn& turn) {
  const auto& seen = turn.strokes;
  const std::size_t repeats =
      std::max<std::size_t>(1, (whole_strokes(turn) + planned.size() / 2) / planned.size());
  struct Step {
    double cost = 0;
    std::size_t seen = 0, planned = 0;  // where it comes from
  };
  std::vector<std::vector<Step>> steps(seen.size() + 1,
                                       std::vector<Step>(1 + repeats * planned.size()));
  for (std::size_t i = 0; i <= seen.size(); ++i)
    for (std::size_t k = 0; k < steps[i].size(); ++k) {
      if (i + k == 0) continue;
      Step& step = steps[i][k] = {kNever};
      const auto come = [&](std::size_t from, std::size_t after, double cost) {
        cost += steps[from][after].cost;
        if (cost < step.cost) step = {cost, from, after};
      };
      if (i > 0) come(i - 1, k, kStray);
      if (k > 0) come(i, k - 1, kUnseen);
      double angle = 0;
      for (std::size_t first = k > 0 ? i : 0; first-- > 0;) {
        angle += seen[first].angle_rad;
        const bool whole = seen[first].begin_seen && seen[i - 1].end_seen;
        const double off = difference(angle, planned[(k - 1) % planned.size()], whole, turn.unsure);
        come(first, k - 1, off * off);
        if (!seen[first].gap_rad && !seen[first].goes_on) break;
        angle += seen[first].gap_rad.value_or(0);
      }
    }
  Laid laid{steps.back().back().cost, std::vector<std::optional<std::size_t>>(seen.size())};
  for (std::size_t i = seen.size(), k = steps[i].size() - 1; i + k > 0;) {
    const Step& step = steps[i][k];
    if (step.planned < k)
      std::fill(laid.as.begin() + static_cast<std::ptrdiff_t>(step.seen),
                laid.as.begin() + static_cast<std::ptrdiff_t>(i), k - 1);
    i = step.seen;
    k = step.planned;
  }
  return laid;
}

double distance(std::vector<double> planned, const Turn& turn, int sense) {
  for (double& stroke : planned) stroke *= sense;
  return lay(planned, turn).cost;
}

/// Whether a stroke of another turn began between these times.
bool others_between(const std::vector<Turn>& turns, std::size_t turn, double from_s, double to_s) {
  for (std::size_t t = 0; t < turns.size(); ++t)
    for (const Turn::Stroke& stroke : turns[t].strokes)
      if (t != turn && stroke.begin_s > from_s && stroke.begin_s < to_s) return true;
  return false;
}

}  // namespace

std::vector<Turn> PlannedTurns::Parting::of(std::vector<Turn> turns) const {
  turns[turn] = parts[0];
  turns.push_back(parts[1]);
  std::stable_sort(turns.begin(), turns.end(),
                   [](const Turn& a, const Turn& b) { return a.begin_s() < b.begin_s(); });
  return turns;
}

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
    for (const double stroke : turn.strokes_rad) sequence_.push_back({turn.joint, stroke});
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

std::optional<std::array<Turn, 2>> PlannedTurns::parted(const std::vector<Turn>& turns,
                                                        std::size_t turn,
                                                        const std::array<Sensed, 2>& joints) const {
  std::vector<double> planned;
  std::vector<std::size_t> whose;
  std::vector<bool> after_others;  // other joints have strokes since the one before of these
  bool others = false;
  for (const auto& [joint, stroke] : sequence_) {
    const std::size_t which = joint == joints[0].joint ? 0 : 1;
    others = others || joint != joints[which].joint;
    if (joint != joints[which].joint) continue;
    planned.push_back(joints[which].sense * stroke);
    whose.push_back(which);
    after_others.push_back(std::exchange(others, false));
  }
  after_others.front() = after_others.front() || others;  // where the plan begins again
  const Turn& seen = turns[turn];
  const Laid laid = lay(planned, seen);
  std::array<Turn, 2> parts{seen, seen};
  for (Turn& part : parts) part.strokes.clear();
  std::optional<std::size_t> last;
  std::size_t which = whose.front();
  double last_s = 0;
  for (std::size_t s = 0; s < seen.strokes.size(); ++s) {
    Turn::Stroke stroke = seen.strokes[s];
    if (const auto now = laid.as[s]) {
      bool apart = false;
      for (std::size_t k = last.value_or(*now); k < *now; ++k)
        apart = apart || after_others[(k + 1) % planned.size()];
      if (whose[*now % planned.size()] != which) {
        if (apart && !others_between(turns, turn, last_s, stroke.begin_s)) return std::nullopt;
        which = whose[*now % planned.size()];
        stroke.gap_rad.reset();
        stroke.goes_on = false;
      }
      last = now;
    }
    last_s = stroke.begin_s;
    parts[which].strokes.push_back(stroke);
  }
  if (parts[0].strokes.empty() || parts[1].strokes.empty()) return std::nullopt;
  return parts;
}

std::vector<PlannedTurns::Parting> PlannedTurns::partings(const std::vector<Turn>& turns) const {
  std::vector<Parting> found;
  if (!given_) return found;
  const auto consider = [&](std::size_t turn, const std::array<Sensed, 2>& joints) {
    auto parts = parted(turns, turn, joints);
    if (!parts) return;
    double cost = 0;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto& [joint, sense] = joints[k];
      if (!explains((*parts)[k], joint, sense)) return;
      cost += misfit((*parts)[k], joint, sense);
    }
    found.push_back({cost, cost < kUnseen, turn, std::move(*parts)});
  };
  for (std::size_t t = 0; t < turns.size(); ++t)
    for (std::size_t p = 0; p < order_.size(); ++p)
      for (std::size_t q = p + 1; q < order_.size(); ++q) {
        if (strokes_[order_[p]].empty() || strokes_[order_[q]].empty()) continue;
        for (const int first : {1, -1})
          for (const int second : {1, -1}) consider(t, {{{order_[p], first}, {order_[q], second}}});
      }
  std::stable_sort(found.begin(), found.end(),
                   [](const Parting& a, const Parting& b) { return a.cost < b.cost; });
  return found;
}

bool PlannedTurns::explains_in_order(const std::vector<Turn>& turns) const {
  for (std::size_t t = 0; t < std::min(turns.size(), order_.size()); ++t)
    if (!explains(turns[t], order_[t], 1) && !explains(turns[t], order_[t], -1)) return false;
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
