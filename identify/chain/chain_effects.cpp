#include "identify/chain/chain_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "identify/geometry/angle.hpp"

namespace identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whether what rounding bends a stroke's X, Y and Z by is a fifth of what noise does, or more: of
/// n samples whose noise has the variance s^2, the second Legendre coefficient has 5 s^2 / n.
bool bent_by_print(double print_mm, const ChainNodes& nodes) {
  return std::any_of(nodes.units.begin(), nodes.units.end(), [&](const auto& unit) {
    const StrokeRounding& rounding = nodes.strokes[unit.front()].rounding;
    return rounding.shifts(print_mm, 0)[2].maxCoeff() * rounding.samples > print_mm * print_mm / 12;
  });
}

/// Which share of the variance of a random walk's places, their means over strokes, the units of
/// each group have in common. Over a time D it is D/6 a unit of time, half of that of what lies
/// between two places if they were independent. Between the means over two strokes of length T
/// whose middles are a time t apart, not overlapping, the variance is t - T/3 a unit of time. Where
/// strokes of one joint overlap, times begin anew with each, and nothing tells how far apart they
/// are.
std::vector<double> shares_in_common(const ChainNodes& nodes) {
  struct Pairs {
    double apart_s = 0;  ///< sum of t - T/3
    double count = 0;
  };
  constexpr double kOverlapping = 0.9;  // of a stroke's length
  const double seconds = nodes.seconds();
  std::vector<Pairs> pairs(nodes.home_of.size());
  const auto stroke = [&](std::size_t u) -> const StrokeMoments& {
    return nodes.strokes[nodes.units[u].front()];
  };
  for (std::size_t u = 0; u < nodes.units.size(); ++u)
    for (std::size_t v = 0; v < u; ++v) {
      if (nodes.group[u] != nodes.group[v]) continue;
      const StrokeMoments &one = stroke(u), &other = stroke(v);
      const double middles_s = std::abs(one.begin_s + one.end_s - other.begin_s - other.end_s) / 2;
      const double length_s = (one.end_s - one.begin_s + other.end_s - other.begin_s) / 2;
      Pairs& both = pairs[nodes.group[u]];
      both.apart_s += middles_s < kOverlapping * length_s ? seconds / 3 : middles_s - length_s / 3;
      ++both.count;
    }
  std::vector<double> shares;
  shares.reserve(pairs.size());
  for (const Pairs& all : pairs)
    shares.push_back(all.count > 0 ? std::max(0.0, 1 - 3 * all.apart_s / (all.count * seconds))
                                   : 0);
  return shares;
}

}  // namespace

EffectColumns::EffectColumns(const ChainEffects& shape, const ChainNodes& nodes)
    : targets(nodes.targets) {
  const auto turns = static_cast<Index>(nodes.known.size());
  if (shape.home_rad > 0 || shape.creep_rad > 0 || shape.drift_mm > 0 || shape.print_mm > 0 ||
      shape.print_rad > 0 || shape.print_turn_rad > 0 || shape.any_stray() ||
      !shape.along.empty() || !shape.places_rad.empty())
    own = turns + 6;
  if (shape.print_rad > 0) own += turned = 9;
  if (shape.print_turn_rad > 0) own += swept = 2;
  if (!nodes.all_known() && (shape.home_rad > 0 || !shape.places_rad.empty())) own += carried = 9;
  if (shape.creep_rad > 0 || !shape.along.empty()) own += creep = turns;
  drift_bends = shape.drift_mm > 0 && nodes.sweeps_again();
  if (drift_bends || (shape.print_mm > 0 && bent_by_print(shape.print_mm, nodes))) own += bent = 3;
  if (shape.home_rad > 0 && shape.home_lasts == HomeLasts::stand) stand = turns;
  if (shape.home_rad > 0 && shape.home_lasts == HomeLasts::rest)
    rest = static_cast<Index>(nodes.most_rests());
  if (shape.figure_mm() > 0) figure = 2 * kFigureOrders;
  if (shape.drift_mm > 0 && nodes.units.size() > nodes.home_of.size()) {
    wander = 3;
    in_common = shares_in_common(nodes);
  }
  if (shape.told_rad > 0) told = kFigureOrders;
  if (shape.offset_rad > 0) offset = turns;
}

