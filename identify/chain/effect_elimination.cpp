#include "identify/chain/effect_elimination.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Adds to `sum`, whose columns are (first ones, `of_sum`, y), products whose columns are (the same
/// first ones, some of these, y). Both lists ascend.
void add(MatrixXd& sum, const std::vector<Index>& of_sum, const MatrixXd& products,
         const std::vector<Index>& outer) {
  const Index first = products.rows() - static_cast<Index>(outer.size()) - 1;
  const Index size = first + static_cast<Index>(of_sum.size()) + 1;
  if (sum.size() == 0) {
    sum = size == products.rows() ? products : MatrixXd::Zero(size, size);
    if (size == products.rows()) return;
  }
  std::vector<Index> place(static_cast<std::size_t>(first));
  std::iota(place.begin(), place.end(), Index{0});
  auto at = of_sum.begin();
  for (const Index column : outer) {
    at = std::lower_bound(at, of_sum.end(), column);
    place.push_back(first + (at - of_sum.begin()));
  }
  place.push_back(size - 1);
  for (Index c = 0; c < products.cols(); ++c) {
    double* const column = sum.col(place[static_cast<std::size_t>(c)]).data();
    for (Index r = c; r < products.rows(); ++r)
      column[place[static_cast<std::size_t>(r)]] += products(r, c);
  }
}

// Registers hold two numbers, four or more: what is built for all processors of its kind takes the
// loop that its own has. Operations and their order are the same, and so is what comes out.
#if defined(__x86_64__) && !defined(__clang__)
#define SWEEPD_WIDE \
  __attribute__((target_clones("default", "avx2", "avx512f"), optimize("fp-contract=off")))
#else
#define SWEEPD_WIDE
#endif

constexpr Index kAtOnce = 4;  ///< columns: each number is read once for all of them

/// Takes from four neighbouring columns, `next` numbers apart, the others that begin beside them,
/// `step` numbers apart, times their first number for the first column, their second for the next:
/// columns of L L^T from those of a matrix. The count of the others is a multiple of four.
SWEEPD_WIDE void take_columns(double* __restrict first, Index next, Index size,
                              const double* others, Index step, Index count) {
  double* __restrict second = first + next;
  double* __restrict third = second + next;
  double* __restrict fourth = third + next;
  for (Index k = 0; k < count; k += kAtOnce) {
    const double *const a = others + k * step, *const b = a + step, *const c = b + step,
                        *const d = c + step;
    const double a1 = a[0], a2 = a[1], a3 = a[2], a4 = a[3];
    const double b1 = b[0], b2 = b[1], b3 = b[2], b4 = b[3];
    const double c1 = c[0], c2 = c[1], c3 = c[2], c4 = c[3];
    const double d1 = d[0], d2 = d[1], d3 = d[2], d4 = d[3];
    for (Index i = 0; i < size; ++i) {
      first[i] -= a1 * a[i] + b1 * b[i] + c1 * c[i] + d1 * d[i];
      second[i] -= a2 * a[i] + b2 * b[i] + c2 * c[i] + d2 * d[i];
      third[i] -= a3 * a[i] + b3 * b[i] + c3 * c[i] + d3 * d[i];
      fourth[i] -= a4 * a[i] + b4 * b[i] + c4 * c[i] + d4 * d[i];
    }
  }
}

