#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace identify {

/// `count` of the candidates that together tell most: D-optimal, by adding the best one after the
/// other and then exchanging as long as that helps (Fedorov, Theory of Optimal Experiments, 1972).
/// A candidate is its rows by the parameters, each row divided by its standard deviation, the
/// columns of about the same size. Sorted. All candidates where there are no more than `count`.
[[nodiscard]] std::vector<std::size_t> d_optimal(const std::vector<Eigen::MatrixXd>& candidates,
                                                 std::size_t count);

}  // namespace identify
