#include "identify/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string_view>
#include <utility>

#include "identify/chain_advice.hpp"
#include "identify/circle/joint_motion.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/home_judgement.hpp"
#include "identify/linear_advice.hpp"
#include "identify/specified_fit.hpp"
#include "identify/sweeps/sample.hpp"
#include "identify/told_turn.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// A device is off by a millimetre at most, and on all circles alike.
constexpr double kMisfit_mm = 1;
constexpr double kMisfitToPeers = 20;
/// What is left of an arc when noise is averaged away. Bearings and load bend all joints' arcs by
/// some hundredths; a joint that moves along bends one joint's.
constexpr double kBent_mm = 0.05;
constexpr double kBentToPeers = 10;
/// Of the radius, besides what is beyond any device.
constexpr double kNoCircleShare = 0.02;
/// More than joints scatter by, less than an axis is moved on purpose.
constexpr double kScattered_mm = 0.1;
/// A stroke no farther off the circle of all strokes, in distances from its own, is on both.
constexpr double kFitsCommon = 2;
constexpr std::ptrdiff_t kSeveralApart = 3;
/// Below it residuals are those of computing.
constexpr double kComputed_mm = 1e-5;

bool same_positions(const Sweep& a, const Sweep& b) {
  return std::equal(a.samples->begin(), a.samples->end(), b.samples->begin(), b.samples->end(),
                    [](const Sample& p, const Sample& q) {
                      return p.has_position && q.has_position && p.position_mm == q.position_mm;
                    });
}

class Judge {
 public:
  explicit Judge(Identification& found) : found_(found) {}

  void judge_strokes(const Resolution& resolution) {
    judge_copies(resolution);
    for (const JointResult& joint : found_.joints) scatter_.push_back(circle_scatter(joint));
    std::vector<Apart> apart;
    for (std::size_t j = 0; j < found_.joints.size(); ++j) {
      if (!scatter_[j]) continue;
      if (auto disagree = strokes_disagree(j))
        apart.push_back(std::move(*disagree));
      else if (is_no_circle(j))
        continue;
      else if (auto otherwise = told_otherwise(found_, j, scatter_[j]->usual_mm))
        found_.doubts.push_back(std::move(*otherwise));
    }
    tell_apart(std::move(apart));
  }

