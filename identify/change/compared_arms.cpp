#include "identify/change/compared_arms.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <Eigen/Cholesky>

#include "identify/change/rewritten_arm.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/sweeps/home.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Gears are off once and twice a turn: beyond this way by no more.
constexpr double kGearGrows_rad = 90 * kDegree;

/// How gears are off, to be found at another home: what one joint shows depends on where in its
/// turn home is, so no less than the joints of both arms do on average.
class Gears {
 public:
  Gears(const MeasuredArm& first, const MeasuredArm& second) : first_(first), second_(second) {
    double squares = 0, count = 0;
    for (const MeasuredArm* arm : {&first, &second})
      for (const auto& gear : arm->gear)
        if (gear) {
          squares += *gear * *gear;
          ++count;
        }
    usual_ = count > 0 ? std::sqrt(squares / count) : 0;
  }
  /// For homes that are known: 0 where they are one; nothing where nobody knows.
  [[nodiscard]] std::optional<double> off_rad(std::size_t joint) const {
    const double apart = std::abs(*second_.home_rad[joint] - *first_.home_rad[joint]);
    if (apart < kSameHome_rad) return 0;  // a gear is off by the same there
    const auto &a = first_.gear[joint], &b = second_.gear[joint];
    if (!a || !b) return std::nullopt;
    return std::min(apart, kGearGrows_rad) * std::max({*a, *b, usual_});
  }

 private:
  const MeasuredArm& first_;
  const MeasuredArm& second_;
  double usual_ = 0;
};

VectorXd wrapped_angles(VectorXd values, const std::vector<ArmNumber>& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (double& value = values(static_cast<Index>(k)); !numbers[k].length) value = wrapped(value);
  return values;
}

void set_difference(ComparedArms& arms) {
  arms.first = wrapped_angles(arms.first, arms.numbers);
  arms.difference = wrapped_angles(arms.second - arms.first, arms.numbers);
  arms.second = arms.first + arms.difference;
}

/// How far apart along parallel first axes two devices' frames may have the base.
constexpr double kHeight_mm = 1e4;
/// The same where one description has both: as far as targets are off on the tool.
constexpr double kHeightByTool_mm = 300;
/// A height counts as uncertain by so much more than the numbers tell of it: all that it can take
/// up, and no more than the test of all numbers can bear (kLeastEigenvalue in `ChangeTest`).
constexpr double kHeightOpen = 30;

/// Whether both tables have the base as high as one description says.
bool described_alike(const MeasuredArm& first, const MeasuredArm& second) {
  const std::size_t rows = first.dh.size();
  if (first.specified.size() < rows || second.specified.size() < rows) return false;
  for (std::size_t i = 0; i < rows; ++i)  // b of a linear joint is that at home
    if (!first.dh[i].linear && first.specified[i].b_mm != second.specified[i].b_mm) return false;
  return true;
}

/// By mm of the second arm's height.
VectorXd slope_of(const ComparedArms& arms, const std::function<VectorXd(double height_mm)>& change,
                  double height_mm) {
  constexpr double kNudge_mm = 1;
  return wrapped_angles(change(height_mm + kNudge_mm) - change(height_mm - kNudge_mm),
                        arms.numbers) /
         (2 * kNudge_mm);
}

/// Takes the second arm at the height at which both agree best (Gauss-Newton), and what that can
/// take up of the differences as uncertain. `change`: of the second's numbers with its height.
void find_height(ComparedArms& arms, const std::function<VectorXd(double height_mm)>& change) {
  constexpr double kPrior = 1 / (kHeight_mm * kHeight_mm);
  const VectorXd first_difference = arms.difference;
  const auto difference = [&](double height_mm) {
    return wrapped_angles(first_difference + change(height_mm), arms.numbers);
  };
  const VectorXd weights = arms.covariance().diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<MatrixXd> correlation(weights.asDiagonal() * arms.covariance() *
                                          weights.asDiagonal());
  double height = 0, information = 0, step = 0;
  VectorXd slope;
  int rounds = 10;
  do {
    slope = slope_of(arms, change, height);
    const VectorXd weighed = weights.cwiseProduct(correlation.solve(weights.cwiseProduct(slope)));
    information = weighed.dot(slope) + kPrior;
    step = -(weighed.dot(difference(height)) + kPrior * height) / information;
    height += step;
  } while (std::abs(step) * std::sqrt(information) > 1e-3 && --rounds > 0);
  arms.height_mm = height;
  arms.second += difference(height) - first_difference;
  set_difference(arms);
  const double open = std::min(kHeight_mm, kHeightOpen / std::sqrt(information));
  arms.second_covariance += open * open * slope * slope.transpose();
}

/// Beyond what differentiating leaves of a number that convention sets.
bool is_known(const ArmNumber& number, const MatrixXd& covariance) {
  return covariance(number.place(), number.place()) > (number.length ? 1e-18 : 1e-24);
}

}  // namespace

