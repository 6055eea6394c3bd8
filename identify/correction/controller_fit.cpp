#include "identify/correction/controller_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
#include "identify/poses/arm_columns.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = ControllerNumber::Kind;
using Verdict = ControllerNumber::Verdict;

/// Eigenvalues of the normal matrix with a diagonal of ones below this are of rounding.
constexpr double kNoInformation = 1e-10;
/// A part of a direction without information that counts.
constexpr double kShare = 1e-3;
constexpr double kStructure_mm = 1e-6;
constexpr double kStructure_rad = 1e-6;

bool right_angle(double angle_rad) {
  return std::abs(std::sin(2 * angle_rad)) < 2 * kStructure_rad;
}

std::vector<ControllerNumber> numbers_of(const Arm& arm, ControllerLevel level) {
  std::vector<ControllerNumber> numbers;
  const auto add = [&](Kind kind, std::size_t joint) {
    numbers.push_back({kind, joint, Verdict::significant});
  };
  if (level >= ControllerLevel::mastering)
    for (std::size_t j = 0; j < arm.joints(); ++j) add(Kind::zero, j);
  if (level < ControllerLevel::machine_data) return numbers;
  for (std::size_t j = 0; j < arm.joints(); ++j) {
    const DhRow& row = arm.rows[j];
    if (std::abs(row.b_mm) > kStructure_mm && !arm.is_linear(j)) add(Kind::b, j);
    if (std::abs(row.a_mm) > kStructure_mm) add(Kind::a, j);
    if (!right_angle(row.alpha_rad)) add(Kind::alpha, j);
  }
  return numbers;
}

Index column_of(const ControllerNumber& number, const ArmNumbers& columns) {
  switch (number.kind) {
    case Kind::zero:
      return columns.zero(number.joint);
    case Kind::b:
      return columns.b(number.joint);
    case Kind::a:
      return columns.a(number.joint);
    case Kind::alpha:
      return columns.alpha(number.joint);
  }
  return 0;
}

bool is_length(const ControllerNumber& number, const Arm& arm) {
  return number.kind == Kind::b || number.kind == Kind::a ||
         (number.kind == Kind::zero && arm.is_linear(number.joint));
}

double value_of(const ControllerNumber& number, const Arm& arm) {
  const DhRow& row = arm.rows[number.joint];
  switch (number.kind) {
    case Kind::zero:
      return arm.is_linear(number.joint) ? row.b_mm : row.theta_rad;
    case Kind::b:
      return row.b_mm;
    case Kind::a:
      return row.a_mm;
    case Kind::alpha:
      return row.alpha_rad;
  }
  return 0;
}

class LevelFitting {
 public:
  LevelFitting(const PlacedArm& start, const std::vector<Pose>& poses, const VectorXd& weights,
               const ModelUncertainty& model)
      : start_(start),
        poses_(poses),
        weights_(weights),
        model_(model),
        columns_{start.arm.joints(), start.targets_mm.size(), Freedom::twists} {}

