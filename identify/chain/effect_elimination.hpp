#pragma once

#include <cstddef>
#include <list>
#include <vector>

#include <Eigen/Core>

namespace identify {

/// One stroke's share in the normal equations: the weighted sums of products of all columns that it
/// knows, C^T W C with C = (own, stand's, shared, home's, parameters, y). Random effects are
/// nested: a stroke belongs to one stand, whose strokes share effects, a stand to one group, and a
/// group to one home, likewise.
struct StrokeProducts {
  Eigen::MatrixXd products;  ///< square, symmetric: the lower triangle counts
  std::size_t stand = 0;     ///< one stroke after the other, in any order
  /// Which its columns are of the home's effects and then, counted on, of all parameters.
  /// Ascending.
  std::vector<Eigen::Index> outer;
};

/// Variances of the random effects: an effect a row, in the order of the products' columns; one of
/// size 0 does nothing.
struct EffectVariances {
  Eigen::MatrixXd own;     ///< a stroke a column
  Eigen::MatrixXd stand;   ///< a stand a column
  Eigen::MatrixXd shared;  ///< a group a column
  Eigen::MatrixXd home;    ///< a home a column
};

/// The mixed model y = X b + Z u + e, u ~ N(0, D) with D diagonal and known, e weighed: the normal
/// equations of b with u eliminated (Henderson 1975, Biometrics 31, eq. 3), which are those of
/// generalised least squares with the covariance V = Z D Z^T + W^-1.
struct Eliminated {
  Eigen::MatrixXd normal;      ///< of the parameters
  Eigen::VectorXd gradient;    ///< its right side
  double squares = 0;          ///< y^T V^-1 y, before b is fitted
  double log_determinant = 0;  ///< of V, but for that of the weights: log |I + D Z^T W Z|
};
/// Takes the first columns, effects with these variances, out of products; what is left is of the
/// other columns. Of both, which are symmetric, the lower triangle counts: of the products no other
/// is read, and of what is left no other has a meaning. Adds to the logarithm of V's determinant.
[[nodiscard]] Eigen::MatrixXd without_effects(const Eigen::MatrixXd& products,
                                              const Eigen::Ref<const Eigen::VectorXd>& variances,
                                              double& log_determinant);

/// Takes all effects out of strokes' products. Where the next variances differ only in the outer
/// levels, what was found of the inner ones stands.
class EffectElimination {
 public:
  /// `group_of`: of each stand; `home_of`: of each group; `home_effects`: of each home.
  EffectElimination(std::vector<StrokeProducts> strokes, std::vector<std::size_t> group_of,
                    std::vector<std::size_t> home_of, Eigen::Index home_effects,
                    Eigen::Index parameters);
  [[nodiscard]] Eliminated operator()(const EffectVariances& variances);

 private:
  /// What is left once the effects of one level, with these variances, are out.
  struct Level {
    Eigen::MatrixXd variances;             ///< empty: none
    std::vector<Eigen::MatrixXd> left;     ///< lower triangles
    std::vector<double> log_determinants;  ///< of own variances: one a stand
    double log_determinant = 0;
  };

  /// A search for sizes comes back to what it has just left. So many matrices are kept for it.
  static constexpr std::size_t kKept = 200;

  using Columns = std::vector<Eigen::Index>;  ///< outer ones, ascending

  void use_own(const EffectVariances& variances);

  std::vector<StrokeProducts> strokes_;
  std::vector<std::size_t> group_of_;
  std::vector<std::size_t> home_of_;
  Eigen::Index home_effects_, parameters_;
  /// Those that any stroke of a stand, of a group, of a home knows. What none knows is not carried
  /// along.
  std::vector<Columns> of_stands_, of_groups_, of_homes_;
  std::list<Level> own_;  ///< left: one a stand; the last used first
  Level stand_;           ///< left: one a group
  Level shared_;          ///< left: one a home
};

}  // namespace identify
