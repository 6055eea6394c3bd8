#include "identify/clock/clock_match.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identify/clock/clock_step.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

/// Fewer motions that agree are chance.
constexpr std::size_t kFewest = 4;
/// Of more motions, those that come first are looked at: each is compared with each.
constexpr std::size_t kMostMoves = 2000;
constexpr std::size_t kMostCandidates = 12;
/// How far a motion's middle may be off, at least.
constexpr double kNear_s = 0.03;
/// What quartz clocks differ in, sigma.
constexpr double kUsualRate = 5e-5;
/// A middle is not known better, whatever the scatter: motions that gears and servos begin
/// unevenly.
constexpr double kLeastSigma_s = 1e-3;
constexpr double kWorstScatter_s = 0.03;
/// Of the motions that both could see, so many may have been seen by one alone.
constexpr double kMostStrange = 0.25;
/// What fits so well beside the best is no worse by chance.
constexpr double kAsGood = 0.75;
constexpr double kStepSigmas = 8;
/// Of a few motions at an end chance makes more.
constexpr std::size_t kBesideStep = 5;
constexpr double kLeastStep_s = 0.015;

std::vector<Span> in_order(std::vector<Span> spans) {
  std::stable_sort(spans.begin(), spans.end(),
                   [](const Span& a, const Span& b) { return a.middle_s() < b.middle_s(); });
  if (spans.size() > kMostMoves) spans.resize(kMostMoves);
  return spans;
}

struct Pair {
  double controller_s = 0;
  double off_s = 0;  ///< of the device's middle from the line
  double device_s = 0;
  double hidden_s = 0;  ///< by so much the device's view is shorter
};

class Matcher {
 public:
  Matcher(const Motion& device, const Motion& controller)
      : device_(device),
        controller_(controller),
        d_(in_order(device.moves)),
        c_(in_order(controller.moves)) {}

