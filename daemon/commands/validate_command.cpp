#include "daemon/commands/validate_command.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/points/missing_angles.hpp"
#include "daemon/points/point_poses.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/results/displacement_csv.hpp"
#include "daemon/results/told_arm.hpp"
#include "daemon/results/validation.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::Pose;

/// poses.csv has so many decimals.
constexpr double kSame_mm = 1e-5;
constexpr double kSamePose_rad = 1e-7;

struct Result {
  PosePredictor predictor;
  std::vector<JointLimits> limits;
  std::string doubt;  // a sentence; empty where it is complete
};

Result result_in(const std::filesystem::path& file) {
  const auto json = read_result(file);
  try {
    if (json.contains("poses"))
      return {pose_predictor(json.at("poses")), limits_in(json),
              told_status("The result", text_of(json, "status"), text_of(json, "reason"))};
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": is not as sweepd writes it (" + error.what() +
                             "): identify again");
  }
  throw std::runtime_error(file.string() +
                           ": was not made of static poses, which alone tell how angles make a "
                           "position: identify from poses, or from sweeps and poses");
}

struct Poses {
  std::vector<Pose> poses;
  std::vector<std::string> targets;
  std::string untold;  // why there may be none
};

Poses read_poses(const std::vector<std::filesystem::path>& files, const std::string& columns,
                 const std::vector<JointKind>& kinds) {
  const std::size_t joints = kinds.size();
  PointsReader reader(column_names(columns), joints, {}, kinds);
  Poses read;
  for (const auto& path : files) {
    const PointsFile file = reader.read(path, {});
    for (auto& pose : static_poses(file, joints)) read.poses.push_back(std::move(pose));
    if (const auto missing = missing_angles(file)) read.untold = missing->message;
  }
  read.targets = reader.targets();
  return read;
}

/// Targets as the predictor counts them. One target needs no name.
void name_targets(Poses& read, const PosePredictor& predictor) {
  if (read.targets.size() == 1 && predictor.targets.size() == 1) return;
  std::vector<std::size_t> index;
  for (const std::string& name : read.targets) {
    const auto known = std::find(predictor.targets.begin(), predictor.targets.end(), name);
    if (known == predictor.targets.end())
      throw std::runtime_error("the result has no target " + name +
                               ": give poses of targets that it was made of");
    index.push_back(static_cast<std::size_t>(known - predictor.targets.begin()));
  }
  for (Pose& pose : read.poses) pose.target = index[pose.target];
}

bool same(const Pose& a, const Pose& b) {
  if ((a.sample.position_mm - b.sample.position_mm).cwiseAbs().maxCoeff() > kSame_mm) return false;
  for (std::size_t j = 0; j < a.sample.joints; ++j)
    if (std::abs(a.sample.angles_rad[j] - b.sample.angles_rad[j]) > kSamePose_rad) return false;
  return true;
}

/// A result is not judged by what it was made of.
void refuse_used(const std::vector<Pose>& poses, const std::filesystem::path& folder,
                 const std::vector<JointKind>& kinds) {
  const auto used = read_poses({folder / file_names::kPoses}, "", kinds).poses;
  for (const Pose& pose : poses)
    for (const Pose& one : used)
      if (same(pose, one))
        throw std::runtime_error(pose.name + ": the result was made of this pose (" + one.name +
                                 "): give poses that were kept back");
}

}  // namespace

int validate(const ValidateOptions& options, std::ostream& out) {
  const std::filesystem::path result_json = result_file(options.result);
  const std::filesystem::path folder = result_json.parent_path();
  const Result result = result_in(result_json);
  const PosePredictor& predictor = result.predictor;
  std::vector<JointKind> kinds;
  for (const auto& axis : predictor.fit.model.chain.axes)
    kinds.push_back(axis.linear ? JointKind::linear : JointKind::turning);
  Poses read = read_poses(options.points, options.columns, kinds);
  if (read.poses.empty())
    throw std::runtime_error("no line holds a position and all angles: " +
                             (read.untold.empty() ? "give static poses" : read.untold));
  name_targets(read, predictor);
  refuse_used(read.poses, folder, kinds);
  const auto file = options.output.value_or(folder / file_names::kValidation);
  auto inputs = options.points;
  inputs.push_back(result_json);
  const Outputs outputs(std::move(inputs), options.force);
  outputs.check_made_again(file, R"({
  "schema": "sweepd.validation/)");
  std::vector<std::pair<std::filesystem::path, std::string>> pictures;
  const std::string csv = displacement_csv(displacement_of(predictor, result.limits));
  for (std::size_t across = 0; across < file_names::kSlices.size(); ++across) {
    const auto picture = file.parent_path() / file_names::kSlices.at(across);
    outputs.check_made_again(picture, "<svg");
    pictures.emplace_back(picture, displacement_svg(csv, across));
  }
  const auto table = file.parent_path() / file_names::kDisplacement;
  outputs.check_made_again(table, "slice,x_mm");

  const Validation found = validated(predictor, read.poses);
  write_output(file, validation_json(found).dump(2) + "\n");
  if (!result.doubt.empty()) out << paragraph("", result.doubt) << '\n';
  out << validation_text(found);
  if (predictor.levels.empty()) return 0;
  write_output(table, csv);
  for (const auto& [picture, content] : pictures)
    if (!content.empty()) write_output(picture, content);
  return 0;
}

CLI::App* add_validate(CLI::App& app, ValidateOptions& options) {
  auto* command = app.add_subcommand(
      "validate",
      "Judge a result by static poses that it was not made of\n"
      "It tells how far the poses lie from where the result has them, whether the stated "
      "uncertainties hold, and what each level of correction leaves.");
  command->add_option("RESULT", options.result, "Folder of a result of static poses")
      ->required()
      ->type_name("");
  command->add_option("FILE", options.points, "Files of static poses, as identify reads them")
      ->required()
      ->type_name("");
  add_columns(*command, options.columns);
  command->add_option("--output", options.output, "Write the JSON to this file")
      ->type_name("FILE")
      ->default_str("validation.json in RESULT");
  add_force(*command, options.force);
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
}

}  // namespace sweepd
