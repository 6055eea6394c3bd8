#include "daemon/commands/identify_command.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/joined_points.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/devices/device_formats.hpp"
#include "daemon/points/angle_sweeps.hpp"
#include "daemon/points/axes_file.hpp"
#include "daemon/points/csv_file.hpp"
#include "daemon/points/declared_directions.hpp"
#include "daemon/points/missing_angles.hpp"
#include "daemon/points/point_poses.hpp"
#include "daemon/points/point_sweeps.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/points/wrapped_angles.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/results/report.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/results/run_json.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/system/process_state.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/progress.hpp"
#include "identify/given_axes.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::Sweep;

void check(const IdentifyOptions& options) {
  if (options.points.empty() && !options.axes)
    throw std::invalid_argument("FILE is required: name files of measured points, or --axes");
  if (!options.points.empty() && options.axes)
    throw std::invalid_argument("--axes takes the place of measured points: leave out one of them");
  if (options.axes && !options.format.empty())
    throw std::invalid_argument("--format is for files of points: leave it out with --axes");
  if (options.axes && options.per_joint)
    throw std::invalid_argument("--per-joint is for files of points: leave it out with --axes");
  if (options.axes && options.poses)
    throw std::invalid_argument("--poses is for files of points: leave it out with --axes");
  if (options.poses && options.per_joint)
    throw std::invalid_argument("--poses and --per-joint exclude each other: leave one out");
  if (!options.angles.empty() && (options.axes || options.per_joint || options.poses))
    throw std::invalid_argument(
        "--angles is for a device's points over time: leave out --axes, --per-joint and --poses");
}

/// How many joints robot, plan or options say the arm has.
std::optional<std::size_t> declared_joints(const IdentifyOptions& options,
                                           const RobotSetup& setup) {
  if (!options.robot && !options.plan) return options.joints;
  if (options.joints && *options.joints != setup.joints)
    throw std::invalid_argument(
        fmt::format("--joints {}: {} has {}: leave --joints out", *options.joints,
                    (options.robot ? *options.robot : *options.plan).string(),
                    rsi::counted(setup.joints, "joint")));
  return setup.joints;
}

bool of_poses(const PointsFile& file, const IdentifyOptions& options) {
  return !options.per_joint && (options.poses || holds_poses(file));
}

struct GivenPoints {
  std::vector<PointsFile> files;
  identify::Resolution resolution;
  PointCounts counts;
};

GivenPoints read_points(const IdentifyOptions& options, const RobotSetup& setup,
                        std::size_t most_joints) {
  Progress progress("identify", options.quiet ? Progress::Terminal{} : Progress::standard_error());
  double all = 0;
  for (const auto& path : options.points) {
    std::error_code ignored;  // reading says it better
    if (const auto size = std::filesystem::file_size(path, ignored); !ignored)
      all += static_cast<double>(size);
  }
  PointsReader reader(column_names(options.columns), most_joints, options.format,
                      joint_kinds(setup));
  GivenPoints points;
  double before = 0;
  for (const auto& path : options.points) {
    double read = 0;
    points.files.push_back(reader.read(path, [&](std::size_t bytes) {
      read = static_cast<double>(bytes);
      progress.update(before + read, all, path.filename().string());
    }));
    before += read;
    points.counts.points += points.files.back().points.size();
  }
  points.resolution = reader.resolution();
  points.counts.files = points.files.size();
  points.counts.targets = reader.targets();
  return points;
}

/// As many joints as the points speak of; six, as RSI has, where they do not.
std::size_t joints_in(const IdentifyOptions& options, const GivenPoints& points) {
  std::size_t joints = options.per_joint ? points.files.size() : 0;
  for (const auto& file : points.files) {
    joints = std::max(joints, file.angles);
    for (const auto& point : file.points) joints = std::max(joints, point.joint);
  }
  return joints > 0 ? joints : 6;
}

void check_file(const PointsFile& file, const IdentifyOptions& options, std::size_t joints) {
  const std::string name = file.path.string();
  if (file.angles > 0 && file.angles < joints)
    throw CsvError(fmt::format(
        "{}: expected angles of {}, found those of {}: add the others, or skip all with --columns",
        name, rsi::counted(joints, "joint"), file.angles));
  if (options.per_joint && file.with_joints)
    throw CsvError(name +
                   ": expected no column joint, as --per-joint tells the joint, found one: "
                   "leave out --per-joint, or skip the column with --columns");
  const bool is_told =
      options.per_joint || file.with_joints || file.with_times || of_poses(file, options);
  if (!is_told && !file.format.empty())
    throw CsvError(name +
                   ": expected times of a stream, or groups that are named as joints (Joint 1), "
                   "found neither: name the groups, or give one file a joint with --per-joint");
  if (!is_told)
    throw CsvError(name +
                   ": expected a column t_s or joint, or joint angles of static poses, found none "
                   "of them: add one, or give one file a joint with --per-joint");
}

