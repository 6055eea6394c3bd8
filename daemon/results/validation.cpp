#include "daemon/results/validation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <spdlog/fmt/fmt.h>

#include "daemon/results/json_parts.hpp"
#include "daemon/results/report.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/symmetric_eigen.hpp"
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

Visits visited(const PosePredictor& predictor, const std::vector<const identify::Pose*>& visits) {
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
    if (place.size() >= kFewestVisits) all.push_back(visited(predictor, place));
  return all;
}

Json left_json(const identify::Left& of) {
  return {{"mean_mm", json_length(of.mean_mm)},
          {"rms_mm", json_length(of.rms_mm)},
          {"max_mm", json_length(of.most_mm)}};
}

JudgedPoses judged(const PosePredictor& predictor, const std::vector<identify::Pose>& poses) {
  JudgedPoses found;
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

/// The turn and shift from where poses were predicted to where they were seen. Of those that lie
/// far off, the second round takes no notice.
Eigen::Isometry3d from_predicted(const PosePredictor& predictor,
                                 const std::vector<identify::Pose>& poses) {
  constexpr double kFar = 4;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  double most_mm = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 2; ++round) {
    std::vector<Vector3d> told, seen;
    std::vector<double> off_mm;
    for (const auto& pose : poses) {
      const Vector3d predicted = predictor.position_mm(pose);
      off_mm.push_back((pose.sample.position_mm - frame * predicted).norm());
      if (off_mm.back() > most_mm) continue;
      told.push_back(predicted);
      seen.push_back(pose.sample.position_mm);
    }
    const auto columns = [](const std::vector<Vector3d>& points) {
      Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(points.size()));
      for (Eigen::Index i = 0; i < all.cols(); ++i)
        all.col(i) = points[static_cast<std::size_t>(i)];
      return all;
    };
    frame = identify::registered(columns(told), columns(seen));
    off_mm.clear();
    for (const auto& pose : poses)
      off_mm.push_back((pose.sample.position_mm - frame * predictor.position_mm(pose)).norm());
    most_mm = kFar * identify::median_of(std::move(off_mm));
  }
  return frame;
}

/// Six numbers need three points; of these few nothing is left to judge. Nor do points on a line
/// tell a frame.
constexpr std::size_t kFewestInFrame = 6;
constexpr double kOnALine_mm = 30;
/// Poses that lie farther off than by this, or most of them beyond what the result says, and so
/// many times as far as in the frame that fits them.
constexpr double kOtherFrame_mm = 0.2;
constexpr double kOtherFrame = 3;

std::optional<OtherFrame> other_frame(const PosePredictor& predictor,
                                      const std::vector<identify::Pose>& poses,
                                      const JudgedPoses& as_seen) {
  const bool as_said = 2 * as_seen.inside() >= poses.size();
  if (poses.size() < kFewestInFrame || (as_seen.left.mean_mm < kOtherFrame_mm && as_said))
    return std::nullopt;
  const Eigen::Isometry3d frame = from_predicted(predictor, poses);
  const auto count = static_cast<double>(poses.size());
  Vector3d middle = Vector3d::Zero();
  for (const auto& pose : poses) middle += predictor.position_mm(pose) / count;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  auto brought = poses;
  for (auto& pose : brought) {
    const Vector3d from_middle = predictor.position_mm(pose) - middle;
    spread += from_middle * from_middle.transpose() / count;
    pose.sample.position_mm = frame.inverse() * pose.sample.position_mm;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> along(spread);
  if (along.eigenvalues()(1) < kOnALine_mm * kOnALine_mm) return std::nullopt;
  OtherFrame found{(frame * middle - middle).norm(),
                   Eigen::AngleAxisd(Eigen::Matrix3d(frame.linear())).angle(),
                   judged(predictor, brought)};
  if (as_seen.left.mean_mm < kOtherFrame * found.judged.left.mean_mm) return std::nullopt;
  return found;
}

}  // namespace

std::size_t JudgedPoses::inside() const {
  return static_cast<std::size_t>(
      std::count_if(poses.begin(), poses.end(), [](const Off& pose) { return pose.inside; }));
}

Validation validated(const PosePredictor& predictor, const std::vector<identify::Pose>& poses) {
  Validation found{judged(predictor, poses), std::nullopt};
  found.frame = other_frame(predictor, poses, found);
  return found;
}

namespace {

/// No arm changes by as much.
constexpr double kFarOff_mm = 8;
/// So many poses most of which lie outside are no chance.
constexpr std::size_t kFewestToJudge = 6;

std::string left_text(const identify::Left& of) {
  return fmt::format("mean {:.4f} mm, rms {:.4f} mm, max {:.4f} mm", of.mean_mm, of.rms_mm,
                     of.most_mm);
}

std::string inside_text(const JudgedPoses& of) {
  return fmt::format("{} of {} ({:.1f} %) lie in their 95 % ellipsoids", of.inside(),
                     of.poses.size(),
                     100 * static_cast<double>(of.inside()) / static_cast<double>(of.poses.size()));
}

Json levels_json(const JudgedPoses& of) {
  Json levels = Json::array();
  for (std::size_t f = 0; f < of.levels.size(); ++f) {
    levels.push_back({{"free", words(static_cast<identify::Freedom>(f))}});
    levels.back().update(left_json(of.levels[f]));
  }
  return levels;
}

}  // namespace

std::string validation_text(const Validation& validation) {
  std::string text = paragraph("off by      ", left_text(validation.left) + " of " +
                                                   rsi::counted(validation.poses.size(), "pose") +
                                                   " that the result was not made of");
  text += paragraph("predicted   ", inside_text(validation));
  if (const auto& frame = validation.frame)
    text += paragraph("frame       ",
                      fmt::format("The poses were measured in another frame than the result's: in "
                                  "it the robot lies {:.3f} mm away, turned by {:.4f}°. The device "
                                  "was set up anew, or it or the robot was moved. In the frame "
                                  "that fits these poses: {}; {}. To judge where the robot "
                                  "stands, too, measure poses before anything is moved",
                                  frame->moved_mm, frame->turned_rad / identify::kDegree,
                                  left_text(frame->judged.left), inside_text(frame->judged)));
  else if (validation.left.mean_mm > kFarOff_mm)
    text += paragraph("",
                      "The poses lie far off: check that units, columns and targets are those of "
                      "the result. Where the device was set up anew, give six poses or more, far "
                      "apart: then the frame is told");
  const JudgedPoses& found = validation.frame ? validation.frame->judged : validation;
  if (found.poses.size() >= kFewestToJudge && 2 * found.inside() < found.poses.size())
    text += paragraph("verdict     ",
                      "These poses contradict the result: 95 % of them should lie in their "
                      "ellipsoids. The arm has changed since, or is off in what the result's "
                      "uncertainties do not hold. Measure a campaign anew, and compare both "
                      "(`sweepd compare`)");
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
  json["levels"] = levels_json(found);
  if (const auto& frame = found.frame) {
    json["frame"] = {{"moved_mm", json_length(frame->moved_mm)},
                     {"turned_deg", json_angle(frame->turned_rad)}};
    json["frame"].update(left_json(frame->judged.left));
    json["frame"]["inside_95"] = frame->judged.inside();
    json["frame"]["levels"] = levels_json(frame->judged);
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
