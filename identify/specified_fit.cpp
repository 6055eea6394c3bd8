#include "identify/specified_fit.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "identify/dh/base_height.hpp"
#include "identify/geometry/warning.hpp"

namespace identify {
namespace {

using Axes = std::vector<std::optional<Axis>>;

constexpr double kSigmas = 4;
/// Rows whose axes are specified as parallel: where the common normal lies is chance.
constexpr double kParallel_rad = 5 * kDegree;
/// Found lengths of so few in all, and specified ones so short, tell no unit.
constexpr double kTelling_mm = 20;
/// What lengths in another unit are multiplied by, and as what they look like.
struct Unit {
  double factor;
  const char* text;
};
constexpr Unit kUnits[] = {
    {1000, "1000 times smaller than specified: are the positions in metres?"},
    {1e-3,
     "1000 times larger than specified: are the positions in micrometres, or in mm under names in "
     "m?"},
    {25.4, "25.4 times smaller than specified: are the positions in inches?"}};
constexpr double kAboutUnit = 1.3;
/// No robot's target runs on circles that are all smaller or larger than that.
constexpr double kSmallest_mm = 10;
constexpr double kLargest_mm = 30000;
/// Of radians that were taken for degrees it is 57.
constexpr double kMuchFarther = 10;
/// All senses of rotation are tried for so many joints: 256 tables.
constexpr std::size_t kMostSenses = 8;

/// The number that is furthest off, in units of what a built robot can be off.
struct Worst {
  double excess = 0;  ///< more than 1: no robot is like that
  std::size_t row = 0;
  std::string text;  ///< as in "a is -120.0 mm, specified is 120.0"
};

double arm_mm(const std::vector<DhRow>& rows) {
  double sum = 0;
  for (const DhRow& row : rows) sum += std::abs(row.a_mm) + std::abs(row.b_mm);
  return sum;
}

bool parallel(const DhRow& row) {
  return std::abs(std::sin(row.alpha_rad)) < std::sin(kParallel_rad);
}

Worst worst_of(const std::vector<DhEstimate>& dh, const std::vector<DhRow>& specified,
               const std::vector<std::optional<double>>& home_rad) {
  const double length = std::max(kMostOff_mm, kMostOffShare * arm_mm(specified));
  Worst worst;
  const auto judge = [&](bool is_angle, std::size_t row, const char* name, const DhNumber& number,
                         double expected, double most) {
    if (number.knowledge != Knowledge::identified) return;
    const double off = is_angle ? wrapped(number.value - expected) : number.value - expected;
    const double excess = (std::abs(off) - kSigmas * number.sigma) / most;
    if (!(excess > worst.excess)) return;
    const auto shown = [&](double value) {
      return is_angle ? fixed(value / kDegree, 1) + "°" : fixed(value, 1) + " mm";
    };
    worst = {
        excess, row,
        std::string(name) + " is " + shown(number.value) + ", specified is " + shown(expected)};
  };
  // The last row leads to the tool: it is by convention.
  for (std::size_t i = 0; i + 1 < dh.size(); ++i) {
    // Axes that are parallel by specification and a little askew have normals anywhere.
    const auto askew = [&](std::size_t row) {
      return parallel(specified[row]) && dh[row].relation != Relation::parallel;
    };
    // Of axes that are one by specification, and a little apart, the normal points anywhere.
    const auto one = [&](std::size_t row) {
      return parallel(specified[row]) && std::abs(specified[row].a_mm) < length;
    };
    const bool loose = askew(i) || (i > 0 && askew(i - 1));
    judge(true, i, "alpha", dh[i].alpha_rad, specified[i].alpha_rad, kMostTwist_rad);
    if (loose) continue;
    judge(false, i, "a", dh[i].a_mm, specified[i].a_mm, length);
    if (i == 0) continue;  // where the base stands
    judge(false, i, "b", dh[i].b_mm, specified[i].b_mm, length);
    if (home_rad[i] && !one(i) && !one(i - 1))
      judge(true, i, "theta", dh[i].theta_rad, specified[i].theta_rad, kMostOff_rad);
  }
  return worst;
}

/// The found lengths' sum as a multiple of the specified ones'; nothing where that tells nothing.
std::optional<double> size_ratio(const std::vector<DhEstimate>& dh,
                                 const std::vector<DhRow>& specified) {
  double found = 0;
  double expected = 0;
  for (std::size_t i = 0; i + 1 < dh.size(); ++i) {
    const auto add = [&](const DhNumber& number, double length) {
      if (number.knowledge != Knowledge::identified || std::abs(length) < kTelling_mm) return;
      found += std::abs(number.value);
      expected += std::abs(length);
    };
    add(dh[i].a_mm, specified[i].a_mm);
    if (i > 0) add(dh[i].b_mm, specified[i].b_mm);
  }
  if (!(expected > 0) || !(found > 0)) return std::nullopt;
  return found / expected;
}

/// Tries what may explain a table that cannot be.
class Explanation {
 public:
  Explanation(const Identification& found, const Campaign& campaign)
      : campaign_(campaign), home_rad_(found.home_rad), specified_(found.specified) {
    for (const JointResult& joint : found.joints) {
      axes_.push_back(joint.axis);
      for (const Sweep& sweep : joint.sweeps) told_ = told_ || sweep.first().joints > 0;
    }
  }

