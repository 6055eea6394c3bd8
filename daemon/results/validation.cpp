#include "daemon/results/validation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <spdlog/fmt/fmt.h>

#include "daemon/results/json_parts.hpp"
#include "daemon/results/report.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

/// The 95 % quantile of chi-square with three degrees of freedom.
constexpr double kInside = 7.815;
/// Angles of one commanded pose.
constexpr double kSame_rad = 1e-5;
constexpr std::size_t kFewestVisits = 3;

bool same_place(const identify::Pose& a, const identify::Pose& b) {
  if (a.target != b.target) return false;
  for (std::size_t j = 0; j < a.sample.joints; ++j)
    if (std::abs(a.sample.angles_rad[j] - b.sample.angles_rad[j]) > kSame_rad) return false;
  return true;
}

Visits judged(const PosePredictor& predictor, const std::vector<const identify::Pose*>& visits) {
  Visits found;
  found.first = visits.front()->name;
  found.count = visits.size();
  const auto count = static_cast<double>(visits.size());
  Vector3d mean = Vector3d::Zero();
  for (const auto* pose : visits) mean += pose->sample.position_mm / count;
  found.accuracy_mm = (mean - predictor.position_mm(*visits.front())).norm();
  double sum = 0, squares = 0;
  for (const auto* pose : visits) {
    const double away = (pose->sample.position_mm - mean).norm();
    sum += away;
    squares += away * away;
  }
  const double usual = sum / count;
  const double variance = std::max(0.0, (squares - count * usual * usual) / (count - 1));
  found.repeatability_mm = usual + 3 * std::sqrt(variance);
  return found;
}

std::vector<Visits> visits_of(const PosePredictor& predictor,
                              const std::vector<identify::Pose>& poses) {
  std::vector<std::vector<const identify::Pose*>> places;
  for (const auto& pose : poses) {
    const auto known = std::find_if(places.begin(), places.end(), [&](const auto& place) {
      return same_place(*place.front(), pose);
    });
    if (known == places.end())
      places.push_back({&pose});
    else
      known->push_back(&pose);
  }
  std::vector<Visits> all;
  for (const auto& place : places)
    if (place.size() >= kFewestVisits) all.push_back(judged(predictor, place));
  return all;
}

Json left_json(const identify::Left& of) {
  return {{"mean_mm", json_length(of.mean_mm)},
          {"rms_mm", json_length(of.rms_mm)},
          {"max_mm", json_length(of.most_mm)}};
}

}  // namespace

std::size_t Validation::inside() const {
  return static_cast<std::size_t>(
      std::count_if(poses.begin(), poses.end(), [](const Off& pose) { return pose.inside; }));
}

Validation validated(const PosePredictor& predictor, const std::vector<identify::Pose>& poses) {
  Validation found;
  Eigen::VectorXd distances(static_cast<Eigen::Index>(poses.size()));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector3d off = poses[i].sample.position_mm - predictor.position_mm(poses[i]);
    const Eigen::Matrix3d covariance = predictor.covariance_at(poses[i]);
    found.poses.push_back({poses[i].name, off, off.dot(covariance.llt().solve(off)) < kInside});
    distances(static_cast<Eigen::Index>(i)) = off.norm();
  }
  found.left = identify::left_of(distances);
  for (const auto& level : predictor.levels)
    found.levels.push_back(identify::left_of(identify::distances_mm(level, poses)));
  found.visits = visits_of(predictor, poses);
  return found;
}

std::string validation_text(const Validation& found) {
  const auto count = static_cast<double>(found.poses.size());
  std::string text = paragraph(
      "validated   ",
      fmt::format("mean {:.4f} mm, rms {:.4f} mm, max {:.4f} mm of {} that the result was not made "
                  "of",
                  found.left.mean_mm, found.left.rms_mm, found.left.most_mm,
                  rsi::counted(found.poses.size(), "pose")));
  text += paragraph("predicted   ", fmt::format("{} of {} ({:.1f} %) lie in their 95 % ellipsoids",
                                                found.inside(), found.poses.size(),
                                                100 * static_cast<double>(found.inside()) / count));
  if (!found.levels.empty()) {
    text += "\nWhat is left when so much of the specified arm is corrected\n\n" + left_header();
    for (std::size_t f = 0; f < found.levels.size(); ++f)
      text += left_line(words(static_cast<identify::Freedom>(f)), found.levels[f]);
    text += left_line("all that the result tells", found.left);
  }
  if (!found.visits.empty()) {
    text += "\nPoses visited again (ISO 9283)\n\n" + left("pose", 34) + right("visits", 10) +
            right("AP mm", 10) + right("RP mm", 10) + "\n";
    for (const Visits& visits : found.visits)
      text += left(visits.first, 34) + right(std::to_string(visits.count), 10) +
              number(visits.accuracy_mm, 4, 10) + number(visits.repeatability_mm, 4, 10) + "\n";
  }
  return text;
}

Json validation_json(const Validation& found) {
  Json json = {{"schema", "sweepd.validation/1"}, {"count", found.poses.size()}};
  json.update(left_json(found.left));
  json["inside_95"] = found.inside();
  json["levels"] = Json::array();
  for (std::size_t f = 0; f < found.levels.size(); ++f) {
    json["levels"].push_back({{"free", words(static_cast<identify::Freedom>(f))}});
    json["levels"].back().update(left_json(found.levels[f]));
  }
  json["visits"] = Json::array();
  for (const Visits& visits : found.visits)
    json["visits"].push_back({{"first", visits.first},
                              {"count", visits.count},
                              {"accuracy_mm", json_length(visits.accuracy_mm)},
                              {"repeatability_mm", json_length(visits.repeatability_mm)}});
  json["poses"] = Json::array();
  for (const auto& pose : found.poses)
    json["poses"].push_back(
        {{"name", pose.name},
         {"off_mm", {json_length(pose.mm.x()), json_length(pose.mm.y()), json_length(pose.mm.z())}},
         {"inside_95", pose.inside}});
  return json;
}

}  // namespace sweepd