  /// The differences that most pairs of motions of one length vote for.
  [[nodiscard]] std::vector<double> candidates() const {
    std::vector<double> votes;
    for (const Span& d : d_)
      for (const Span& c : c_)
        if (alike(d, c, 0, kMostHidden_s)) votes.push_back(d.middle_s() - c.middle_s());
    std::sort(votes.begin(), votes.end());
    const double span = c_.empty() ? 0 : c_.back().middle_s() - c_.front().middle_s();
    const double wide = kSameMove_s + 2 * kUsualRate * span;
    struct Peak {
      std::size_t votes;
      double ahead_s;
    };
    std::vector<Peak> peaks;
    for (std::size_t i = 0, end = 0; i < votes.size(); ++i) {
      while (end < votes.size() && votes[end] - votes[i] <= wide) ++end;
      peaks.push_back({end - i, votes[i + (end - i) / 2]});
    }
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const Peak& a, const Peak& b) { return a.votes > b.votes; });
    std::vector<double> best;
    for (const Peak& peak : peaks) {
      if (best.size() == kMostCandidates || peak.votes < kFewest) break;
      if (std::none_of(best.begin(), best.end(),
                       [&](double other) { return std::abs(other - peak.ahead_s) < wide; }))
        best.push_back(peak.ahead_s);
    }
    return best;
  }

  /// The line through the middles of the motions that lie near it.
  [[nodiscard]] std::optional<ClockMatch> refined(double ahead_s) {
    const double span = c_.back().middle_s() - c_.front().middle_s();
    double near = kSameMove_s + 2 * kUsualRate * span;
    ClockMatch match;
    match.ahead_s = ahead_s;
    hidden_s_.reset();
    for (int round = 0; round < 6; ++round) {
      pairs_ = pairs_of(match, near);
      if (pairs_.size() < kFewest) return std::nullopt;
      hidden_s_ = usually_hidden_s();
      fit(match);
      near = std::clamp(4 * scatter_, kNear_s, kSameMove_s);
    }
    pairs_ = pairs_of(match, kSameMove_s);
    match.matched = pairs_.size();
    match.strange = strange(match);
    if (std::abs(match.rate) > kMostRate) return std::nullopt;
    return match;
  }

  /// Where the differences of the last match change at once, and by how much; nothing where chance
  /// makes as much.
  [[nodiscard]] std::optional<ClockStep> step() const {
    std::optional<ClockStep> found;
    double best = kStepSigmas;
    for (std::size_t cut = kBesideStep; cut + kBesideStep <= pairs_.size(); ++cut) {
      std::vector<double> before, after;
      for (std::size_t i = 0; i < pairs_.size(); ++i)
        (i < cut ? before : after).push_back(pairs_[i].off_s);
      const double by = median_of(after) - median_of(before);
      const double sigma = std::max(kLeastSigma_s, scatter_within(cut)) *
                           std::sqrt(1.0 / static_cast<double>(cut) +
                                     1.0 / static_cast<double>(pairs_.size() - cut));
      if (std::abs(by) > kLeastStep_s && std::abs(by) / sigma > best) {
        best = std::abs(by) / sigma;
        found = {pairs_[cut].controller_s, by};
      }
    }
    return found;
  }

  /// Of the last match's middles.
  [[nodiscard]] double scatter_s() const { return scatter_; }

 private:
  [[nodiscard]] bool is_view_of(const Span& device, const Span& controller) const {
    return alike(device, controller, hidden_s_.value_or(0), hidden_s_.value_or(kMostHidden_s));
  }

  [[nodiscard]] double usually_hidden_s() const {
    std::vector<double> hidden;
    for (const Pair& pair : pairs_) hidden.push_back(pair.hidden_s);
    return std::clamp(median_of(std::move(hidden)), 0.0, kMostHidden_s);
  }

  [[nodiscard]] std::vector<Pair> pairs_of(const ClockMatch& line, double near) const {
    std::vector<Pair> pairs;
    for (const Span& d : d_) {
      const Span* best = nullptr;
      double least = near;
      for (const Span& c : c_) {
        const double off = std::abs(d.middle_s() - line.device_s(c.middle_s()));
        if (off > least || !is_view_of(d, c)) continue;
        least = off;
        best = &c;
      }
      if (best != nullptr)
        pairs.push_back({best->middle_s(), d.middle_s() - line.device_s(best->middle_s()),
                         d.middle_s(), best->seconds() - d.seconds()});
    }
    return pairs;
  }

  void fit(ClockMatch& line) {
    double at = 0;
    for (const Pair& pair : pairs_) at += pair.controller_s / static_cast<double>(pairs_.size());
    line.ahead_s += line.rate * (at - line.at_s);
    line.at_s = at;
    std::vector<double> offs;
    for (const Pair& pair : pairs_) offs.push_back(pair.off_s);
    const double middle = median_of(offs);
    for (double& off : offs) off = std::abs(off - middle);
    const double sigma = std::max(kLeastSigma_s, 1.48 * median_of(offs));
    // Off by more than 3 sigma counts less (Huber); the rate has what clocks usually have before
    // it.
    double w = 0, wt = 0, wtt = sigma * sigma / (kUsualRate * kUsualRate), wy = 0, wty = 0;
    wty = -wtt * line.rate;
    for (const Pair& pair : pairs_) {
      const double weight =
          std::min(1.0, 3 * sigma / std::max(1e-12, std::abs(pair.off_s - middle)));
      const double t = pair.controller_s - at;
      w += weight;
      wt += weight * t;
      wtt += weight * t * t;
      wy += weight * pair.off_s;
      wty += weight * t * pair.off_s;
    }
    const double determinant = w * wtt - wt * wt;
    line.ahead_s += (wtt * wy - wt * wty) / determinant;
    line.rate += (w * wty - wt * wy) / determinant;
    scatter_ = sigma;
    line.sigma_s = sigma * std::sqrt(wtt / determinant);
    line.rate_sigma = sigma * std::sqrt(w / determinant);
  }

  [[nodiscard]] double scatter_within(std::size_t cut) const {
    std::vector<double> offs;
    for (const auto& [from, to] : {std::pair{std::size_t{0}, cut}, std::pair{cut, pairs_.size()}}) {
      std::vector<double> part;
      for (std::size_t i = from; i < to; ++i) part.push_back(pairs_[i].off_s);
      const double middle = median_of(part);
      for (const double off : part) offs.push_back(std::abs(off - middle));
    }
    return 1.48 * median_of(offs);
  }

  /// Motions that one saw, and the other did not though it looked.
  [[nodiscard]] std::size_t strange(const ClockMatch& line) const {
    const auto unmatched = [&](const Span& c) {
      return std::none_of(d_.begin(), d_.end(), [&](const Span& d) {
        return std::abs(d.middle_s() - line.device_s(c.middle_s())) <= kSameMove_s &&
               is_view_of(d, c);
      });
    };
    std::size_t count = 0;
    for (const Span& c : c_)
      if (is_within(device_.seen, {line.device_s(c.begin_s), line.device_s(c.end_s)}) &&
          unmatched(c))
        ++count;
    for (const Span& d : d_) {
      const bool looked =
          is_within(controller_.seen, {line.controller_s(d.begin_s), line.controller_s(d.end_s)});
      const bool is_matched = std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
        return pair.device_s == d.middle_s();
      });
      if (looked && !is_matched) ++count;
    }
    return count;
  }

  const Motion& device_;
  const Motion& controller_;
  std::vector<Span> d_, c_;
  std::vector<Pair> pairs_;  // of the last line
  double scatter_ = 0;
  std::optional<double> hidden_s_;  // of the last line; nothing: not known yet
};