  [[nodiscard]] bool fits_scaled(double factor) const {
    Axes scaled = axes_;
    for (auto& axis : scaled) {
      if (!axis) continue;
      axis->point_mm *= factor;
      axis->covariance.bottomRows<3>() *= factor;
      axis->covariance.rightCols<3>() *= factor;
    }
    return fits(scaled, specified_, home_rad_, !told_);
  }

  [[nodiscard]] bool fits_mirrored() const {
    return fits(mirrored(axes_), specified_, home_rad_, !told_);
  }

  /// With the senses of the plan that the table contradicts. The mirror image of an arm that lies
  /// in a plane is the arm, with other senses.
  [[nodiscard]] bool fits_mirrored_as_planned(const std::vector<JointResult>& joints) const {
    Axes planned = axes_;
    bool against = false;
    for (std::size_t j = 0; j < joints.size(); ++j)
      if (joints[j].against_plan && planned[j]) {
        planned[j] = planned[j]->reversed();
        against = true;
      }
    return against && fits(mirrored(planned), specified_, home_rad_, false);
  }

  [[nodiscard]] bool fits_with_other_senses() const {
    return !told_ && fits(axes_, specified_, home_rad_, true);
  }

  [[nodiscard]] bool fits_negated(std::size_t j) const {
    if (!told_ || !axes_[j]) return false;
    Axes axes = axes_;
    auto specified = specified_;
    axes[j] = axes[j]->reversed();
    if (home_rad_[j]) specified[j] = specified_row(*campaign_.specified, j, -*home_rad_[j]);
    return fits(axes, specified, home_rad_, false);
  }

  /// Home alone may fit by chance: the strokes are seen to turn so much farther than told, too.
  [[nodiscard]] bool fits_in_radians(const std::vector<JointResult>& joints) const {
    for (std::size_t j = 0; j < joints.size(); ++j)
      for (std::size_t s = 0; s < joints[j].sweeps.size(); ++s) {
        const Sweep& sweep = joints[j].sweeps[s];
        if (!joints[j].used[s] || !joints[j].circle || sweep.first().joints <= j) continue;
        const double told = std::abs(sweep.last().angles_rad[j] - sweep.first().angles_rad[j]);
        if (joints[j].circle->arc_rad < kMuchFarther * told) return false;
      }
    auto specified = specified_;
    for (std::size_t j = 0; j < specified.size(); ++j) {
      if (!home_rad_[j]) continue;
      specified[j] = specified_row(*campaign_.specified, j, *home_rad_[j] / kDegree);
    }
    return told_ && fits(axes_, specified, home_rad_, false);
  }

  /// A joint's angles are exchanged with it.
  [[nodiscard]] bool fits_exchanged(std::size_t i, std::size_t j) const {
    Axes axes = axes_;
    auto home = home_rad_;
    auto specified = specified_;
    std::swap(axes[i], axes[j]);
    if (told_) {
      std::swap(home[i], home[j]);
      for (const std::size_t k : {i, j})
        if (home[k]) specified[k] = specified_row(*campaign_.specified, k, *home[k]);
    }
    return fits(axes, specified, home, !told_);
  }

 private:
  /// In a mirror right-hand rotations are left-hand ones; what moves along a line does so there.
  static Axes mirrored(Axes axes) {
    const Eigen::Vector3d mirror(1, 1, -1);
    for (auto& axis : axes) {
      if (!axis) continue;
      const Eigen::Vector3d turned = axis->linear ? mirror : Eigen::Vector3d(-mirror);
      axis->point_mm = mirror.asDiagonal() * axis->point_mm;
      axis->direction = turned.asDiagonal() * axis->direction;
      Eigen::Matrix<double, 6, 1> both;
      both << turned, mirror;
      axis->covariance = both.asDiagonal() * axis->covariance * both.asDiagonal();
    }
    return axes;
  }

  /// `any_senses`: nothing tells them, any will do.
  [[nodiscard]] bool fits(const Axes& positive, const std::vector<DhRow>& specified,
                          const std::vector<std::optional<double>>& home_rad,
                          bool any_senses) const {
    Axes z = positive;
    for (std::size_t k = 0; k < z.size(); ++k)
      if (z[k] && campaign_.specified->positive[k] < 0) z[k] = z[k]->reversed();
    const double size = arm_mm(specified);
    const std::size_t senses =
        any_senses && z.size() <= kMostSenses ? std::size_t{1} << z.size() : 1;
    for (std::size_t flips = 0; flips < senses; ++flips) {
      Axes tried = z;
      for (std::size_t k = 0; k < z.size(); ++k)
        if (tried[k] && (flips >> k & 1) != 0) tried[k] = tried[k]->reversed();
      // A few metres of height, of which nothing may tell, change numbers by millimetres: they are
      // compared all the same, or any order of parallel joints would fit.
      if (campaign_.device_frame) tried = seen_from_base(std::move(tried), size, specified);
      if (worst_of(extract_dh(tried, size, specified), specified, home_rad).excess <= 1)
        return true;
    }
    return false;
  }

