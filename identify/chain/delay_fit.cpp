#include "identify/chain/delay_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <Eigen/Cholesky>

#include "identify/chain/angle_weight.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMostLate_s = 2;
constexpr double kMostRate = 1e-3;  // clocks that nobody sets differ by less
/// A joint runs at its stroke's usual speed where that is off by less than so many standard
/// deviations of its noise, or by less than this share of it.
constexpr double kSteady = 5, kSteadyShare = 1e-4;
/// What a built robot's gears have, to begin with, and at least; and what linear joints have.
constexpr double kUsualBacklash_rad = 60 * kArcsec, kUsualPlay_mm = 0.1;
constexpr double kLeastBacklash_rad = 0.1 * kArcsec;
/// Angles that are further off the seen ones are not these joints'.
constexpr double kForeign_rad = 5 * kDegree;

/// One linearisation after the other of: told angle, shifted by the delay, minus seen angle = the
/// joint's offset and smooth error + half its backlash by direction.
class DelayFit {
 public:
  /// `two_clocks`: angles are off by the jitter of stamps, the faster the more; and the delay
  /// grows.
  DelayFit(const std::vector<AngleTrack>& tracks, bool two_clocks)
      : tracks_(tracks),
        groups_(tracks.back().group + 1),
        two_clocks_(two_clocks),
        weight_(groups_),
        both_ways_(groups_, false),
        track_of_(groups_),
        backlash_rad_(groups_) {
    double begin = tracks.front().at_s.front(), end = begin;
    std::vector<std::array<bool, 2>> ways(groups_, {false, false});
    for (const AngleTrack& track : tracks) {
      begin = std::min(begin, track.at_s.front());
      end = std::max(end, track.at_s.back());
      ways[track.group][track.direction > 0] = true;
      track_of_[track.group] = &track;
    }
    for (std::size_t g = 0; g < groups_; ++g) {
      both_ways_[g] = ways[g][0] && ways[g][1];
      backlash_rad_[g] = track_of_[g]->linear ? kUsualPlay_mm / kLinear_mm : kUsualBacklash_rad;
    }
    delay_.at_s = (begin + end) / 2;
    span_s_ = std::max(end - begin, 1.0);
  }

  /// Steps until they are small against what is uncertain, some at least, as the weights settle,
  /// too. Nothing where they do not become small: the angles do not tell it then. One that grows
  /// may settle where one that does not has no single figure.
  std::optional<Delay> settled(bool with_rate) {
    constexpr int kLeastRounds = 4, kMostRounds = 40;
    constexpr double kSmall = 0.1;
    for (int round = 1; round <= kMostRounds; ++round) {
      const Delay before = delay_;
      if (!step(with_rate)) return std::nullopt;
      const bool small = std::abs(delay_.late_s - before.late_s) <= kSmall * delay_.sigma_s &&
                         std::abs(delay_.rate - before.rate) <= kSmall * delay_.rate_sigma;
      if (small && round >= kLeastRounds) return foreign_ ? std::nullopt : std::optional(delay_);
    }
    return std::nullopt;
  }
  /// How much errors scatter within strokes then: logarithms of their variances, one a sample.
  [[nodiscard]] double scatter() const { return scatter_; }

 private:
  static constexpr Index kOrders = 4;             // of a joint's smooth error
  static constexpr Index kOfGroup = kOrders + 1;  // and its backlash

