#include "identify/poses/pose_design.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Before the first poses nothing is determined: so much of what all candidates tell is.
constexpr double kBefore = 1e-6;
constexpr int kMostPasses = 10;
constexpr double kWorthwhile = 1e-6;

/// By how much the candidate multiplies the determinant (Sylvester).
double gain(const MatrixXd& candidate, const MatrixXd& inverse) {
  MatrixXd inner = candidate * inverse * candidate.transpose();
  inner.diagonal().array() += 1;
  return inner.determinant();
}

class Design {
 public:
  explicit Design(const std::vector<MatrixXd>& candidates)
      : candidates_(candidates), taken_(candidates.size(), false) {
    const Index parameters = candidates.front().cols();
    MatrixXd all = MatrixXd::Zero(parameters, parameters);
    for (const MatrixXd& candidate : candidates) all += candidate.transpose() * candidate;
    normal_ = MatrixXd::Identity(parameters, parameters) *
              std::max(kBefore * all.trace() / static_cast<double>(parameters), 1e-300);
  }

  void add_best() { put(best(inverse()).first); }

  /// One exchange for each that is in; false where none helped.
  bool exchange() {
    bool better = false;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (!taken_[k]) continue;
      take_out(k);
      const MatrixXd without = inverse();
      const auto [other, most] = best(without);
      const bool helps = most > (1 + kWorthwhile) * gain(candidates_[k], without);
      put(helps ? other : k);
      better = better || helps;
    }
    return better;
  }

  [[nodiscard]] std::vector<std::size_t> taken() const {
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < taken_.size(); ++k)
      if (taken_[k]) all.push_back(k);
    return all;
  }

 private:
  [[nodiscard]] MatrixXd inverse() const {
    return normal_.ldlt().solve(MatrixXd::Identity(normal_.rows(), normal_.cols()));
  }
  [[nodiscard]] std::pair<std::size_t, double> best(const MatrixXd& inverse) const {
    std::pair<std::size_t, double> most{0, 0};
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (taken_[k]) continue;
      const double by = gain(candidates_[k], inverse);
      if (by > most.second) most = {k, by};
    }
    return most;
  }
  void put(std::size_t k) {
    taken_[k] = true;
    normal_ += candidates_[k].transpose() * candidates_[k];
  }
  void take_out(std::size_t k) {
    taken_[k] = false;
    normal_ -= candidates_[k].transpose() * candidates_[k];
  }

  const std::vector<MatrixXd>& candidates_;
  std::vector<bool> taken_;
  MatrixXd normal_;
};

}  // namespace

std::vector<std::size_t> d_optimal(const std::vector<MatrixXd>& candidates, std::size_t count) {
  std::vector<std::size_t> all(candidates.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  if (candidates.size() <= count) return all;
  Design design(candidates);
  for (std::size_t k = 0; k < count; ++k) design.add_best();
  for (int pass = 0; pass < kMostPasses && design.exchange(); ++pass) {
  }
  return design.taken();
}

}  // namespace identify
