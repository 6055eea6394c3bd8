#include "identify/dh_budget.hpp"

#include <array>

namespace identify {

using Eigen::Index;
using Eigen::MatrixXd;

void set_budget(Identification& found, const TableAxes& axes) {
  const std::size_t joints = found.dh.size();
  const auto count = static_cast<Index>(6 * joints);
  const std::vector<std::optional<Axis>> of_joints(
      axes.z.begin(), axes.z.begin() + static_cast<std::ptrdiff_t>(joints));
  MatrixXd jacobian = dh_jacobian(of_joints, axes.size_mm, found.specified);
  for (std::size_t i = 0; i < joints; ++i) {
    const auto numbers = numbers_of(found.dh[i]);
    for (std::size_t k = 0; k < numbers.size(); ++k)
      if (numbers[k]->knowledge != Knowledge::identified)
        jacobian.row(static_cast<Index>(5 * i + k)).setZero();
  }
  jacobian *= axes.by_estimate.topRows(count);
  const auto of_numbers = [&](const MatrixXd& covariance) -> MatrixXd {
    return jacobian * covariance * jacobian.transpose();
  };
  found.dh_covariance = of_numbers(found.chain->covariance);
  found.dh_budget.clear();
  for (const ChainEstimate::Part& part : found.chain->parts)
    found.dh_budget.push_back({part.cause, of_numbers(part.covariance).diagonal()});
}

}  // namespace identify
