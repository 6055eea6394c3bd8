#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/change/measured_arm.hpp"

namespace identify {

/// Numbers that neither conventions nor the measurement frame change. `zero` is theta (of a linear
/// joint b) at home minus the controller's value there: a joint that lost its mastering changes it.
/// `theta` is that of a linear joint's row, which its home does not change.
enum class ArmNumberKind { b, zero, theta, a, alpha, beta };
[[nodiscard]] std::string_view text(ArmNumberKind kind) noexcept;

struct ArmNumber {
  ArmNumberKind kind = ArmNumberKind::b;
  std::size_t joint = 0;  ///< counted from 0
  bool length = true;     ///< mm, else rad

  [[nodiscard]] Eigen::Index place() const;  ///< among the five of each row
};

/// Why a number cannot be compared.
enum class LeftOutBecause {
  frame,       ///< tells where the base or the tool stands
  no_home,     ///< the controller's angle at home is not known of both
  other_home,  ///< the homes are apart, and nothing tells what the gear is off by there
  convention,  ///< one of the two has it by convention
};

/// Two arms written down in the same way, see `RewrittenArm`.
struct ComparedArms {
  struct LeftOut {
    ArmNumber number;
    LeftOutBecause because{};
  };
  std::vector<ArmNumber> numbers;
  std::vector<LeftOut> left_out;
  Eigen::VectorXd first, second;  ///< their numbers; angles in (-pi, pi]
  Eigen::VectorXd difference;     ///< second minus first, angles wrapped
  Eigen::MatrixXd first_covariance, second_covariance;
  /// By how much higher along its first axis the second arm's base is taken than its table has it:
  /// where the two agree best. How open that is is in the second covariance. Nothing where both
  /// tell it, or have it by one description.
  std::optional<double> height_mm;
  /// Where both have it by one description: so far it is open, which is in the second covariance.
  double height_open_mm = 0;
  /// Joints whose homes are apart: what their gears are off by there is in the second covariance.
  std::vector<std::size_t> other_homes;

  /// The first arm's table at its home in that form; the last row is zero.
  std::vector<DhRow> rows;
  /// Of the first table's last frame in the last frame of `rows`.
  Eigen::Isometry3d last_frame = Eigen::Isometry3d::Identity();

  /// Of the difference; the two are taken for independent.
  [[nodiscard]] Eigen::MatrixXd covariance() const { return first_covariance + second_covariance; }
};

/// For arms with as many joints, of the same types.
[[nodiscard]] ComparedArms compared(const MeasuredArm& first, const MeasuredArm& second);

}  // namespace identify
