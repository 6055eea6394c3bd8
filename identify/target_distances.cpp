#include "identify/target_distances.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "identify/geometry/median.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/geometry/warning.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {
namespace {

/// What the chain does not allow for.
constexpr double kOtherDistance_mm = 0.5;
/// What changes once is alike before and behind it, to this share of the step.
constexpr double kSameShare = 0.2;
constexpr double kDistanceSigmas = 6;
constexpr std::size_t kFewestPictures = 10;
constexpr std::size_t kFewestStrokes = 4;

using Pair = std::pair<std::size_t, std::size_t>;

/// The distance of two targets while both ran along a sweep.
struct Distance {
  double time_s = 0;
  std::size_t joint = 0;
  double mm = 0;
  double sigma_mm = 0;
};

/// From the sweep at `time_s` on a distance is another one.
struct NewDistance {
  Pair targets;
  double time_s = 0;
  std::size_t joint = 0;
  double before_mm = 0, after_mm = 0;
};

/// Nothing where few pictures show both.
std::optional<Distance> distance_in(const Sweep& first, const Sweep& second) {
  std::vector<double> seen_mm;
  auto other = second.samples->begin();
  for (const Sample& sample : *first.samples) {
    while (other != second.samples->end() && other->time_s < sample.time_s) ++other;
    if (other == second.samples->end()) break;
    if (other->time_s == sample.time_s && other->angles_rad == sample.angles_rad &&
        sample.has_position && other->has_position)
      seen_mm.push_back((sample.position_mm - other->position_mm).norm());
  }
  if (seen_mm.size() < kFewestPictures) return std::nullopt;
  Distance distance{first.first().time_s, *first.joint, median_of(seen_mm), 0};
  for (double& mm : seen_mm) mm = std::abs(mm - distance.mm);
  const auto count = static_cast<double>(seen_mm.size());
  distance.sigma_mm =
      kErrorOfMedian * kSigmaByMedian * median_of(std::move(seen_mm)) / std::sqrt(count);
  return distance;
}

std::map<Pair, std::vector<Distance>> distances_in(const Identification& found) {
  std::map<Pair, std::vector<Distance>> all;
  for (const JointResult& joint : found.joints)
    for (const Sweep& first : joint.sweeps)
      for (const Sweep& second : joint.sweeps) {
        if (first.target >= second.target || !first.joint) continue;
        if (const auto distance = distance_in(first, second))
          all[{first.target, second.target}].push_back(*distance);
      }
  for (auto& [targets, distances] : all)
    std::stable_sort(distances.begin(), distances.end(),
                     [](const Distance& a, const Distance& b) { return a.time_s < b.time_s; });
  return all;
}

double usual_mm(std::vector<Distance>::const_iterator begin,
                std::vector<Distance>::const_iterator end) {
  std::vector<double> all;
  for (; begin != end; ++begin) all.push_back(begin->mm);
  return median_of(std::move(all));
}

/// `sigmas`: so many of a distance's own are chance.
std::optional<NewDistance> new_distance(const Pair& targets, const std::vector<Distance>& distances,
                                        double sigmas) {
  if (distances.size() < kFewestStrokes) return std::nullopt;
  double chance_mm = 0;
  for (const Distance& one : distances) chance_mm = std::max(chance_mm, sigmas * one.sigma_mm);
  std::optional<NewDistance> within;  // a stroke
  for (auto cut = distances.begin() + 1; cut != distances.end(); ++cut) {
    const NewDistance step{targets, cut->time_s, cut->joint, usual_mm(distances.begin(), cut),
                           usual_mm(cut, distances.end())};
    const double by_mm = std::abs(step.after_mm - step.before_mm);
    if (by_mm < kOtherDistance_mm + chance_mm) continue;
    const auto strange = [&](const Distance& one) {
      const double usual = one.time_s < cut->time_s ? step.before_mm : step.after_mm;
      return std::abs(one.mm - usual) > kSameShare * by_mm;
    };
    const auto count = std::count_if(distances.begin(), distances.end(), strange);
    if (count == 0) return step;
    if (count == 1 && strange(*cut)) within = step;
  }
  return within;
}

std::string named(std::size_t target) {
  return "target " + std::to_string(target + 1);
}

/// The two that stand where the other one stood, by what is between them and all others.
std::optional<Pair> exchanged(const std::vector<NewDistance>& steps) {
  for (const NewDistance& one : steps)
    for (const NewDistance& other : steps) {
      if (&one == &other) continue;
      const auto [a, b] = one.targets;
      const auto [c, d] = other.targets;
      Pair two;
      if (a == c)
        two = {b, d};
      else if (a == d)
        two = {b, c};
      else if (b == c)
        two = {a, d};
      else if (b == d)
        two = {a, c};
      else
        continue;
      const double by_mm = std::abs(one.after_mm - one.before_mm);
      if (std::abs(one.after_mm - other.before_mm) < kSameShare * by_mm &&
          std::abs(other.after_mm - one.before_mm) < kSameShare * by_mm)
        return Pair{std::min(two.first, two.second), std::max(two.first, two.second)};
    }
  return std::nullopt;
}

/// The one whose distances changed from several others, which did not from each other.
std::optional<std::size_t> moved_alone(const std::vector<NewDistance>& steps) {
  std::map<std::size_t, std::size_t> counts;
  for (const NewDistance& step : steps) {
    ++counts[step.targets.first];
    ++counts[step.targets.second];
  }
  for (const auto& [target, count] : counts)
    if (count == steps.size() && steps.size() > 1) return target;
  return std::nullopt;
}

}  // namespace

std::optional<Warning> changed_distances(const Identification& found) {
  const double sigmas = kDistanceSigmas * std::sqrt(found.samples_per_independent());
  std::vector<NewDistance> steps;
  for (const auto& [targets, seen] : distances_in(found))
    if (const auto step = new_distance(targets, seen, sigmas)) steps.push_back(*step);
  if (steps.empty()) return std::nullopt;
  const NewDistance& first = *std::min_element(
      steps.begin(), steps.end(),
      [](const NewDistance& a, const NewDistance& b) { return a.time_s < b.time_s; });
  std::string message = "from a sweep of " + joint_name(first.joint) + " on, at " +
                        fixed(first.time_s, 1) + " s, " + named(first.targets.first) + " and " +
                        named(first.targets.second) + " are " + fixed(first.after_mm, 1) +
                        " mm apart, and were " + fixed(first.before_mm, 1) + " mm before: ";
  if (const auto two = exchanged(steps))
    message += named(two->first) + " and " + named(two->second) +
               " have exchanged their names: correct them in the device's program, or give what "
               "was measured before and behind it as other targets";
  else if (const auto one = moved_alone(steps))
    message += named(*one) +
               " was moved on the tool: leave it out, or name it as another target from there on";
  else
    message +=
        "one of them was moved on the tool, or has the name of another one: fasten the "
        "targets, and sweep again";
  return Warning{"target_moved", first.joint, std::move(message)};
}

}  // namespace identify