/// Whose joint each sweep is; without angles or a column for it, some may be left for the engine.
/// What noise hides in streams without angles is told to `campaign`.
std::vector<Sweep> sweeps_in(const GivenPoints& points, const IdentifyOptions& options,
                             const RobotSetup& setup, identify::Campaign& campaign) {
  std::vector<Sweep> sweeps;
  for (std::size_t k = 0; k < points.files.size(); ++k) {
    const PointsFile& file = points.files[k];
    if (of_poses(file, options)) continue;
    check_file(file, options, setup.joints);
    auto found =
        options.per_joint
            ? sweeps_of_joint(file, k, setup.joints, points.resolution, campaign.motion_limit)
            : (file.with_joints
                   ? listed_sweeps(file, points.resolution)
                   : streamed_sweeps(file, setup.joints, points.resolution, campaign.motion_limit));
    std::move(found.begin(), found.end(), std::back_inserter(sweeps));
  }
  if (setup.plan) declare_directions(sweeps, *setup.plan, campaign.order);
  return sweeps;
}

/// Which devices' files were read, a line for each kind, and what was assumed or left out.
void tell_formats(const std::vector<PointsFile>& files, std::ostream& out) {
  std::vector<std::string> told;
  for (const auto& file : files) {
    if (file.format.empty()) continue;
    std::string line = "points: " + file.format;
    for (const auto& note : file.notes) line += "; " + note;
    if (std::find(told.begin(), told.end(), line) == told.end()) told.push_back(line);
  }
  for (const auto& line : told) out << line << '\n';
}

/// Angles that jump by a turn go on.
void tell_turns(std::vector<PointsFile>& files, std::ostream& out) {
  std::string names;
  for (const std::size_t joint : take_out_turns(files))
    names += fmt::format("{}A{}", names.empty() ? "" : ", ", joint + 1);
  if (!names.empty())
    out << "points: the angles of " << names
        << " jump by 360 degrees, which is taken for no motion\n";
}

/// Poses without a table to start from may be sweeps of single joints.
void find_sweeps(GivenPoints& points, const IdentifyOptions& options, std::ostream& out) {
  if (options.poses || options.per_joint) return;
  for (PointsFile& file : points.files) {
    if (!holds_poses(file) || file.with_poses) continue;
    const auto all = file.points.size();
    if (!find_sweeps_by_angles(file, points.resolution.angle_rad)) continue;
    out << fmt::format("points: {}: the angles tell sweeps of single joints, with {} of {}\n",
                       file.path.string(), file.points.size(), rsi::counted(all, "point"));
  }
}

/// By file, in run.json: those of devices alone.
nlohmann::ordered_json formats_of(const std::vector<PointsFile>& files) {
  auto formats = nlohmann::ordered_json::object();
  for (const auto& file : files)
    if (!file.format.empty()) formats[file.path.string()] = file.format;
  return formats;
}

Outcome identified_points(const IdentifyOptions& options, RobotSetup setup, std::ostream& out,
                          nlohmann::ordered_json& formats) {
  const auto declared = declared_joints(options, setup);
  GivenPoints points = read_points(options, setup, declared.value_or(identify::kMostJoints));
  std::ostringstream unheard;
  std::ostream& told = options.quiet ? unheard : out;
  tell_formats(points.files, told);
  formats = formats_of(points.files);
  if (declared) setup.joints = *declared;
  if (!options.angles.empty())
    return joined_with_trace(points.files, points.resolution, points.counts.targets, options.angles,
                             setup, options.quiet);
  setup.joints = declared ? *declared : joints_in(options, points);
  tell_turns(points.files, told);
  std::vector<identify::Warning> untold;
  for (const PointsFile& file : points.files)
    if (const auto missing = missing_angles(file)) untold.push_back(*missing);
  for (const auto& missing : untold) told << "points: " << missing.message << '\n';
  if (options.per_joint && points.files.size() > setup.joints)
    throw std::invalid_argument("--per-joint: " + rsi::counted(points.files.size(), "file") +
                                " for " + rsi::counted(setup.joints, "joint") +
                                ": give one file a joint");
  auto known = campaign(setup, points.resolution);
  if (!known.specified) find_sweeps(points, options, told);
  known.device_frame = options.device_frame;
  known.timed = std::all_of(points.files.begin(), points.files.end(), [&](const PointsFile& file) {
    return file.with_times || of_poses(file, options);
  });
  points.counts.timed = known.timed;
  Snapshot snapshot;
  snapshot.robot = setup.name;
  snapshot.source_kind = "points";
  for (const PointsFile& file : points.files) {
    if (!of_poses(file, options)) continue;
    auto poses = static_poses(file, setup.joints);
    if (poses.empty()) {
      const auto missing = missing_angles(file);
      throw CsvError(file.path.string() + ": no line holds a position and all angles: " +
                     (missing ? missing->message : "fill in where the target was seen"));
    }
    std::move(poses.begin(), poses.end(), std::back_inserter(snapshot.poses));
  }
  points.counts.poses = snapshot.poses.size();
  snapshot.sweeps = sweeps_in(points, options, setup, known);
  snapshot.campaign = known;
  snapshot.limits = setup.limits();
  const auto arcs = static_cast<std::size_t>(std::count_if(
      snapshot.sweeps.begin(), snapshot.sweeps.end(),
      [](const Sweep& sweep) { return sweep.defect == identify::SweepDefect::none; }));
  points.files.clear();
  Outcome outcome = outcome_of(snapshot);
  auto& warnings = outcome.identification.warnings;
  warnings.insert(warnings.begin(), untold.begin(), untold.end());
  // Strokes of a linear joint are no arcs, and can be used all the same.
  std::size_t used = 0;
  for (const auto& joint : outcome.identification.joints) used += joint.sweeps.size();
  points.counts.sweeps = std::max(arcs, used);
  outcome.points = points.counts;
  return outcome;
}