namespace {

/// How large the coefficients of a law's orders are, from the first on, that of the first being
/// one. `arc_rad`: half of it.
VectorXd fall_of(FigureLaw law, double arc_rad) {
  VectorXd sizes(kFigureOrders);
  for (Index m = 0; m < kFigureOrders; ++m) {
    const auto order = static_cast<double>(m + 1);
    if (law != FigureLaw::waves || arc_rad == 0) {
      sizes(m) = std::pow(order, law == FigureLaw::square ? -2 : -3);
      continue;
    }
    // cos(k q) and sin(k q) over the arc: 2 J_m(k arc) (Abramowitz & Stegun, 9.1.44 f.).
    constexpr std::array kWaves{7.5, 1.0, 0.3};
    double squares = 0;
    for (std::size_t k = 0; k < kWaves.size(); ++k)
      squares += std::pow(
          kWaves[k] * std::cyl_bessel_j(order, static_cast<double>(k + 1) * std::min(arc_rad, kPi)),
          2);
    sizes(m) = std::sqrt(squares);
  }
  return sizes / sizes(0);
}

VectorXd figure_variances(const ChainEffects& effects, double arc_rad) {
  VectorXd variances = VectorXd::Zero(kFigureOrders);
  for (std::size_t law = 0; law < kFigureLaws.size(); ++law)
    if (effects.figures_mm[law] > 0)
      variances += (effects.figures_mm[law] * fall_of(kFigureLaws[law], arc_rad)).cwiseAbs2();
  return variances;
}

}  // namespace

VectorXd device_sigmas(const ChainEffects& shape, const ChainEffects& effects, Index move_numbers) {
  const Index drift = shape.drift_columns();
  VectorXd sigmas = VectorXd::Constant(drift + move_numbers, effects.moved_mm);
  const DriftTimes walk = drift_of_walk();
  for (Index k = 0; k < drift; ++k) sigmas(k) = effects.steady_mm * walk(k / 3);
  if (move_numbers > 0) sigmas.segment<3>(drift + 3) /= kMoveLever_mm;
  return sigmas;
}

