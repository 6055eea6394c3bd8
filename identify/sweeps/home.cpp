#include "identify/sweeps/home.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/sweeps/linear_joint.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

using Eigen::Vector3d;

/// Locked joints come back to their place by better than this.
constexpr double kSame_rad = 0.02 * kDegree;
/// The end of a stroke is seen with its ramp cut off a little.
constexpr double kEnd_rad = 0.5 * kDegree;
constexpr double kEndSizes = 8;  // of the noise

bool has_angles(const Sweep& sweep) {
  return sweep.first().joints > 0;
}

bool tells_locked(const Sweep& sweep, std::size_t joint) {
  return joint != sweep.joint && joint < sweep.first().joints;
}

double locked_angle(const Sweep& sweep, std::size_t joint) {
  double sum = 0;
  for (const Sample& sample : *sweep.samples) sum += sample.angles_rad[joint];
  return sum / static_cast<double>(sweep.samples->size());
}

double same_angle(const Resolution& resolution) {
  return std::max(kSame_rad, resolution.angle_rad);
}

/// Where a target rested while the turn went from one joint to another.
std::optional<Vector3d> home_point(const std::vector<Sweep>& sweeps, std::size_t target) {
  std::vector<Vector3d> points;
  const Sweep* before = nullptr;
  for (const Sweep& sweep : sweeps) {
    if (!sweep.joint || sweep.target != target || !sweep.first().has_position) continue;
    if (before != nullptr && before->joint != sweep.joint) {
      points.push_back(before->last().position_mm);
      points.push_back(sweep.first().position_mm);
    }
    before = &sweep;
  }
  if (points.empty()) return std::nullopt;
  return median(points);  // one joint that did not come home must not shift it
}

/// A stroke of a joint by its ends. Within `near` one is at a place: of its joint's angle (rad) or,
/// without angles, of the target (mm). Negative, which nothing is within, where neither is told.
struct Stroke {
  Sweep* sweep;
  double near;
  std::vector<const Sample*> away_from_home = {};

  Stroke(Sweep& of, const Resolution& resolution) : sweep(&of), near(near_of(of, resolution)) {}

  /// Whether another sweep of the joint comes by where this one ends, with the other joints where
  /// they stood then. Both have lost their ramps.
  [[nodiscard]] bool ends_on(const Sweep& other, const Resolution& resolution) const {
    if (other.joint != sweep->joint || other.target != sweep->target ||
        has_angles(other) != has_angles(*sweep))
      return false;
    const double locked = std::max(kSameHome_rad, 2 * resolution.angle_rad);
    const auto comes_by = [&](const Sample& end, const Sample& sample) {
      if (!has_angles(*sweep)) return (sample.position_mm - end.position_mm).norm() <= 2 * near;
      for (std::size_t k = 0; k < end.joints; ++k)
        if (std::abs(sample.angles_rad[k] - end.angles_rad[k]) >
            (k == *sweep->joint ? 2 * near : locked))
          return false;
      return true;
    };
    return std::all_of(away_from_home.begin(), away_from_home.end(), [&](const Sample* end) {
      return std::any_of(other.samples->begin(), other.samples->end(),
                         [&](const Sample& sample) { return comes_by(*end, sample); });
    });
  }

 private:
  static double near_of(const Sweep& sweep, const Resolution& resolution) {
    if (has_angles(sweep)) return std::max(kEnd_rad, 2 * resolution.angle_rad);
    const auto points = positions(*sweep.samples);
    if (const auto line = fit_line(points);
        line && straightness(*line, {}) == Straightness::straight)
      return kEnd_rad * kLinear_mm;
    const auto usual = fit_usual_circle(points);
    if (!usual) return -1;
    // The ends of a stroke are cut off as far as noise hides them, and are noisy themselves.
    const CircleFit& circle = usual->circle;
    const double noise = std::max(circle.plane_rms_mm, circle.radial_rms_mm);
    return std::max({kEnd_rad * circle.radius_mm, 2 * resolution.position_mm, kEndSizes * noise});
  }
};

}  // namespace