Outcome identified_axes(const IdentifyOptions& options, RobotSetup setup) {
  const auto declared = declared_joints(options, setup);
  const auto axes = read_axes(*options.axes, column_names(options.columns),
                              declared.value_or(identify::kMostJoints));
  setup.joints = declared.value_or(axes.size());
  if (axes.size() != setup.joints)
    throw CsvError(fmt::format("{}: expected the axes of {}, found those of {}: add the others",
                               options.axes->string(), rsi::counted(setup.joints, "joint"),
                               axes.size()));
  const auto limits = setup.limits();
  for (std::size_t j = 0; j < limits.size(); ++j)
    if (limits[j].linear)
      throw std::invalid_argument(
          fmt::format("--axes: joint {} is linear: its axis has a direction and no place, which "
                      "lines cannot say: give measured points",
                      j + 1));
  auto known = campaign(setup, {});
  known.device_frame = options.device_frame;
  Outcome outcome;
  outcome.robot = setup.name;
  outcome.source_kind = "axes";
  outcome.identification = identify::identify_given_axes(axes, known);
  if (known.specified) outcome.positive = known.specified->positive;
  outcome.limits = setup.limits();
  return outcome;
}

std::vector<std::filesystem::path> inputs_of(const IdentifyOptions& options) {
  auto inputs = options.points;
  inputs.insert(inputs.end(), options.angles.begin(), options.angles.end());
  for (const auto& file : {options.axes, options.robot, options.plan})
    if (file) inputs.push_back(*file);
  return inputs;
}

void check_output(const IdentifyOptions& options) {
  auto names = result_file_names();
  names.emplace_back(file_names::kRun);
  Outputs(inputs_of(options), options.force).check_results(*options.output, names);
}

void write_run_file(const IdentifyOptions& options, const nlohmann::ordered_json& formats) {
  auto given = nlohmann::ordered_json::object();
  for (const auto& file : options.points) given["points"].push_back(file.string());
  for (const auto& trace : options.angles) given["angles"].push_back(trace.string());
  if (options.axes) given["axes"] = options.axes->string();
  if (!formats.empty()) given["formats"] = formats;
  if (!options.columns.empty()) given["columns"] = options.columns;
  if (options.per_joint) given["per_joint"] = true;
  if (options.poses) given["poses"] = true;
  given["frame"] = options.device_frame ? "device" : "robot";
  if (options.robot) given["description"] = options.robot->string();
  if (options.plan) given["plan"] = options.plan->string();
  write_atomically(*options.output / file_names::kRun,
                   run_json("identify", given, options.arguments, hashes_of(inputs_of(options))));
}

}  // namespace

int identify_points(const IdentifyOptions& options, std::ostream& out, std::ostream& errors) {
  if (options.list_formats) {
    out << format_list();
    return 0;
  }
  check(options);
  if (options.output) check_output(options);
  keep_memory();
  const RobotSetup setup = load_setup(options.robot, options.plan);
  auto formats = nlohmann::ordered_json::object();
  const Outcome outcome = options.axes ? identified_axes(options, setup)
                                       : identified_points(options, setup, out, formats);
  if (options.output) {
    make_folder(*options.output);
    write_run_file(options, formats);
    write_result(*options.output, outcome);
  }
  if (!options.quiet) out << report(outcome);
  return exit_code(outcome, errors);
}

}  // namespace sweepd
