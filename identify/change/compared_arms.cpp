#include "identify/change/compared_arms.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/line.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kNumbers = 5;  // of a row
/// Homes that differ by less are one: a gear is off by the same there.
constexpr double kSameHome_rad = 0.5 * kDegree;
/// Gears are off once and twice a turn: beyond this way by no more.
constexpr double kGearGrows_rad = 90 * kDegree;

bool parallel(Relation relation) {
  return relation == Relation::parallel || relation == Relation::coincident;
}

bool is_angle(Index place) {
  return place % kNumbers == 1 || place % kNumbers > 2;
}

VectorXd numbers_of(const std::vector<DhRow>& rows) {
  VectorXd numbers(kNumbers * static_cast<Index>(rows.size()));
  Index at = 0;
  for (const DhRow& row : rows)
    for (const double value : {row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad, row.beta_rad})
      numbers(at++) = value;
  return numbers;
}

DhRow row_of(const VectorXd& numbers, std::size_t row) {
  const Index at = kNumbers * static_cast<Index>(row);
  return {numbers(at), numbers(at + 1), numbers(at + 2), numbers(at + 3), numbers(at + 4)};
}

/// One row of a table beside another's: which of the two senses of the common normal is closer.
double apart(const DhRow& row, const DhRow& other) {
  const double size = std::abs(other.a_mm) + std::abs(row.a_mm) + 1;
  return std::abs(row.a_mm - other.a_mm) / size +
         std::abs(wrapped(row.alpha_rad - other.alpha_rad));
}

/// What the form of both arms takes an axis to be to the next.
struct Step {
  Relation relation = Relation::skew;
  double b_mm = 0;  ///< by convention, of parallel axes
};

/// A table in the form that both arms share.
class Rewritten {
 public:
  /// `like`: rows that the common normals shall point as; none: as the table's own.
  Rewritten(const MeasuredArm& arm, const std::vector<Step>& steps, const std::vector<DhRow>& like)
      : arm_(arm), steps_(steps), table_(numbers_of(values(arm.dh))) {
    rows_ = written(table_, like, normals_);
  }

  [[nodiscard]] const std::vector<DhRow>& rows() const { return rows_; }

  /// The table's last frame in the last frame of these rows.
  [[nodiscard]] Isometry3d last_frame() const {
    Isometry3d old = Isometry3d::Identity();
    for (std::size_t i = 0; i + 1 < arm_.dh.size(); ++i) old = old * transform(row_of(table_, i));
    Isometry3d last = first_frame().pose();
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) last = last * transform(rows_[i]);
    return last.inverse(Eigen::Isometry) * old;
  }

  [[nodiscard]] MatrixXd covariance() const {
    constexpr double kStep_mm = 1e-3, kStep_rad = 1e-6;
    const Index count = table_.size();
    MatrixXd jacobian = MatrixXd::Zero(count, count);
    std::vector<Vector3d> normals = normals_;
    for (Index p = 0; p < count; ++p) {
      if (!(arm_.covariance(p, p) > 0)) continue;
      const double step = is_angle(p) ? kStep_rad : kStep_mm;
      const auto moved = [&](double by) {
        VectorXd table = table_;
        table(p) += by;
        return numbers_of(written(table, {}, normals));
      };
      VectorXd change = moved(step) - moved(-step);
      for (Index k = 0; k < count; ++k)
        if (is_angle(k)) change(k) = wrapped(change(k));
      jacobian.col(p) = change / (2 * step);
    }
    return jacobian * arm_.covariance * jacobian.transpose();
  }

 private:
  [[nodiscard]] AxisFrame first_frame() const {
    AxisFrame frame;
    frame.z *= arm_.positive.front();
    return frame;
  }

  /// With `normals` they point as these; without, they are chosen and told.
  [[nodiscard]] std::vector<DhRow> written(const VectorXd& table, const std::vector<DhRow>& like,
                                           std::vector<Vector3d>& normals) const {
    const std::size_t joints = arm_.dh.size();
    const bool choose = normals.empty();
    std::vector<DhRow> rows(joints);
    Isometry3d old = Isometry3d::Identity();
    AxisFrame frame = first_frame();
    for (std::size_t i = 0; i + 1 < joints; ++i) {
      old = old * transform(row_of(table, i));
      const Line next =
          Line::through(old.translation(), arm_.positive[i + 1] * old.linear().col(2));
      const auto step = [&](const Vector3d& near) {
        return step_to(frame, next, steps_[i].relation, near, steps_[i].b_mm);
      };
      if (choose) normals.push_back(old.linear().col(0));
      AxisStep taken = step(normals[i]);
      if (choose && !like.empty()) {
        const AxisStep other = step(-normals[i]);
        if (apart(other.row, like[i]) < apart(taken.row, like[i])) taken = other;
      }
      if (choose) normals[i] = taken.normal;
      rows[i] = taken.row;
      frame = taken.frame;
    }
    return rows;
  }

  const MeasuredArm& arm_;
  const std::vector<Step>& steps_;
  VectorXd table_;
  std::vector<Vector3d> normals_;
  std::vector<DhRow> rows_;
};