std::string_view text(ArmNumberKind kind) noexcept {
  switch (kind) {
    case ArmNumberKind::b:
      return "b";
    case ArmNumberKind::zero:
      return "zero";
    case ArmNumberKind::theta:
      return "theta";
    case ArmNumberKind::a:
      return "a";
    case ArmNumberKind::alpha:
      return "alpha";
    case ArmNumberKind::beta:
      return "beta";
  }
  return "";
}

Index ArmNumber::place() const {
  const auto row = static_cast<Index>(kDhNumbers.size() * joint);
  switch (kind) {
    case ArmNumberKind::b:
      return row;
    case ArmNumberKind::zero:
      return length ? row : row + 1;
    case ArmNumberKind::theta:
      return row + 1;
    case ArmNumberKind::a:
      return row + 2;
    case ArmNumberKind::alpha:
      return row + 3;
    case ArmNumberKind::beta:
      return row + 4;
  }
  return row;
}

ComparedArms compared(const MeasuredArm& first, const MeasuredArm& second) {
  ComparedArms arms;
  const std::size_t joints = first.dh.size();
  if (joints < 2) return arms;
  const auto steps = shared_steps(first, second);
  const auto second_steps = at_home_of(second, first, steps);
  const RewrittenArm a(first, steps, {}), b(second, second_steps, a.rows());
  const MatrixXd of_first = a.covariance(), of_second = b.covariance();
  arms.rows = a.rows();
  arms.last_frame = a.last_frame();

  const Gears gears(first, second);
  bool from_base = true;  // all axes before are parallel: where along them is the base's
  bool after_coincident = false;
  for (std::size_t i = 0; i + 1 < joints; ++i) {
    using Kind = ArmNumberKind;
    const bool linear = first.dh[i].linear;
    const bool beside = steps[i].parallel();
    const bool coincident = steps[i].relation == Relation::coincident;
    const auto take = [&](Kind kind, bool length, bool of_frame, bool conventional) {
      const ArmNumber number{kind, i, length};
      const bool no_home = kind == Kind::zero && (!first.home_rad[i] || !second.home_rad[i]);
      if (of_frame)
        arms.left_out.push_back({number, LeftOutBecause::frame});
      else if (conventional || !is_known(number, of_first) || !is_known(number, of_second))
        arms.left_out.push_back({number, LeftOutBecause::convention});
      else if (no_home)
        arms.left_out.push_back({number, LeftOutBecause::no_home});
      else if (kind == Kind::zero && !gears.off_rad(i))
        arms.left_out.push_back({number, LeftOutBecause::other_home});
      else
        arms.numbers.push_back(number);
    };
    if (!beside) take(linear ? Kind::zero : Kind::b, true, from_base, after_coincident);
    take(linear ? Kind::theta : Kind::zero, false, i == 0, coincident || after_coincident);
    take(Kind::a, true, false, coincident);
    // Where a linear joint's axis lies is open, and where it points is not.
    const bool points = linear && i > 0;
    take(Kind::alpha, false, false, coincident && !points);
    if (beside) take(Kind::beta, false, false, coincident && !points);
    from_base = from_base && beside;
    after_coincident = coincident;
  }

  std::vector<Index> places;
  for (const ArmNumber& number : arms.numbers) places.push_back(number.place());
  arms.first_covariance = of_first(places, places);
  arms.second_covariance = of_second(places, places);
  arms.first = a.numbers()(places);
  arms.second = b.numbers()(places);
  for (Index k = 0; k < arms.first.size(); ++k) {
    const ArmNumber& number = arms.numbers[static_cast<std::size_t>(k)];
    if (number.kind != ArmNumberKind::zero) continue;
    const double unit = number.length ? kLinear_mm : 1;
    arms.first(k) -= unit * *first.home_rad[number.joint];
    arms.second(k) -= unit * *second.home_rad[number.joint];
    const double off = unit * *gears.off_rad(number.joint);
    arms.second_covariance(k, k) += off * off;
    if (off > 0) arms.other_homes.push_back(number.joint);
  }
  set_difference(arms);
  if (!steps.front().parallel() || (first.height_known && second.height_known)) return arms;
  const auto change = [&](double height_mm) -> VectorXd {
    auto higher = second_steps;
    higher.front().b_mm += height_mm;
    return RewrittenArm(second, higher, a.rows()).numbers()(places) - b.numbers()(places);
  };
  if (described_alike(first, second)) {
    arms.height_open_mm = kHeightByTool_mm;
    const VectorXd open = arms.height_open_mm * slope_of(arms, change, 0);
    arms.second_covariance += open * open.transpose();
  } else {
    find_height(arms, change);
  }
  return arms;
}

}  // namespace identify