  /// With these numbers let go beside base and targets.
  void fit(const std::vector<ControllerNumber*>& numbers) {
    free_ = free_of(numbers);
    arm_ = fitted(start_, columns_, free_, poses_, weights_);
    MatrixXd normal = MatrixXd::Zero(count(), count());
    MatrixXd by_model = MatrixXd::Zero(count(), model_.by_parameter.cols());
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const auto at = static_cast<Index>(i);
      const MatrixXd rows = arm_columns(arm_, poses_[i], columns_)(Eigen::all, free_);
      normal += weights_(at) * rows.transpose() * rows;
      if (by_model.cols() > 0)
        by_model += weights_(at) * rows.transpose() * model_.by_parameter.middleRows<3>(3 * at);
    }
    decompose(normal);
    by_model = covariance_ * by_model;
    const VectorXd distances = distances_mm(arm_, poses_);
    const double squares = weights_.dot(distances.cwiseAbs2());
    covariance_ *= squares / std::max(1.0, 3 * weights_.sum() - static_cast<double>(count()));
    covariance_ += by_model * model_.covariance * by_model.transpose();
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      ControllerNumber& number = *numbers[k];
      const bool length = is_length(number, start_.arm);
      const Index at = frames() + static_cast<Index>(k);
      number.change = value_of(number, arm_.arm) - value_of(number, start_.arm);
      number.sigma = std::sqrt(covariance_(at, at)) / (length ? 1 : kReach_mm);
      if (open_(at) > kShare) number.verdict = Verdict::inseparable;
    }
  }

  /// What was fitted last is all that the poses tell apart: what is fitted then, with numbers held
  /// that may be off after all, is as uncertain as that and as far as it has moved.
  void keep_as_whole() {
    whole_arm_ = arm_;
    whole_frames_covariance_ = covariance_.topLeftCorner(frames(), frames());
  }

  [[nodiscard]] ControllerFit result(std::vector<ControllerNumber> numbers) const {
    ControllerFit found;
    found.arm = arm_;
    found.numbers = std::move(numbers);
    std::vector<double> counted;
    const VectorXd distances = distances_mm(arm_, poses_);
    for (Index i = 0; i < distances.size(); ++i)
      if (weights_(i) > 0) counted.push_back(distances(i));
    found.left =
        left_of(Eigen::Map<const VectorXd>(counted.data(), static_cast<Index>(counted.size())));
    const VectorXd moved = frames_moved();
    found.frames_covariance = whole_frames_covariance_ + moved * moved.transpose();
    found.frames_covariance.middleRows<3>(3) /= kReach_mm;
    found.frames_covariance.middleCols<3>(3) /= kReach_mm;
    for (Index k = 0; k < frames(); ++k) found.frames_determined.push_back(open_(k) <= kShare);
    return found;
  }

 private:
  /// Base and targets from the whole fit to the last one.
  [[nodiscard]] VectorXd frames_moved() const {
    VectorXd moved(frames());
    const Eigen::AngleAxisd turn(arm_.base.linear() * whole_arm_.base.linear().transpose());
    moved << arm_.base.translation() - whole_arm_.base.translation(),
        kReach_mm * turn.angle() * turn.axis(), VectorXd::Zero(frames() - 6);
    for (std::size_t t = 0; t < arm_.targets_mm.size(); ++t)
      moved.segment<3>(6 + 3 * static_cast<Index>(t)) =
          arm_.targets_mm[t] - whole_arm_.targets_mm[t];
    return moved;
  }
  [[nodiscard]] Index frames() const { return columns_.zero(0); }
  [[nodiscard]] Index count() const { return static_cast<Index>(free_.size()); }

  [[nodiscard]] std::vector<Index> free_of(const std::vector<ControllerNumber*>& numbers) const {
    std::vector<Index> free(static_cast<std::size_t>(frames()));
    std::iota(free.begin(), free.end(), Index{0});
    for (const auto* number : numbers) free.push_back(column_of(*number, columns_));
    return free;
  }

  /// The inverse of the normal matrix over what carries information, and what share each number
  /// has in what carries none.
  void decompose(const MatrixXd& normal) {
    const VectorXd scale =
        normal.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
    const MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
    VectorXd inverse = solver.eigenvalues();
    open_ = VectorXd::Zero(normal.rows());
    for (Index i = 0; i < inverse.size(); ++i) {
      const bool known = inverse(i) > kNoInformation;
      inverse(i) = known ? 1 / inverse(i) : 0;
      if (!known) open_ = open_.cwiseMax(solver.eigenvectors().col(i).cwiseAbs());
    }
    covariance_ = scale.asDiagonal() * solver.eigenvectors() * inverse.asDiagonal() *
                  solver.eigenvectors().transpose() * scale.asDiagonal();
  }

  const PlacedArm& start_;
  const std::vector<Pose>& poses_;
  const VectorXd& weights_;
  const ModelUncertainty& model_;
  ArmNumbers columns_;
  std::vector<Index> free_;
  PlacedArm arm_, whole_arm_;
  MatrixXd whole_frames_covariance_;
  MatrixXd covariance_;  ///< of the columns of `free_`
  VectorXd open_;        ///< each column's largest part in a direction without information
};

std::vector<ControllerNumber*> those(std::vector<ControllerNumber>& all, Verdict verdict) {
  std::vector<ControllerNumber*> found;
  for (auto& number : all)
    if (number.verdict == verdict) found.push_back(&number);
  return found;
}

/// That a number which is right shows as much.
double chance_of(const ControllerNumber& number) {
  return std::erfc(std::abs(number.change) / number.sigma / std::sqrt(2.0));
}

/// Holm's step-down test of each number against zero, of so many that there were at first; the
/// least significant one comes last.
void judge(std::vector<ControllerNumber*>& numbers, std::size_t tested) {
  for (auto* number : numbers) number->chance = chance_of(*number);
  std::sort(numbers.begin(), numbers.end(),
            [](const auto* a, const auto* b) { return a->chance < b->chance; });
  double before = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    before = numbers[k]->chance =
        std::clamp(static_cast<double>(tested - k) * numbers[k]->chance, before, 1.0);
}

/// Lets go all that the poses tell apart, then less and less of it, as long as something may be
/// right as it is.
void choose(std::vector<ControllerNumber>& numbers, LevelFitting& fitting) {
  auto taken = those(numbers, Verdict::significant);
  for (std::size_t before = taken.size() + 1; taken.size() < before;) {
    before = taken.size();
    fitting.fit(taken);
    taken = those(numbers, Verdict::significant);
  }
  for (auto* number : those(numbers, Verdict::inseparable)) number->change = number->sigma = 0;
  fitting.keep_as_whole();
  const std::vector<ControllerNumber> whole = numbers;
  const std::size_t tested = taken.size();
  for (judge(taken, tested); !taken.empty() && taken.back()->chance >= kSignificant;
       judge(taken, tested)) {
    taken.back()->verdict = Verdict::not_significant;
    taken.pop_back();
    fitting.fit(taken);
  }
  // What makes up for a number that is left is not told by the poses: none is taken that is no more
  // than it is uncertain by so.
  for (;;) {
    ControllerNumber* least = nullptr;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      if (!numbers[k].taken()) continue;
      numbers[k].sigma = std::hypot(whole[k].sigma, numbers[k].change - whole[k].change);
      if (least == nullptr || chance_of(numbers[k]) > chance_of(*least)) least = &numbers[k];
    }
    if (least == nullptr || chance_of(*least) < kSignificant) return;
    least->chance = chance_of(*least);
    least->verdict = Verdict::not_significant;
    std::erase(taken, least);
    fitting.fit(taken);
  }
}

}  // namespace

ControllerFit fitted_controller(const PlacedArm& start, ControllerLevel level,
                                const std::vector<Pose>& poses, const VectorXd& weights,
                                const ModelUncertainty& model) {
  LevelFitting fitting(start, poses, weights, model);
  auto numbers = numbers_of(start.arm, level);
  choose(numbers, fitting);
  return fitting.result(std::move(numbers));
}

}  // namespace identify