  void judge_external_axes() {
    for (std::size_t j = 0; j < found_.joints.size(); ++j) {
      const JointResult& joint = found_.joints[j];
      for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
        const auto place = joint.sweeps[s].first().external_place;
        if (!joint.used[s] ||
            std::all_of(joint.sweeps[s].samples->begin(), joint.sweeps[s].samples->end(),
                        [&](const Sample& sample) { return sample.external_place == place; }))
          continue;
        doubt("external_axis_moved", j,
              joint_name(j) +
                  ": an external axis moved while it was swept (EIPos): lock the "
                  "external axes and sweep it again");
        break;
      }
    }
  }

  /// Between sweeps they may have moved without harm, as a positioner does in a frame of the robot.
  void judge_external_places() {
    std::optional<std::uint16_t> first;
    std::set<std::size_t> there, elsewhere;  // joints
    for (std::size_t j = 0; j < found_.joints.size(); ++j)
      for (std::size_t s = 0; s < found_.joints[j].sweeps.size(); ++s) {
        if (!found_.joints[j].used[s]) continue;
        const auto place = found_.joints[j].sweeps[s].first().external_place;
        (place == first.value_or(place) ? there : elsewhere).insert(j);
        first = first.value_or(place);
      }
    if (elsewhere.empty()) return;
    const auto names = [](const std::set<std::size_t>& joints) {
      std::string all;
      for (const std::size_t j : joints) all += (all.empty() ? "" : ", ") + joint_name(j);
      return all;
    };
    const std::string moved = "the external axes stood elsewhere in sweeps of " + names(elsewhere) +
                              " than in those of " + names(there) + " (EIPos)";
    const std::string remedy = ": leave them where they are during all sweeps";
    const auto& chain = found_.chain;
    if (chain && (!chain->summary.converged || chain->home_scatter_mm > kScattered_mm))
      doubt("external_axis_moved", std::nullopt,
            moved + ", and the target did not come back to where it was" + remedy);
    else
      found_.warnings.push_back({"external_axis_moved", std::nullopt, moved + remedy});
  }

  /// Circles know of no errors but the samples' noise: beside others their sigmas are too small.
  void judge_fit() {
    if (!found_.chain || found_.chain->summary.converged || found_.estimator != Estimator::circle ||
        found_.status == Status::failed)
      return;
    const Summary& fit = found_.chain->summary;
    doubt("not_converged", std::nullopt,
          "the chain estimator did not come to its end (" + std::string(fit.ending) + ", after " +
              std::to_string(fit.iterations) +
              " iterations): the numbers are those of the circles, and may be farther off than "
              "their uncertainties say");
  }

 private:
  void doubt(std::string_view code, std::optional<std::size_t> joint, std::string message) {
    found_.doubts.push_back({std::string(code), joint, std::move(message)});
  }

  /// Noise never comes twice. Where there is none that is larger than the last printed decimal, the
  /// same motion may well give the same numbers.
  void judge_copies(const Resolution& resolution) {
    struct Place {
      std::size_t joint;
      const Sweep* sweep;
    };
    std::vector<Place> noisy;
    for (std::size_t j = 0; j < found_.joints.size(); ++j) {
      const JointResult& joint = found_.joints[j];
      if (!joint.circle || std::max(joint.circle->plane_rms_mm, joint.circle->radial_rms_mm) <=
                               std::max(kComputed_mm, resolution.position_mm))
        continue;
      for (const Sweep& sweep : joint.sweeps) noisy.push_back({j, &sweep});
    }
    for (std::size_t b = 0; b < noisy.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) {
        if (!same_positions(*noisy[a].sweep, *noisy[b].sweep)) continue;
        std::string message = joint_name(noisy[b].joint) + ": two sweeps hold the same positions, ";
        message += "noise and all";
        if (noisy[a].joint != noisy[b].joint)
          message += ", the other one as " + joint_name(noisy[a].joint) + "'s";
        message += ": one is a copy; give every measurement once";
        doubt("duplicate_sweep", noisy[b].joint, std::move(message));
        return;
      }
  }

  struct Apart {  ///< the strokes of a joint, on several circles
    Warning told;
    bool coaxial = false;
  };
  /// Where several joints' strokes disagree and no angles tell where the others stood, it is one
  /// thing that differs: home.
  void tell_apart(std::vector<Apart> apart) {
    const auto axes = std::ranges::count(apart, false, &Apart::coaxial);
    const bool told = std::ranges::any_of(found_.joints, [](const JointResult& joint) {
      return !joint.sweeps.empty() && joint.sweeps.front().first().joints > 0;
    });
    if (axes >= kSeveralApart && !told)
      doubt("strokes_disagree", std::nullopt,
            "of " + std::to_string(axes) +
                " joints the sweeps do not turn about one axis each: they began from different "
                "homes, or something was moved between them. Give the angles of all joints with "
                "the points, or the sweeps from one home alone");
    else
      for (Apart& one : apart) found_.doubts.push_back(std::move(one.told));
  }

  [[nodiscard]] std::optional<Apart> strokes_disagree(std::size_t j) const {
    const JointResult& joint = found_.joints[j];
    struct Seen {
      CircleFit circle;
      Axis axis;
      bool fits_common = false;
    };
    std::optional<Seen> first;
    // Of errors that are alike from sample to sample, few average out.
    const double sigmas = kApartSigmas * std::sqrt(found_.samples_per_independent());
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s) {
      if (!joint.used[s] || joint.sweeps[s].target != joint.circle_target) continue;
      const auto points = positions(*joint.sweeps[s].samples);
      auto circle = fit_circle(points);
      if (circle && std::max(circle->plane_rms_mm, circle->radial_rms_mm) > kMisfit_mm)
        circle = fit_robust_circle(points);
      if (!circle) continue;
      const Axis axis{
          circle->normal, circle->center_mm,
          axis_covariance(*circle, points, circle->plane_rms_mm, circle->radial_rms_mm)};
      // Short arcs in much noise are on many circles: that of a single stroke is no evidence then.
      const bool fits_common = usual_distance_mm(*joint.circle, points) <
                               kFitsCommon * usual_distance_mm(*circle, points);
      if (!first) {
        first = Seen{*circle, axis, fits_common};
        continue;
      }
      if (fits_common && first->fits_common) continue;
      const double apart_mm = (circle->center_mm - first->circle.center_mm).norm();
      const double apart_rad =
          std::asin(std::min(1.0, circle->normal.cross(first->circle.normal).norm()));
      const double sure_mm =
          sigmas * std::hypot(axis.point_sigma_mm(), first->axis.point_sigma_mm());
      const double sure_rad =
          sigmas * std::hypot(axis.direction_sigma_rad(), first->axis.direction_sigma_rad());
      if (!(apart_mm > kApart_mm + sure_mm) && !(apart_rad > kApart_rad + sure_rad)) continue;
      const Vector3d between = circle->center_mm - first->circle.center_mm;
      const bool coaxial = apart_rad < kApart_rad + sure_rad &&
                           circle->normal.cross(between).norm() < kApart_mm + sure_mm;
      std::string told = joint_name(j) + ": its sweeps ";
      told += coaxial ? "turn about one axis on circles that are "
                      : "do not turn about one axis: their circles' centres are ";
      told += fixed(apart_mm, 1) + " mm apart";
      told += coaxial ? " along it: the target is another one. Name the targets in a column target"
                      : ", their normals " + fixed(apart_rad / kDegree, 1) +
                            "°: something else moved between them, or one is another joint's";
      return Apart{{"strokes_disagree", j, std::move(told)}, coaxial};
    }
    return std::nullopt;
  }

  bool is_no_circle(std::size_t j) {
    std::vector<double> peers;
    for (std::size_t k = 0; k < scatter_.size(); ++k)
      if (k != j && scatter_[k]) peers.push_back(scatter_[k]->usual_mm);
    const double peer = median_of(peers);
    const double usual = scatter_[j]->usual_mm;
    const bool above_peers =
        peers.size() >= 2 && usual > kMisfit_mm && usual > kMisfitToPeers * peer;
    if (!above_peers && is_bent(j)) return true;
    const double no_circle =
        std::max(kOffCurve_mm, kNoCircleShare * found_.joints[j].circle->radius_mm);
    if (!above_peers && !(usual > no_circle)) return false;
    std::string message = joint_name(j) + ": its points lie on no circle: they are ";
    message += fixed(usual, 1) + " mm off";
    if (!peers.empty()) message += ", the other joints' " + fixed(peer, 3) + " mm";
    message += ": another joint moved along, or points of other places are among them";
    doubt("circle_misfit", j, std::move(message));
    return true;
  }

  bool is_bent(std::size_t j) {
    if (!scatter_[j]->bent_mm) return false;
    std::vector<double> peers;
    for (std::size_t k = 0; k < scatter_.size(); ++k)
      if (k != j && scatter_[k] && scatter_[k]->bent_mm) peers.push_back(*scatter_[k]->bent_mm);
    const double bent = *scatter_[j]->bent_mm;
    const double peer = median_of(peers);
    if (peers.size() < 2 || !(bent > kBent_mm) || !(bent > kBentToPeers * peer)) return false;
    doubt("circle_misfit", j,
          joint_name(j) + ": its points bend away from a circle by " + fixed(bent, 3) +
              " mm, noise averaged, the other joints' by " + fixed(peer, 3) +
              " mm: another joint moved along, or its bearing is worn");
    return true;
  }

  Identification& found_;
  std::vector<std::optional<CircleScatter>> scatter_;  // one a joint
};

}  // namespace

void judge_plausibility(Identification& found, const Campaign& campaign) {
  Judge judge(found);  // what is told to have moved first, as it is why; what did not end last
  judge.judge_external_axes();
  judge.judge_external_places();
  if (auto contradiction = contradiction_of_specified(found, campaign))
    found.doubts.push_back(std::move(*contradiction));
  judge.judge_strokes(campaign.resolution);
  for (Warning& one : joints_along(found, true)) found.doubts.push_back(std::move(one));
  // A target that was moved on the tool has no place at home.
  if (std::none_of(found.doubts.begin(), found.doubts.end(),
                   [](const Warning& one) { return one.code == "target_moved"; }))
    judge_home(found, campaign.timed);
  judge_linear_joints(found);
  judge.judge_fit();
}

}  // namespace identify