  /// Solves the equations at the present delay, and moves it. `with_rate`: it may grow.
  bool step(bool with_rate) {
    const Index shared = kOfGroup * static_cast<Index>(groups_);
    const Index count = shared + (with_rate ? 2 : 1);
    MatrixXd normal = MatrixXd::Zero(count, count);
    VectorXd right = VectorXd::Zero(count);
    std::vector<Residuals> all;
    for (const AngleTrack& track : tracks_) all.push_back(residuals(track));
    for (std::size_t k = 0; k < tracks_.size(); ++k) {
      const Index own = kOfGroup * static_cast<Index>(tracks_[k].group);
      const Products of_stroke = products(tracks_[k], all[k]);
      const Index both = count - shared;
      normal.block<kOfGroup, kOfGroup>(own, own) +=
          of_stroke.normal.topLeftCorner<kOfGroup, kOfGroup>();
      normal.block(own, shared, kOfGroup, both) +=
          of_stroke.normal.block(0, kOfGroup, kOfGroup, both);
      normal.block(shared, shared, both, both) +=
          of_stroke.normal.block(kOfGroup, kOfGroup, both, both);
      right.segment<kOfGroup>(own) += of_stroke.right.head<kOfGroup>();
      right.segment(shared, both) += of_stroke.right.segment(kOfGroup, both);
    }
    for (Index s = shared; s < count; ++s)
      normal.block(s, 0, 1, shared) = normal.block(0, s, shared, 1).transpose();
    // Of joints that turned one way, and where nothing tells: known to be within reason.
    for (std::size_t g = 0; g < groups_; ++g) {
      const Index own = kOfGroup * static_cast<Index>(g);
      for (Index m = 0; m < kOrders; ++m) normal(own + m, own + m) += 1e-4;
      normal(own + kOrders, own + kOrders) += 1 / (backlash_rad_[g] * backlash_rad_[g]);
    }
    normal(shared, shared) += 1 / (kMostLate_s * kMostLate_s);
    if (with_rate) normal(shared + 1, shared + 1) += 1 / std::pow(kMostRate * span_s_, 2);
    const Eigen::LDLT<MatrixXd> factors(normal);
    const VectorXd found = factors.solve(right);
    const MatrixXd covariance = factors.solve(MatrixXd::Identity(count, count));
    if (!found.allFinite() || !(covariance(shared, shared) > 0)) return false;
    // Where the joint gets to speed it does so faster than told() sees. A step goes too far then,
    // and the next one back: from both the way between them is known (Aitken).
    const double back = last_step_s_ != 0 ? std::max(0.0, -found(shared) / last_step_s_) : 0;
    last_step_s_ = found(shared) / (1 + back);
    delay_.late_s += last_step_s_;
    delay_.sigma_s = std::sqrt(covariance(shared, shared));
    if (with_rate) {
      delay_.rate += found(shared + 1) / span_s_;
      delay_.rate_sigma = std::sqrt(std::max(0.0, covariance(shared + 1, shared + 1))) / span_s_;
    }
    if (!(std::abs(delay_.late_s) < kMostLate_s)) return false;
    weigh(all, found);
    size_backlash(found, covariance);
    return true;
  }

  struct Residuals {
    std::vector<double> error, speed, place, time;
    double usual_speed = 0, unsteady = 0;  ///< and how far speeds are off it, at most
  };

  [[nodiscard]] Residuals residuals(const AngleTrack& track) const {
    Residuals found;
    double& usual = found.usual_speed;
    for (std::size_t i = 0; i < track.at_s.size(); ++i) {
      const double since = track.at_s[i] - delay_.at_s;
      const auto told = track.told(track.at_s[i] + delay_.late_s + delay_.rate * since);
      if (!told) continue;
      found.error.push_back(told->angle_rad - track.seen_rad[i]);
      found.speed.push_back(track.seen_speed_rad_s.empty() ? told->speed_rad_s
                                                           : track.seen_speed_rad_s[i]);
      found.place.push_back((track.seen_rad[i] - track.middle_rad) / track.half_rad);
      found.time.push_back(since / span_s_);
    }
    if (found.speed.empty()) return found;
    usual = median_of(found.speed);
    const double steady =
        std::max(kSteady * track.speed_noise_rad_s, kSteadyShare * std::abs(usual));
    for (double& speed : found.speed) {
      if (std::abs(speed - usual) < steady) speed = usual;
      found.unsteady = std::max(found.unsteady, std::abs(speed - usual));
    }
    return found;
  }

  using Row = Eigen::Matrix<double, kOfGroup + 2, 1>;
  static Row row_of(const AngleTrack& track, const Residuals& seen, std::size_t i) {
    Row row;
    const double x = seen.place[i];
    row << 1, x, 2 * x * x - 1, (4 * x * x - 3) * x, track.direction / 2.0, -seen.speed[i],
        -seen.speed[i] * seen.time[i];
    return row;
  }