double score(const ClockMatch& match) {
  return static_cast<double>(match.matched) - static_cast<double>(match.strange);
}

/// Why nothing matches, where the best of them leaves too much.
std::string disagreement(const std::vector<ClockMatch>& all, const Motion& device) {
  const std::size_t motions = device.moves.size();
  const ClockMatch best = all.empty() ? ClockMatch{} : all.front();
  std::string apart = "the motions of the device and those of the angles do not agree: " +
                      std::to_string(best.matched) + " of the device's " + std::to_string(motions) +
                      " fit one offset of the clocks";
  if (best.strange > 0)
    apart += ", and " + std::to_string(best.strange) +
             " were seen by one of the two alone while the other looked";
  apart += "; ";
  if (device.hidden_below_mm_s > 0)
    apart += "the device's noise, or its last decimal, hides motion below " +
             fixed(device.hidden_below_mm_s, 0) + " mm/s: sweep faster, or ";
  apart +=
      "give the trace that was recorded while the device measured, and see whether the device "
      "followed its target";
  for (std::size_t k = 1; k < all.size(); ++k)
    if (4 * (all[0].matched + all[k].matched) >= 3 * motions && all[k].matched >= 3)
      return "the offset of the clocks changes midway: " + std::to_string(all[0].matched) +
             " motions fit " + fixed(all[0].ahead_s, 3) + " s, and " +
             std::to_string(all[k].matched) + " fit " + fixed(all[k].ahead_s, 3) +
             " s; give each part of the take as a file of its own";
  return apart;
}

}  // namespace

ClockSearch match_clocks(const Motion& device, const Motion& controller) {
  ClockSearch found;
  for (const auto& [motion, who] : {std::pair{&device, "the device's points"},
                                    std::pair{&controller, "the angles of the trace"}})
    if (motion->moves.size() < kFewest) {
      found.problem = std::string(who) + " show " + std::to_string(motion->moves.size()) +
                      " motions from rest to rest, and " + std::to_string(kFewest) +
                      " are needed to match the clocks: let the robot rest for half a second "
                      "between its moves";
      return found;
    }
  Matcher matcher(device, controller);
  std::vector<ClockMatch> all;
  for (const double ahead_s : matcher.candidates())
    if (const auto match = matcher.refined(ahead_s)) all.push_back(*match);
  std::stable_sort(all.begin(), all.end(),
                   [](const ClockMatch& a, const ClockMatch& b) { return score(a) > score(b); });
  const bool agrees =
      !all.empty() && all.front().matched >= kFewest &&
      static_cast<double>(all.front().strange) <=
          kMostStrange * static_cast<double>(all.front().strange + all.front().matched);
  if (!agrees) {
    found.problem = disagreement(all, device);
    return found;
  }
  const ClockMatch& best = all.front();
  static_cast<void>(matcher.refined(best.ahead_s - best.rate * best.at_s));
  auto step = matcher.step();
  if (!step) step = step_beyond(device, controller, best);
  if (step)
    found.problem = "the offset of the clocks changes by " + fixed(step->by_s, 3) + " s at " +
                    fixed(step->at_s, 1) +
                    " s of the trace: a clock was set, or two takes were put together; give each "
                    "part as a file of its own";
  else if (matcher.scatter_s() > kWorstScatter_s)
    found.problem = "the motions of the device and those of the angles are " +
                    fixed(1e3 * matcher.scatter_s(), 0) +
                    " ms apart, now more, now less: let the robot rest for half a second between "
                    "its moves, and stamp points when they are measured";
  if (!found.problem.empty()) return found;
  for (const ClockMatch& match : all)
    if (score(match) >= kAsGood * score(all.front())) found.matches.push_back(match);
  return found;
}

}  // namespace identify