/// Cholesky's factor L of the effects' products in units of the effects' own standard deviations
/// and the unit matrix, with L^-1 times their products with the rest below it; the effects that
/// have no variance are left out. No columns where effects are so large that products are no
/// squares.
// A matrix is small here, and Eigen's blocks cost more than they save.
MatrixXd factor_of(const MatrixXd& products, const Eigen::Ref<const VectorXd>& variances,
                   double& log_determinant) {
  std::vector<Index> effects;
  std::vector<double> sigmas;
  double largest = 0;
  for (Index k = 0; k < variances.size(); ++k) {
    if (variances(k) == 0) continue;
    effects.push_back(k);
    sigmas.push_back(std::sqrt(variances(k)));
    largest = std::max(largest, 1 + variances(k) * products(k, k));
  }
  // The unit matrix and squares have no pivot below one. A node's sums are no squares, since its
  // polynomial has both signs: of effects so large that this shows, they tell nothing.
  constexpr double kRounding = 1e-14;
  const double least = 0.99 - kRounding * largest;
  const auto count = static_cast<Index>(effects.size());
  const Index rest = products.rows() - variances.size(), rows = count + rest;
  MatrixXd factor = MatrixXd::Zero(rows + kAtOnce, (count + kAtOnce - 1) / kAtOnce * kAtOnce);
  Eigen::Matrix<double, Eigen::Dynamic, kAtOnce> panel;
  for (Index first = 0; first < count; first += kAtOnce) {
    const Index end = std::min(first + kAtOnce, count);
    panel.setZero(rows - first, kAtOnce);
    for (Index c = first; c < end; ++c) {
      const Index effect = effects[static_cast<std::size_t>(c)];
      const double sigma = sigmas[static_cast<std::size_t>(c)];
      auto column = panel.col(c - first);
      for (Index r = c; r < count; ++r) {
        const auto other = static_cast<std::size_t>(r);
        column(r - first) = sigma * sigmas[other] * products(effects[other], effect);
      }
      column.tail(rest) = sigma * products.col(effect).tail(rest);
      column(c - first) += 1;
    }
    take_columns(panel.data(), panel.rows(), panel.rows(), &factor(first, 0), factor.rows(), first);
    for (Index c = first; c < end; ++c) {
      auto column = panel.col(c - first).tail(rows - c);
      for (Index k = first; k < c; ++k) column -= factor(c, k) * factor.col(k).segment(c, rows - c);
      const double pivot = column(0);
      if (!(pivot > least)) log_determinant = std::numeric_limits<double>::infinity();
      if (!(pivot > 0)) return MatrixXd::Zero(factor.rows(), 0);
      log_determinant += std::log(pivot);
      factor.col(c).segment(c, rows - c) = column * (1 / std::sqrt(pivot));
    }
  }
  return factor;
}

}  // namespace

MatrixXd without_effects(const MatrixXd& products, const Eigen::Ref<const VectorXd>& variances,
                         double& log_determinant) {
  const Index rest = products.rows() - variances.size();
  MatrixXd left(rest, rest);
  for (Index c = 0; c < rest; ++c)
    left.col(c).tail(rest - c) = products.col(variances.size() + c).tail(rest - c);
  const MatrixXd factor = factor_of(products, variances, log_determinant);
  if (factor.cols() == 0) return left;
  const Index beside = factor.rows() - kAtOnce - rest;
  Index c = 0;
  for (; c + kAtOnce <= rest; c += kAtOnce)
    take_columns(&left(c, c), left.rows(), rest - c, &factor(beside + c, 0), factor.rows(),
                 factor.cols());
  for (; c < rest; ++c)
    for (Index r = c; r < rest; ++r)
      left(r, c) -= factor.row(beside + r).dot(factor.row(beside + c));
  return left;
}

EffectElimination::EffectElimination(std::vector<StrokeProducts> strokes,
                                     std::vector<std::size_t> group_of,
                                     std::vector<std::size_t> home_of, Index home_effects,
                                     Index parameters)
    : strokes_(std::move(strokes)),
      group_of_(std::move(group_of)),
      home_of_(std::move(home_of)),
      home_effects_(home_effects),
      parameters_(parameters),
      of_stands_(group_of_.size()),
      of_groups_(home_of_.size()) {
  const auto join = [](Columns& of_sum, const Columns& outer) {
    Columns all;
    std::set_union(of_sum.begin(), of_sum.end(), outer.begin(), outer.end(),
                   std::back_inserter(all));
    of_sum = std::move(all);
  };
  for (const StrokeProducts& stroke : strokes_) join(of_stands_[stroke.stand], stroke.outer);
  for (std::size_t t = 0; t < group_of_.size(); ++t) join(of_groups_[group_of_[t]], of_stands_[t]);
  for (std::size_t g = 0; g < home_of_.size(); ++g) {
    of_homes_.resize(std::max(of_homes_.size(), home_of_[g] + 1));
    join(of_homes_[home_of_[g]], of_groups_[g]);
  }
}