EffectVariances variances_of(const ChainEffects& effects, const ChainNodes& nodes,
                             const EffectColumns& columns) {
  EffectVariances variances;
  const auto turns = static_cast<Index>(nodes.known.size());
  const double seconds = nodes.seconds();
  const double drift = effects.drift_mm * effects.drift_mm;
  VectorXd home(turns);
  for (Index k = 0; k < turns; ++k)
    home(k) = std::pow(effects.home_times_of(static_cast<std::size_t>(k)), 2);
  double reach = 0;  // of what joints of which no axis is known carry
  for (const StrokeMoments& stroke : nodes.strokes)
    if (!stroke.linear) reach = std::max(reach, stroke.circle.radius_mm);
  const VectorXd creep = effects.creep_rad * effects.creep_rad * home;
  home *= effects.home_rad * effects.home_rad;
  for (std::size_t k = 0; k < effects.places_rad.size(); ++k)
    home(static_cast<Index>(k)) += std::pow(effects.places_rad[k], 2);
  const auto in_common = [&](std::size_t group) {
    return columns.wander > 0 ? columns.in_common[group] : 0;
  };
  const auto count = [](const auto& all) { return static_cast<Index>(all.size()); };
  variances.own.setZero(columns.own, count(nodes.units));
  for (std::size_t u = 0; u < nodes.units.size(); ++u) {
    const StrokeMoments& stroke = nodes.strokes[nodes.units[u].front()];
    auto own = variances.own.col(static_cast<Index>(u));
    if (columns.own > 0) {
      if (columns.stand == 0 && columns.rest == 0) own.head(turns) = home;
      if (columns.creep > 0) {
        own.segment(columns.creeps(), turns) = creep;
        own(columns.creeps() + static_cast<Index>(stroke.content.joint)) = 0;
      }
      for (const ChainEffects::Along& one : effects.along) {
        if (one.swept != stroke.content.joint) continue;
        const auto k = static_cast<Index>(one.joint);
        own(k) += one.off_rad * one.off_rad;
        own(columns.creeps() + k) += one.rad * one.rad;
      }
      own.segment<3>(turns).setConstant(drift * (1 - in_common(nodes.group[u])));
      // Over a stroke of length T, the coefficient of a random walk's n-th Legendre polynomial has
      // the variance T/4 (1/(2n+3) + 1/(2n-1)) in units of a unit of time's (integrated by parts).
      const double share = std::min(1.0, 6 * (stroke.end_s - stroke.begin_s) / seconds);
      const double walk = drift * (share > 0 ? share : 1);
      own.segment<3>(turns + 3).setConstant(0.3 * walk);
      if (columns.drift_bends) own.tail<3>().setConstant(walk * (1.0 / 7 + 1.0 / 3) / 4);
      const auto told = stroke.rounding.told_shifts(effects.print_turn_rad);
      const double late =
          stroke.end_s > stroke.begin_s
              ? effects.late_s * (stroke.to_rad - stroke.from_rad) / (stroke.end_s - stroke.begin_s)
              : 0;
      own(static_cast<Index>(stroke.content.joint)) = told[0] + late * late;
      if (columns.swept > 0) {
        own(turns + 6 + columns.turned) = told[1];
        own(turns + 7 + columns.turned) = told[2];
      }
      const auto shifts = stroke.rounding.shifts(effects.print_mm, effects.print_rad);
      own.segment<3>(turns) += shifts[0].head<3>().matrix();
      own.segment<3>(turns + 3) += shifts[1].head<3>().matrix();
      if (columns.bent > 0) own.tail<3>() += shifts[2].head<3>().matrix();
      if (!effects.stray_mm.empty()) {
        const double stray = effects.stray_mm[u] * effects.stray_mm[u];
        own.segment<6>(turns).array() += stray;
        own.tail(columns.bent).array() += stray;
      }
      if (columns.carried > 0) {
        // Those before the joint carry its axis, those behind it the target alone.
        double before = 0, behind = 0;
        for (std::size_t k = 0; k < nodes.known.size(); ++k)
          if (!nodes.known[k])
            (k < stroke.content.joint ? before : behind) += home(static_cast<Index>(k));
        own.segment<3>(turns).array() += before * reach * reach;
        own.segment<3>(columns.carries()).setConstant(before);
        own.segment<3>(columns.carries() + 3).setConstant(behind * reach * reach);
        own.segment<3>(columns.carries() + 6).setConstant(behind);
      }
      if (columns.turned > 0) {
        own.segment<3>(turns + 6) += shifts[0].tail<3>().matrix();
        own.segment<3>(turns + 9) += shifts[1].tail<3>().matrix();
        own.segment<3>(turns + 12) += shifts[2].tail<3>().matrix();
      }
    }
  }
  std::vector<double> arcs(nodes.home_of.size());  // of the groups; half of them
  std::vector<std::size_t> joints(arcs.size());
  for (std::size_t u = 0; u < nodes.units.size(); ++u) {
    joints[nodes.group[u]] = nodes.strokes[nodes.units[u].front()].content.joint;
    for (const std::size_t s : nodes.units[u]) {
      double& arc = arcs[nodes.group[u]];
      arc = std::max(arc, (nodes.strokes[s].to_rad - nodes.strokes[s].from_rad) / 2);
    }
  }
  variances.stand = home.head(columns.stand).replicate(1, count(nodes.group_of));
  for (std::size_t t = 0; t < nodes.group_of.size() && columns.stand > 0; ++t)
    variances.stand(static_cast<Index>(joints[nodes.group_of[t]]), static_cast<Index>(t)) = 0;
  variances.shared.resize(columns.shared(), count(arcs));
  for (std::size_t g = 0; g < arcs.size(); ++g) {
    auto shared = variances.shared.col(static_cast<Index>(g));
    VectorXd figure;
    if (columns.figure > 0)
      figure = figure_variances(effects, arcs[g]) * std::pow(effects.figure_times_of(joints[g]), 2);
    const Index figures = shared.size() - columns.wander - columns.told;
    for (Index at = 0; at < figures; ++at) shared(at) = figure(at % kFigureOrders);
    shared.segment(figures, columns.wander).setConstant(drift * in_common(g));
    shared.tail(columns.told).setConstant(effects.told_rad * effects.told_rad);
  }
  variances.home.setZero(columns.home(), count(nodes.homes));
  for (std::size_t h = 0; h < nodes.homes.size(); ++h) {
    auto at_home = variances.home.col(static_cast<Index>(h));
    if (h > 0) at_home.head(columns.offset).setConstant(effects.offset_rad * effects.offset_rad);
    for (std::size_t r = 0; columns.rest > 0 && r < nodes.rests[h].size(); ++r)
      at_home(columns.offset + static_cast<Index>(r)) = home(static_cast<Index>(nodes.rests[h][r]));
  }
  return variances;
}

}  // namespace identify