/// Along axes that are so close to parallel, b of two rows hardly tells anything by itself.
constexpr double kNearlyParallel_rad = 1 * kDegree;

bool nearly_parallel(const DhEstimate& row) {
  return parallel(row.relation) || std::abs(std::sin(row.alpha_rad.value)) < kNearlyParallel_rad;
}

/// Parallel where one of the two says so.
std::vector<Step> shared_steps(const MeasuredArm& first, const MeasuredArm& second) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i < first.dh.size(); ++i) {
    const Relation a = first.dh[i].relation, b = second.dh[i].relation;
    Step step;
    if (a == Relation::coincident || b == Relation::coincident)
      step.relation = Relation::coincident;
    else if (nearly_parallel(first.dh[i]) || nearly_parallel(second.dh[i]))
      step.relation = Relation::parallel;
    if (parallel(a))
      step.b_mm = first.positive[i] * first.dh[i].b_mm.value;
    else if (parallel(b))
      step.b_mm = second.positive[i] * second.dh[i].b_mm.value;
    steps.push_back(step);
  }
  return steps;
}

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
    if (apart < kSameHome_rad) return 0;
    const auto &a = first_.gear[joint], &b = second_.gear[joint];
    if (!a || !b) return std::nullopt;
    return std::min(apart, kGearGrows_rad) * std::max({*a, *b, usual_});
  }

 private:
  const MeasuredArm& first_;
  const MeasuredArm& second_;
  double usual_ = 0;
};

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
  const auto row = kNumbers * static_cast<Index>(joint);
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
  const Rewritten a(first, steps, {}), b(second, steps, a.rows());
  const MatrixXd of_first = a.covariance(), of_second = b.covariance();
  arms.rows = a.rows();
  arms.last_frame = a.last_frame();

  const Gears gears(first, second);
  bool from_base = true;  // all axes before are parallel: where along them is the base's
  bool after_coincident = false;
  for (std::size_t i = 0; i + 1 < joints; ++i) {
    using Kind = ArmNumberKind;
    const bool linear = first.dh[i].linear;
    const bool beside = parallel(steps[i].relation);
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
    take(Kind::alpha, false, false, coincident);
    if (beside) take(Kind::beta, false, false, coincident);
    from_base = from_base && beside;
    after_coincident = coincident;
  }

  const auto count = static_cast<Index>(arms.numbers.size());
  const auto selected = [&](const MatrixXd& all) {
    MatrixXd some(count, count);
    for (Index r = 0; r < count; ++r)
      for (Index c = 0; c < count; ++c)
        some(r, c) = all(arms.numbers[static_cast<std::size_t>(r)].place(),
                         arms.numbers[static_cast<std::size_t>(c)].place());
    return some;
  };
  arms.first_covariance = selected(of_first);
  arms.second_covariance = selected(of_second);
  const VectorXd all_first = numbers_of(a.rows()), all_second = numbers_of(b.rows());
  arms.first = arms.second = arms.difference = VectorXd::Zero(count);
  for (Index k = 0; k < count; ++k) {
    const ArmNumber& number = arms.numbers[static_cast<std::size_t>(k)];
    const std::size_t j = number.joint;
    arms.first(k) = all_first(number.place());
    arms.second(k) = all_second(number.place());
    if (number.kind == ArmNumberKind::zero) {
      const double unit = number.length ? kLinear_mm : 1;
      arms.first(k) -= unit * *first.home_rad[j];
      arms.second(k) -= unit * *second.home_rad[j];
      const double off = unit * *gears.off_rad(j);
      arms.second_covariance(k, k) += off * off;
      if (off > 0) arms.other_homes.push_back(j);
    }
    arms.difference(k) = arms.second(k) - arms.first(k);
    if (number.length) continue;
    arms.first(k) = wrapped(arms.first(k));
    arms.difference(k) = wrapped(arms.difference(k));
    arms.second(k) = arms.first(k) + arms.difference(k);
  }
  return arms;
}

}  // namespace identify