namespace {

/// Known ones have a column, if not a row.
bool are(const MatrixXd& variances, const MatrixXd& others) {
  return variances.cols() == others.cols() && variances == others;
}

/// Takes each one's effects out and adds what is left to what it belongs to.
void take_out(const std::vector<MatrixXd>& ones, const std::vector<std::vector<Index>>& of_ones,
              const MatrixXd& variances, const std::vector<std::size_t>& whose,
              std::vector<MatrixXd>& sums, const std::vector<std::vector<Index>>& of_sums,
              double& log_determinant) {
  for (MatrixXd& sum : sums) sum.resize(0, 0);
  for (std::size_t k = 0; k < ones.size(); ++k) {
    if (ones[k].size() == 0) continue;  // no stroke is of it
    MatrixXd& sum = sums[whose[k]];
    const auto& of_sum = of_sums[whose[k]];
    if (variances.rows() == 0)
      add(sum, of_sum, ones[k], of_ones[k]);
    else
      add(sum, of_sum,
          without_effects(ones[k], variances.col(static_cast<Index>(k)), log_determinant),
          of_ones[k]);
  }
}

}  // namespace

/// Brings the level of these own variances to the front of those that are known. What it has of a
/// stand whose variances are those of the level before is the same.
void EffectElimination::use_own(const EffectVariances& variances) {
  if (!own_.empty() && own_.front().variances == variances.own) return;
  stand_.variances.resize(0, 0);
  const auto known = std::find_if(own_.begin(), own_.end(), [&](const Level& level) {
    return level.variances == variances.own;
  });
  if (known != own_.end()) {
    own_.splice(own_.begin(), own_, known);
    return;
  }
  while (own_.size() > 1 && (own_.size() + 1) * group_of_.size() > kKept) own_.pop_back();
  const Level* before = own_.empty() ? nullptr : &own_.front();
  Level& level = own_.emplace_front();
  level.variances = variances.own;
  level.left.resize(group_of_.size());
  level.log_determinants.resize(group_of_.size());
  std::vector<bool> same(group_of_.size(), before != nullptr);
  for (std::size_t s = 0; before && s < strokes_.size(); ++s)
    if (before->variances.col(static_cast<Index>(s)) != variances.own.col(static_cast<Index>(s)))
      same[strokes_[s].stand] = false;
  for (std::size_t stand = 0; stand < same.size(); ++stand) {
    if (!same[stand]) continue;
    level.left[stand] = before->left[stand];
    level.log_determinants[stand] = before->log_determinants[stand];
  }
  for (std::size_t s = 0; s < strokes_.size(); ++s) {
    const std::size_t stand = strokes_[s].stand;
    if (same[stand]) continue;
    add(level.left[stand], of_stands_[stand],
        without_effects(strokes_[s].products, variances.own.col(static_cast<Index>(s)),
                        level.log_determinants[stand]),
        strokes_[s].outer);
  }
  level.log_determinant =
      std::accumulate(level.log_determinants.begin(), level.log_determinants.end(), 0.0);
}

Eliminated EffectElimination::operator()(const EffectVariances& variances) {
  use_own(variances);
  if (!are(stand_.variances, variances.stand)) {
    shared_.variances.resize(0, 0);
    stand_.variances = variances.stand;
    stand_.log_determinant = own_.front().log_determinant;
    stand_.left.resize(home_of_.size());
    take_out(own_.front().left, of_stands_, variances.stand, group_of_, stand_.left, of_groups_,
             stand_.log_determinant);
  }
  if (!are(shared_.variances, variances.shared)) {
    shared_.variances = variances.shared;
    shared_.log_determinant = stand_.log_determinant;
    shared_.left.resize(of_homes_.size());
    take_out(stand_.left, of_groups_, variances.shared, home_of_, shared_.left, of_homes_,
             shared_.log_determinant);
  }
  Eliminated all;
  all.log_determinant = shared_.log_determinant;
  MatrixXd whole = MatrixXd::Zero(parameters_ + 1, parameters_ + 1);
  Columns of_whole(static_cast<std::size_t>(parameters_));
  std::iota(of_whole.begin(), of_whole.end(), home_effects_);
  for (std::size_t h = 0; h < shared_.left.size(); ++h) {
    if (shared_.left[h].size() == 0) continue;
    const Columns& outer = of_homes_[h];
    const auto parameters = std::lower_bound(outer.begin(), outer.end(), home_effects_);
    const VectorXd known =
        variances.home(Columns(outer.begin(), parameters), static_cast<Index>(h));
    add(whole, of_whole, without_effects(shared_.left[h], known, all.log_determinant),
        Columns(parameters, outer.end()));
  }
  all.normal = whole.topLeftCorner(parameters_, parameters_).selfadjointView<Eigen::Lower>();
  all.gradient = whole.bottomLeftCorner(1, parameters_).transpose();
  all.squares = whole(parameters_, parameters_);
  return all;
}

}  // namespace identify
