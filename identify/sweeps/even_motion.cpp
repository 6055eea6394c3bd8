#include "identify/sweeps/even_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

namespace identify {

using Eigen::ArrayXd;
using Eigen::Index;

EvenMotion::EvenMotion(const ArrayXd& times) : shares_(kWide, times.size()) {
  if (times.size() < kWide) return;
  for (Index i = 0; i < times.size(); ++i) {
    const Line since = times.segment<kWide>(begin(i)) - times(i);
    const Line off = since - since.mean();
    const double squares = off.square().sum();
    shares_.col(i) = 1.0 / kWide - (squares > 0 ? since.mean() / squares : 0) * off;
  }
}

ArrayXd EvenMotion::operator()(const ArrayXd& seen) const {
  if (seen.size() < kWide) return seen;
  ArrayXd even(seen.size());
  for (Index i = 0; i < seen.size(); ++i)
    even(i) = (shares_.col(i) * seen.segment<kWide>(begin(i))).sum();
  return even;
}

double EvenMotion::noise() const {
  return shares_.cols() < kWide ? 1 : 1 / std::sqrt(static_cast<double>(kWide));
}

Index EvenMotion::begin(Index sample) const {
  return std::clamp<Index>(sample - kWide / 2, 0, shares_.cols() - kWide);
}

namespace {

/// Squares of by how much the speed changes about a sample, and of the second difference there.
struct Change {
  double around = 0;
  double here = 0;
};

std::vector<Change> changes_of(const ArrayXd& numbers) {
  constexpr Index kAround = 4;  // samples on each side
  const Index around = std::clamp<Index>((numbers.size() - 3) / 4, 0, kAround);
  const auto step = [&](Index i) { return numbers(i + 1) - numbers(i); };
  std::vector<Change> changes;
  for (Index i = 1 + around; i + 1 + around < numbers.size(); ++i)
    changes.push_back(
        {std::pow(step(i + around) - step(i - 1 - around), 2), std::pow(step(i) - step(i - 1), 2)});
  return changes;
}

/// The element before which this share of them lies, those that are less.
template <class Members>
auto least(std::vector<Change>& changes, double share, Members member) {
  const auto at =
      changes.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(changes.size()));
  std::nth_element(changes.begin(), at, changes.end(), [&](const Change& one, const Change& other) {
    return one.*member < other.*member;
  });
  return at;
}

}  // namespace

double unevenness(const ArrayXd& numbers) {
  // Of an even motion second differences are those of the noise, whose variance they have six
  // times. Where it gets to speed they are not: so many count, about which the speed changes least.
  constexpr double kEven = 1.0 / 3;
  // Nor where samples are missing, a tenth at most. Nine tenths of normal ones' squares have 0.623
  // of the mean: those beyond five standard deviations do not count.
  constexpr double kUsual = 0.9, kFar = 25 / 0.623;
  std::vector<Change> changes = changes_of(numbers);
  if (changes.empty()) return 0;
  changes.erase(std::next(least(changes, kEven, &Change::around)), changes.end());
  const auto usual = least(changes, kUsual, &Change::here);
  double sum = 0, count = 0;
  const auto add = [&](const Change& change) {
    sum += change.here;
    ++count;
  };
  std::for_each(changes.begin(), usual, add);
  const double far = count > 0 ? kFar * sum / count : 0;
  std::for_each(usual, changes.end(), [&](const Change& change) {
    if (change.here <= far) add(change);
  });
  return count > 0 ? sum / count / 6 : 0;
}

}  // namespace identify
