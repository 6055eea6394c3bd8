#include "daemon/results/correctable.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "daemon/points/point_poses.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/results/told_arm.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

[[noreturn]] void refuse(const Correctable& of, const std::string& why) {
  throw std::runtime_error(of.file.string() + ' ' + why);
}

void check_kind(const Correctable& of, const Json& json) {
  const std::string status = text_of(json, "status");
  const std::string reason = text_of(json, "reason");
  if (status == "failed" || status == "doubtful")
    refuse(of, "is " + status + ", nothing is corrected by it: " + reason);
  if (text_of(json, "describes") != "arm")
    refuse(of,
           "is the controller's own model, seen through RSI. It tells nothing that the controller "
           "does not know: measure the arm with another device");
  if (!json.contains("poses"))
    refuse(of,
           "was not made of static poses, which alone tell how angles make a position: identify "
           "from poses, or from sweeps and poses");
  if (list_of(part_of(json, "poses"), "levels").empty())
    refuse(of,
           "has no specified table, so nobody knows what the controller computes with: identify "
           "again with --robot");
}

void read_poses(Correctable& of, const Json& json) {
  const std::size_t joints = of.identified.fit.model.chain.axes.size();
  const auto file = of.file.parent_path() / file_names::kPoses;
  PointsReader reader({}, joints);
  of.poses = static_poses(reader.read(file, {}), joints);
  const Json& poses = part_of(json, "poses");
  const auto count = number_of(poses, "count");
  const std::size_t targets = of.identified.fit.model.chain.targets_mm.size();
  const auto target_of = [&](const std::string& name) {
    std::size_t number = 0;
    std::from_chars(name.data(), name.data() + name.size(), number);
    return number - 1;
  };
  for (auto& pose : of.poses) pose.target = target_of(reader.targets().at(pose.target));
  const bool known = std::all_of(of.poses.begin(), of.poses.end(),
                                 [&](const auto& pose) { return pose.target < targets; });
  if (static_cast<double>(of.poses.size()) != count || !known)
    throw std::runtime_error(file.string() +
                             " is not that of the result.json beside it: identify again");
  of.weights = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(of.poses.size()));
  for (const Json& one : list_of(poses, "outliers"))
    if (const auto at = one.get<std::size_t>(); at >= 1 && at <= of.poses.size())
      of.weights(static_cast<Eigen::Index>(at - 1)) = 0;
  for (std::size_t j = 0; j < joints; ++j) {
    std::pair<double, double> range{kInfinite, -kInfinite};
    for (const auto& pose : of.poses) {
      range.first = std::min(range.first, pose.sample.angles_rad[j]);
      range.second = std::max(range.second, pose.sample.angles_rad[j]);
    }
    of.measured.push_back(range);
  }
}

void read_limits(Correctable& of, const Json& json) {
  const Json& limits = list_of(json, "limits_deg");
  for (std::size_t j = 0; j < of.measured.size(); ++j) {
    std::pair<double, double> range{-kInfinite, kInfinite};
    if (j < limits.size() && limits[j].is_array() && limits[j].size() == 2) {
      if (limits[j][0].is_number()) range.first = radians(limits[j][0].get<double>());
      if (limits[j][1].is_number()) range.second = radians(limits[j][1].get<double>());
    }
    of.limits.push_back(range);
  }
}

}  // namespace

Correctable read_correctable(const std::filesystem::path& path) {
  Correctable of;
  of.file = result_file(path);
  const Json json = read_result(of.file);
  of.robot = text_of(json, "robot");
  check_kind(of, json);
  try {
    of.identified = pose_predictor(json.at("poses"));
    for (const Json& joint : list_of(json, "joints"))
      if (!part_of(joint, "axis").is_object())
        of.open.push_back(joint.at("joint").get<std::size_t>());
  } catch (const std::exception& error) {
    refuse(of, std::string("is not as sweepd writes it (") + error.what() + "): identify again");
  }
  const auto& controller = of.controller();
  const auto& model = of.identified.fit.model;
  if (controller.arm.joints() != model.chain.axes.size() ||
      controller.targets_mm.size() != model.chain.targets_mm.size() ||
      controller.targets_mm.empty())
    refuse(of, "has a specified table of another arm: identify again");
  read_poses(of, json);
  read_limits(of, json);
  return of;
}

}  // namespace sweepd