  const Campaign& campaign_;
  Axes axes_;
  std::vector<std::optional<double>> home_rad_;
  std::vector<DhRow> specified_;
  bool told_ = false;  // the angles
};

std::optional<Warning> explained(const Explanation& explanation, const Identification& found) {
  const auto ratio = size_ratio(found.dh, found.specified);
  const std::size_t joints = found.joints.size();
  for (const Unit& unit : kUnits) {
    if (!ratio || std::abs(std::log(*ratio * unit.factor)) > std::log(kAboutUnit)) continue;
    if (explanation.fits_scaled(unit.factor))
      return Warning{"unit_factor", {}, std::string("all lengths are ") + unit.text};
  }
  if (explanation.fits_with_other_senses()) return std::nullopt;
  std::optional<std::size_t> negated;
  for (std::size_t j = 0; j < joints && !negated; ++j)
    if (explanation.fits_negated(j)) negated = j;
  // The mirror image of a SCARA is that SCARA, with a third joint that goes the other way.
  if (explanation.fits_mirrored())
    return Warning{"frame_mirrored",
                   {},
                   "the measurement frame is mirrored (left-handed): with one coordinate negated "
                   "the positions fit the specified table" +
                       (negated ? ". So they do with the angles of " + joint_name(*negated) +
                                      " negated: see which of the two it is"
                                : std::string())};
  if (explanation.fits_in_radians(found.joints))
    return Warning{"unit_factor",
                   {},
                   "the angles look like radians: so taken, strokes and home fit. Give them in "
                   "degrees"};
  if (negated)
    return Warning{"angles_negated", negated,
                   "the angles of " + joint_name(*negated) +
                       " have the other sign: negated they fit the specified table. Negate them, "
                       "or correct `positive` in the description"};
  std::string pairs;
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < joints; ++i)
    for (std::size_t j = i + 1; j < joints; ++j) {
      if (found.dh[i].linear != found.dh[j].linear || !explanation.fits_exchanged(i, j)) continue;
      if (!first) first = i;
      pairs +=
          (pairs.empty() ? "" : ", or ") + std::to_string(i + 1) + " and " + std::to_string(j + 1);
    }
  if (!first) return std::nullopt;
  return Warning{
      "joints_exchanged", first,
      "two joints are exchanged: joints " + pairs + " the other way round fit the specified table"};
}

/// Where no table says how large the robot is.
std::optional<Warning> no_robots_size(const Identification& found) {
  double largest_mm = 0;
  for (const JointResult& joint : found.joints)
    if (joint.circle) largest_mm = std::max(largest_mm, joint.circle->radius_mm);
  if (largest_mm == 0 || (largest_mm > kSmallest_mm && largest_mm < kLargest_mm))
    return std::nullopt;
  return Warning{
      "unit_factor",
      {},
      "the largest circle has a radius of " + brief(largest_mm) +
          " mm, and no robot is like that: are the positions in " +
          (largest_mm < kLargest_mm ? "metres?" : "micrometres, or in mm under names in m?")};
}

}  // namespace

std::optional<Warning> contradiction_of_specified(const Identification& found,
                                                  const Campaign& campaign) {
  if (!campaign.specified) return no_robots_size(found);
  if (found.specified.empty() || found.dh.size() != found.specified.size()) return std::nullopt;
  const Worst worst = worst_of(found.dh, found.specified, found.home_rad);
  const Explanation explanation(found, campaign);
  if (worst.excess <= 1) {
    if (!explanation.fits_mirrored_as_planned(found.joints)) return std::nullopt;
    return Warning{"frame_mirrored",
                   {},
                   "joints turned against the plan, as the specified table has it: the measurement "
                   "frame is mirrored (left-handed), or another program ran. Negate one coordinate "
                   "if the frame is left-handed, else give the plan that was run"};
  }
  if (auto cause = explained(explanation, found)) return cause;
  const bool by_sense = explanation.fits_with_other_senses();
  // That nothing tells the senses was said, with the tables that they may give: no robot is to
  // blame.
  if (by_sense && std::any_of(found.warnings.begin(), found.warnings.end(),
                              [](const Warning& one) { return one.code == "direction_ambiguous"; }))
    return std::nullopt;
  std::string message =
      "joint " + std::to_string(worst.row + 1) + ": " + worst.text +
      ": no built robot is so far off its specified table. Is it this robot, "
      "did its joints move one at a time, and are home and the joints' order right?";
  if (by_sense) message += " With other senses of rotation the table fits";
  return Warning{"specified_contradicted", worst.row, std::move(message)};
}

}  // namespace identify
