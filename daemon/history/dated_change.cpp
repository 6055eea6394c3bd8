#include "daemon/history/dated_change.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>
#include <boost/math/distributions/students_t.hpp>

namespace sweepd {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostRounds = 40;
/// A drift of fewer is a jump.
constexpr std::size_t kFewestDrifting = 4;
/// Half the limit of chi squared, of a date.
constexpr double kAsGood = 3.84;
/// Of a change's weight: what the means and the other changes do not explain as well.
constexpr double kLeastShare = 1e-6;

/// One at a time is looked for among all numbers, campaigns and kinds.
class ChangeSearch {
 public:
  ChangeSearch(const NumberSeries& series, double level)
      : series_(series),
        count_(series.values.size()),
        numbers_(series.values.front().size()),
        level_(level),
        student_(std::clamp(series.degrees, 1.0, 1e6)) {
    for (const VectorXd& value : series.values)
      values_.push_back(value.array().isNaN().select(0, value));
  }

  std::vector<DatedChange> run() {
    fit();
    std::vector<bool> exhausted(static_cast<std::size_t>(numbers_), false);
    for (std::size_t round = 0; round < kMostRounds; ++round) {
      const auto next = likeliest(exhausted);
      if (!next) break;
      const auto before = changes_;
      changes_.push_back(*next);
      settle();
      if (std::any_of(changes_.begin(), changes_.end(),
                      [&](const DatedChange& change) { return !(change.p < level_); })) {
        changes_ = before;
        fit();
        exhausted[next->number] = true;
      }
    }
    auto found = changes_;
    for (std::size_t a = 0; a < found.size(); ++a) set_dates(found[a], a);
    std::sort(found.begin(), found.end(), [](const DatedChange& one, const DatedChange& other) {
      return one.at != other.at ? one.at < other.at : one.number < other.number;
    });
    return found;
  }

 private:
  struct Score {
    double square = 0;  // of the size in its standard deviations
    double size = 0;
  };

  [[nodiscard]] double shape(ChangeKind kind, std::size_t at, std::size_t i) const {
    if (kind == ChangeKind::odd) return i == at ? 1 : 0;
    if (i < at) return 0;
    return kind == ChangeKind::jump ? 1 : series_.times[i] - series_.times[at];
  }
  [[nodiscard]] double shape(const DatedChange& change, std::size_t i) const {
    return shape(change.kind, change.at, i);
  }

  /// Means of all numbers and sizes of all changes, with the residuals that they leave.
  void fit() {
    const auto size = numbers_ + static_cast<Index>(changes_.size());
    MatrixXd normal = MatrixXd::Zero(size, size);
    VectorXd right = VectorXd::Zero(size);
    for (std::size_t i = 0; i < count_; ++i) {
      const MatrixXd& weight = series_.weights[i];
      const VectorXd weighted = weight * values_[i];
      normal.topLeftCorner(numbers_, numbers_) += weight;
      right.head(numbers_) += weighted;
      for (std::size_t a = 0; a < changes_.size(); ++a) {
        const double of_a = shape(changes_[a], i);
        if (of_a == 0) continue;
        const auto row = numbers_ + static_cast<Index>(a), k = number(changes_[a]);
        right(row) += of_a * weighted(k);
        normal.row(row).head(numbers_) += of_a * weight.row(k);
        for (std::size_t b = 0; b <= a; ++b)
          normal(row, numbers_ + static_cast<Index>(b)) +=
              of_a * shape(changes_[b], i) * weight(k, number(changes_[b]));
      }
    }
    normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
    // A number that no campaign has.
    for (Index k = 0; k < size; ++k)
      if (!(normal(k, k) > 0)) normal(k, k) = 1;
    normal_.compute(normal);
    const VectorXd solution = normal_.solve(right);
    residuals_.clear();
    for (std::size_t i = 0; i < count_; ++i) {
      VectorXd residual = values_[i] - solution.head(numbers_);
      for (std::size_t a = 0; a < changes_.size(); ++a)
        residual(number(changes_[a])) -=
            shape(changes_[a], i) * solution(numbers_ + static_cast<Index>(a));
      residuals_.push_back(series_.weights[i] * residual);
    }
    const MatrixXd covariance = normal_.solve(MatrixXd::Identity(size, size));
    for (std::size_t a = 0; a < changes_.size(); ++a) {
      const auto at = numbers_ + static_cast<Index>(a);
      changes_[a].size = solution(at);
      changes_[a].sigma =
          std::sqrt(std::max(0.0, covariance(at, at)) * shared(number(changes_[a])));
      changes_[a].p =
          changes_[a].sigma > 0 ? chance(std::pow(changes_[a].size / changes_[a].sigma, 2)) : 1;
    }
  }

  /// How much more sums of successive weighted residuals scatter than those of independent
  /// campaigns do: the most of all lengths, 1 at least.
  [[nodiscard]] double shared(Index k) const {
    std::vector<double> sums{0}, sizes{0};
    for (std::size_t i = 0; i < count_; ++i) {
      sums.push_back(sums.back() + residuals_[i](k));
      sizes.push_back(sizes.back() + series_.weights[i](k, k));
    }
    double most = 1;
    for (std::size_t length = 1; 8 * length <= count_; length += 1 + length / 4) {
      double squares = 0, expected = 0;
      for (std::size_t end = length; end <= count_; ++end) {
        squares += std::pow(sums[end] - sums[end - length], 2);
        expected += sizes[end] - sizes[end - length];
      }
      if (expected > 0) most = std::max(most, squares / expected);
    }
    return most;
  }

