#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace identify {

/// One row for each number that samples have, one column a sample: what is done to all samples goes
/// along the rows.
using SampleRows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Sets the rows to Chebyshev polynomials of x in [-1, 1], the first row times each.
template <class Rows>
void set_chebyshev(Rows&& polynomials, const Eigen::Ref<const Eigen::ArrayXd>& x) {
  for (Eigen::Index m = 1; m < polynomials.rows(); ++m) {
    polynomials.row(m) = polynomials.row(m - 1) * x.transpose();
    if (m > 1) polynomials.row(m) = 2 * polynomials.row(m) - polynomials.row(m - 2);
  }
}

/// A stroke's own smooth curve: least squares by Chebyshev polynomials of the turn.
class StrokeCurve {
 public:
  StrokeCurve(const Eigen::ArrayXd& turns, double from, double to, Eigen::Index orders);
  [[nodiscard]] Eigen::Index orders() const { return basis_.rows(); }
  /// How much each sample counts from now on.
  void weigh(const Eigen::ArrayXd& weights);
  /// What the curve leaves of `errors`.
  [[nodiscard]] SampleRows left(const Eigen::Ref<const SampleRows>& errors) const;

 private:
  SampleRows basis_;
  Eigen::ArrayXd weights_;
  Eigen::LDLT<Eigen::MatrixXd> normal_;
};

/// Distances of errors, in standard deviations of the median one; of their rows the farthest
/// counts: what a locked joint's wobble does is in more than one. Standard deviations are taken for
/// no less than `least` of the first two rows, which are across the stroke, and `least_of_told` of
/// the third: more than half of printed numbers may be the same, and others a step beside are no
/// worse.
[[nodiscard]] Eigen::ArrayXd distances_of(const Eigen::Ref<const SampleRows>& errors, double least,
                                          double least_of_told = 0);

/// Redescending weights by these distances in so many directions, `wide` times as far as good
/// samples need.
[[nodiscard]] Eigen::ArrayXd weights_of(const Eigen::ArrayXd& distances, Eigen::Index directions,
                                        double wide);

}  // namespace identify