std::vector<std::optional<double>> find_home(const std::vector<Sweep>& sweeps, std::size_t joints,
                                             const Resolution& resolution) {
  struct Place {
    double angle = 0;
    std::set<std::size_t> swept;  // by how many other joints
    std::size_t samples = 0;
  };
  std::vector<std::optional<double>> home(joints);
  // Only sweeps that fit to what is found: with several homes it must not be made of parts of them.
  std::vector<const Sweep*> fitting;
  for (const Sweep& sweep : sweeps)
    if (sweep.joint && has_angles(sweep)) fitting.push_back(&sweep);
  for (std::size_t k = 0; k < joints; ++k) {
    std::vector<Place> places;
    for (const Sweep* sweep : fitting) {
      if (!tells_locked(*sweep, k)) continue;
      const double angle = locked_angle(*sweep, k);
      auto place = std::find_if(places.begin(), places.end(), [&](const Place& known) {
        return std::abs(known.angle - angle) <= same_angle(resolution);
      });
      if (place == places.end()) place = places.insert(places.end(), Place{angle, {}, 0});
      const auto more = sweep->samples->size();
      const auto all = static_cast<double>(place->samples + more);
      place->angle += (angle - place->angle) * static_cast<double>(more) / all;
      place->samples += more;
      place->swept.insert(*sweep->joint);
    }
    const auto best =
        std::max_element(places.begin(), places.end(), [](const Place& a, const Place& b) {
          return std::pair(a.swept.size(), a.samples) < std::pair(b.swept.size(), b.samples);
        });
    if (best == places.end()) continue;
    home[k] = best->angle;
    std::erase_if(fitting, [&](const Sweep* sweep) {
      return tells_locked(*sweep, k) &&
             std::abs(locked_angle(*sweep, k) - *home[k]) > kSameHome_rad;
    });
  }
  return home;
}

double off_home_rad(const Sweep& sweep, const std::vector<std::optional<double>>& home) {
  double farthest = 0;
  for (std::size_t k = 0; k < home.size(); ++k)
    if (tells_locked(sweep, k) && home[k])
      farthest = std::max(farthest, std::abs(locked_angle(sweep, k) - *home[k]));
  return farthest;
}

bool at_home(const Sweep& sweep, const std::vector<std::optional<double>>& home,
             const Resolution& resolution) {
  return off_home_rad(sweep, home) <= same_angle(resolution);
}

void mark_positioning(std::vector<Sweep>& sweeps, const std::vector<std::optional<double>>& home,
                      const Resolution& resolution) {
  std::map<std::size_t, std::optional<Vector3d>> rests;
  for (const Sweep& sweep : sweeps)
    if (!rests.contains(sweep.target)) rests[sweep.target] = home_point(sweeps, sweep.target);
  const auto touches = [&](const Stroke& stroke, const Sample& end) {
    const std::size_t joint = *stroke.sweep->joint;
    if (has_angles(*stroke.sweep))
      return home[joint] && std::abs(end.angles_rad[joint] - *home[joint]) <= stroke.near;
    const auto& rest = rests[stroke.sweep->target];
    return rest && (end.position_mm - *rest).norm() <= stroke.near;
  };
  std::vector<const Sweep*> proper;
  std::vector<Stroke> touching;
  for (Sweep& sweep : sweeps) {
    sweep.positioning = false;
    if (!sweep.joint || sweep.defect != SweepDefect::none) continue;
    Stroke stroke(sweep, resolution);
    for (const Sample* end : {&sweep.first(), &sweep.last()})
      if (!touches(stroke, *end)) stroke.away_from_home.push_back(end);
    if (stroke.away_from_home.size() == 2)
      proper.push_back(&sweep);
    else
      touching.push_back(std::move(stroke));
  }
  for (const Stroke& stroke : touching)
    stroke.sweep->positioning = std::any_of(proper.begin(), proper.end(), [&](const Sweep* other) {
      return stroke.ends_on(*other, resolution);
    });
}

}  // namespace identify