  using Own = Eigen::Matrix<double, 5, 1>;
  struct Products {
    Eigen::Matrix<double, kOfGroup + 2, kOfGroup + 2> normal = decltype(normal)::Zero();
    Row right = Row::Zero();
  };
  /// Of a stroke with errors of its own, as its locked joints stood elsewhere: by chance, and by
  /// what was told. About an axis that is turned and shifted a little, an angle is seen off by a
  /// constant and a first harmonic. And with stamps and angles that are off alike, as they are
  /// rounded; angles by one figure at its usual speed, and by another one where it gets to that.
  /// The covariance of all is inverted by Woodbury's formula.
  [[nodiscard]] Products products(const AngleTrack& track, const Residuals& seen) const {
    Products sums;
    const double apart = std::sqrt(apart_mm2_ / (track.reach_mm * track.reach_mm) +
                                   track.off_home_rad * track.off_home_rad);
    const double level = std::hypot(apart, track.printed_rad);
    const double unlike_s =
        seen.unsteady > 0 ? std::sqrt(2) * track.printed_rad / seen.unsteady : 0;
    Eigen::Matrix<double, kOfGroup + 2, 5> weighted = decltype(weighted)::Zero();
    Eigen::Matrix<double, 5, 5> own = decltype(own)::Identity();
    Own errors = Own::Zero();
    for (std::size_t i = 0; i < seen.error.size(); ++i) {
      const double weight = weight_[track.group].at(seen.speed[i]);
      const Row row = row_of(track, seen, i);
      const double turn = track.half_rad * seen.place[i];
      Own of_stroke;
      of_stroke << level, apart * std::sin(turn), apart * std::cos(turn),
          track.stamps_s * seen.speed[i], unlike_s * (seen.speed[i] - seen.usual_speed);
      sums.normal += weight * row * row.transpose();
      sums.right += weight * seen.error[i] * row;
      weighted += weight * row * of_stroke.transpose();
      own += weight * of_stroke * of_stroke.transpose();
      errors += weight * seen.error[i] * of_stroke;
    }
    sums.normal -= weighted * own.llt().solve(weighted.transpose());
    sums.right -= weighted * own.llt().solve(errors);
    return sums;
  }

  [[nodiscard]] double left_of(const AngleTrack& track, const Residuals& seen, std::size_t i,
                               const VectorXd& found) const {
    const Index shared = kOfGroup * static_cast<Index>(groups_);
    const Row row = row_of(track, seen, i);
    double left = seen.error[i] - row.head<kOfGroup>().dot(found.segment<kOfGroup>(
                                      kOfGroup * static_cast<Index>(track.group)));
    for (Index s = shared; s < found.size(); ++s) left -= row(kOfGroup + s - shared) * found(s);
    return left;
  }