  /// Of all that is looked for.
  [[nodiscard]] double chance(double square) const {
    const double looked = static_cast<double>(numbers_) * static_cast<double>(3 * count_);
    return std::min(1.0, looked * 2 * cdf(complement(student_, std::sqrt(square))));
  }

  /// Calls `tell` with each kind and campaign at which a number may change, and its score. All
  /// numbers, or `only` one.
  template <typename Tell>
  void score_all(const Tell& tell, std::optional<Index> only = {}) const {
    const Index size = normal_.rows(), first = only.value_or(0), many = only ? 1 : numbers_;
    struct Sums {
      VectorXd scores;   // of each number: weighted residuals
      VectorXd squares;  // its weight
      MatrixXd across;   // with the means and the changes that are there
    };
    const Sums nothing{VectorXd::Zero(many), VectorXd::Zero(many), MatrixXd::Zero(size, many)};
    const auto evaluate = [&](ChangeKind kind, std::size_t at, const Sums& sums) {
      const MatrixXd root = normal_.matrixL().solve(sums.across);
      const VectorXd information = sums.squares - root.colwise().squaredNorm().transpose();
      for (Index k = 0; k < many; ++k)
        if (information(k) > kLeastShare * sums.squares(k))
          tell(kind, at, first + k,
               Score{sums.scores(k) * sums.scores(k) / information(k),
                     sums.scores(k) / information(k)});
    };
    Sums steps = nothing, rising = nothing, squared = nothing;  // sums of 1, t and t t
    for (std::size_t at = count_; at-- > 0;) {
      const MatrixXd& weight = series_.weights[at];
      const double time = series_.times[at];
      Sums one{residuals_[at].segment(first, many), weight.diagonal().segment(first, many),
               MatrixXd(size, many)};
      one.across.topRows(numbers_) = weight.middleCols(first, many);
      for (std::size_t a = 0; a < changes_.size(); ++a)
        one.across.row(numbers_ + static_cast<Index>(a)) =
            shape(changes_[a], at) * weight.row(number(changes_[a])).segment(first, many);
      const auto add = [&](Sums& to, double factor) {
        to.scores += factor * one.scores;
        to.squares += factor * one.squares;
        to.across += factor * one.across;
      };
      add(steps, 1);
      add(rising, time);
      add(squared, time * time);
      evaluate(ChangeKind::odd, at, one);
      if (at > 0 && at + 1 < count_) evaluate(ChangeKind::jump, at, steps);
      if (at + kFewestDrifting <= count_)
        evaluate(ChangeKind::drift, at,
                 Sums{rising.scores - time * steps.scores,
                      squared.squares - 2 * time * rising.squares + time * time * steps.squares,
                      rising.across - time * steps.across});
    }
  }

  [[nodiscard]] std::optional<DatedChange> likeliest(const std::vector<bool>& exhausted) const {
    DatedChange best;
    double most = 0;
    score_all([&](ChangeKind kind, std::size_t at, Index k, const Score& score) {
      if (exhausted[static_cast<std::size_t>(k)] || !(score.square > most)) return;
      most = score.square;
      best = {kind, static_cast<std::size_t>(k), at, at, at, score.size, 0, 1};
    });
    if (!(most > 0) || !(chance(most) < level_)) return std::nullopt;
    return best;
  }

  /// Each change moved, and made of another kind, where the others then leave it a better place;
  /// those that nothing is left of go.
  void settle() {
    for (int round = 0; round < 2; ++round)
      for (std::size_t a = 0; a < changes_.size(); ++a) {
        const DatedChange before = changes_[a];
        changes_.erase(changes_.begin() + static_cast<std::ptrdiff_t>(a));
        fit();
        DatedChange best = before;
        double most = -1;
        score_all(
            [&](ChangeKind kind, std::size_t at, Index k, const Score& score) {
              if (static_cast<std::size_t>(k) != before.number || !(score.square > most)) return;
              most = score.square;
              best = {kind, before.number, at, at, at, score.size, 0, 1};
            },
            number(before));
        changes_.insert(changes_.begin() + static_cast<std::ptrdiff_t>(a), best);
        fit();
      }
    const auto last = changes_.back();
    std::erase_if(changes_, [&](const DatedChange& change) {
      return !(change.p < level_) && (change.number != last.number || change.at != last.at);
    });
    fit();
  }

  /// `found` is the change at `place`, once all are there.
  void set_dates(DatedChange& found, std::size_t place) {
    if (found.kind == ChangeKind::odd) return;
    const auto all = changes_;
    const double scatter = shared(number(found));
    changes_.erase(changes_.begin() + static_cast<std::ptrdiff_t>(place));
    fit();
    double most = 0;
    std::vector<double> squares(count_, 0);
    score_all(
        [&](ChangeKind kind, std::size_t at, Index, const Score& score) {
          if (kind != found.kind) return;
          squares[at] = score.square;
          most = std::max(most, score.square);
        },
        number(found));
    for (std::size_t at = 0; at < count_; ++at)
      if (squares[at] > most - kAsGood * scatter) {
        found.earliest = std::min(found.earliest, at);
        found.latest = std::max(found.latest, at);
      }
    changes_ = all;
    fit();
  }

  static Index number(const DatedChange& change) { return static_cast<Index>(change.number); }

  const NumberSeries& series_;
  std::size_t count_;
  Index numbers_;
  double level_;
  boost::math::students_t student_;
  std::vector<VectorXd> values_;
  std::vector<DatedChange> changes_;
  Eigen::LLT<MatrixXd> normal_;
  std::vector<VectorXd> residuals_;  // weighted
};

}  // namespace

std::vector<DatedChange> dated_changes(const NumberSeries& series, double level) {
  if (series.values.size() < 3) return {};
  return ChangeSearch(series, level).run();
}

}  // namespace sweepd