  /// Each joint's errors by their scatter within a stroke, and by how alike neighbours are; and how
  /// far its strokes lie apart.
  void weigh(const std::vector<Residuals>& all, const VectorXd& found) {
    constexpr double kLeast_rad = 1e-7;  // with less, rounding tells what only backlash_rad_ does
    foreign_ = false;
    scatter_ = 0;
    double means = 0, by_chance = 0, strokes = 0;
    double taken = static_cast<double>(found.size()) - kOfGroup * static_cast<double>(groups_);
    for (std::size_t g = 0; g < groups_; ++g) {
      double squares = 0, whole = 0, next = 0, count = 0;
      std::vector<double> squares_of, speeds, of_strokes;
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (tracks_[k].group != g || all[k].error.empty()) continue;
        std::vector<double> left;
        for (std::size_t i = 0; i < all[k].error.size(); ++i)
          left.push_back(left_of(tracks_[k], all[k], i, found));
        const auto size = static_cast<double>(left.size());
        const double mean = std::accumulate(left.begin(), left.end(), 0.0) / size;
        const double by_told =
            std::hypot(tracks_[k].printed_rad, tracks_[k].stamps_s * all[k].usual_speed);
        for (std::size_t i = 0; i < left.size(); ++i) {
          const double off = left[i] - mean;
          squares += off * off;
          if (i > 0) next += off * (left[i - 1] - mean);
          whole += left[i] * left[i];
          squares_of.push_back(off * off);
          speeds.push_back(all[k].speed[i] * all[k].speed[i]);
        }
        count += size;
        const double spread = std::sin(tracks_[k].half_rad) / tracks_[k].half_rad;
        const double off = tracks_[k].off_home_rad, reach = tracks_[k].reach_mm;
        means +=
            ((mean * mean - by_told * by_told) / (1 + spread * spread) - off * off) * reach * reach;
        of_strokes.push_back(size / (reach * reach));
      }
      if (count == 0) continue;
      const double variance = squares / count + kLeast_rad * kLeast_rad;
      const double alike = std::clamp(next / (squares + 1e-300), 0.0, 0.98);
      foreign_ = foreign_ || whole / count > kForeign_rad * kForeign_rad;
      weight_[g] =
          two_clocks_ ? weight_by_speed(squares_of, speeds, variance) : AngleWeight{variance};
      weight_[g].alone = (1 - alike) / (1 + alike);
      scatter_ += count * std::log(variance);
      for (const double size : of_strokes) by_chance += variance / (weight_[g].alone * size);
      strokes += static_cast<double>(of_strokes.size());
      taken += both_ways_[g] ? 2 : 1;  // offset and backlash
    }
    const double now = strokes > taken ? std::max(0.0, means - by_chance) / (strokes - taken) : 0;
    // Half way, as what strokes are given they leave less of: else it goes to and fro.
    apart_mm2_ = apart_mm2_ > 0 ? (apart_mm2_ + now) / 2 : now;
  }

  /// Of all joints, by what was found of each and how uncertain that is: of those that turn as an
  /// angle; of a linear one by how far the target is off between there and back, whichever joint
  /// sweeps, as locked joints that stand elsewhere make it.
  void size_backlash(const VectorXd& found, const MatrixXd& covariance) {
    // A few joints tell little of how large backlash is; it counts as if one more had the usual.
    double of_turns = kUsualBacklash_rad * kUsualBacklash_rad, turns = 1;
    double of_all_mm2 = kUsualPlay_mm * kUsualPlay_mm, all = 1;
    for (std::size_t g = 0; g < groups_; ++g) {
      if (!both_ways_[g]) continue;
      const Index at = kOfGroup * static_cast<Index>(g) + kOrders;
      const double square = found(at) * found(at) + covariance(at, at);
      of_all_mm2 += square * track_of_[g]->reach_mm * track_of_[g]->reach_mm;
      ++all;
      if (track_of_[g]->linear) continue;
      of_turns += square;
      ++turns;
    }
    for (std::size_t g = 0; g < groups_; ++g)
      backlash_rad_[g] = std::max(kLeastBacklash_rad, track_of_[g]->linear
                                                          ? std::sqrt(of_all_mm2 / all) / kLinear_mm
                                                          : std::sqrt(of_turns / turns));
  }

  const std::vector<AngleTrack>& tracks_;
  std::size_t groups_;
  bool two_clocks_;
  std::vector<AngleWeight> weight_;  ///< one a group
  std::vector<bool> both_ways_;
  std::vector<const AngleTrack*> track_of_;  ///< one of each group
  /// Variance of each of the three at the target, beyond what was told. Locked joints that stand
  /// elsewhere move target and axis by as much whichever joint sweeps.
  double apart_mm2_ = 0;
  double scatter_ = 0;
  bool foreign_ = false;              ///< some joint's angles do not follow its positions
  std::vector<double> backlash_rad_;  ///< what each group's is like
  double span_s_ = 1;
  double last_step_s_ = 0;
  Delay delay_;
};

}  // namespace

std::optional<Delay> fitted_delay(const std::vector<AngleTrack>& tracks, bool two_clocks) {
  DelayFit growing(tracks, two_clocks), same(tracks, two_clocks);
  const std::optional<Delay> grows = growing.settled(true);
  if (grows && two_clocks) return grows;
  const std::optional<Delay> stays = same.settled(false);
  const bool seen = grows && std::abs(grows->rate) > kSignificantDelay * grows->rate_sigma;
  return seen && (!stays || growing.scatter() < same.scatter()) ? grows : stays;
}

}  // namespace identify
