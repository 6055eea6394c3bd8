#include "daemon/results/told_arm.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/report/file_parts.hpp"
#include "daemon/report/report_folder.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/units.hpp"
#include "identify/dh/dh.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "rsi/ascii.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

using Eigen::Index;
using identify::DhNumberName;
using identify::kDhNumbers;
using Json = nlohmann::ordered_json;

/// Of fewer axes nothing but one row would be compared.
constexpr std::size_t kFewestAxes = 3;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
  throw std::runtime_error(file.string() + ' ' + why);
}

double unit(const DhNumberName& of) {
  return of.length ? 1 : radians(1);
}

identify::Relation relation_of(const std::string& name) {
  using identify::Relation;
  for (const auto relation :
       {Relation::skew, Relation::parallel, Relation::intersecting, Relation::coincident})
    if (identify::text(relation) == name) return relation;
  return Relation::last;
}

/// A table that was edited by hand, or damaged, would be compared all the same.
void check_numbers(const Json& rows, const std::filesystem::path& file) {
  constexpr double kMost = 1e7;  // mm or deg
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (const auto& of : kDhNumbers) {
      const std::string name = fmt::format("{}_{}", of.name, of.unit());
      const auto value = rows[k].is_object() ? rows[k].find(name) : rows[k].end();
      if (value == rows[k].end() || value->is_null()) continue;
      if (!value->is_number() || !(std::abs(value->get<double>()) < kMost))
        refuse(file,
               fmt::format("has {} for {} of row {}, which sweepd does not write: make it again "
                           "with replay or identify",
                           rsi::in_short(value->dump()), name, k + 1));
    }
}

/// No variance is negative or larger than lengths are, and none is too small for what is common to
/// two numbers.
void check_covariance(const Eigen::MatrixXd& covariance, const std::filesystem::path& file) {
  constexpr double kMost = 1e14;  // mm^2
  constexpr double kRounding = 1e-3;
  const Eigen::ArrayXd variances = covariance.diagonal();
  const Eigen::ArrayXXd most = (variances.matrix() * variances.matrix().transpose()).array().sqrt();
  if ((variances >= 0).all() && (variances < kMost).all() &&
      (covariance.array().abs() <= (1 + kRounding) * most).all())
    return;
  refuse(file,
         "has a covariance that no numbers can have, which sweepd does not write: make it "
         "again with replay or identify");
}

/// Knowledge follows from the covariance.
std::vector<identify::DhEstimate> table_of(const Json& rows) {
  std::vector<identify::DhEstimate> table;
  for (const Json& json : rows) {
    identify::DhEstimate row;
    for (const auto& of : kDhNumbers) {
      const double value = number_of(json, fmt::format("{}_{}", of.name, of.unit()));
      if (std::isfinite(value)) (row.*of.number).value = unit(of) * value;
    }
    row.relation = relation_of(text_of(json, "relation"));
    row.linear = text_of(json, "variable") == "b_mm";
    table.push_back(row);
  }
  return table;
}

/// Axes before the first that is open: a row is known where both its axes are.
std::size_t axes_before_open(const Json& rows) {
  std::size_t axes = 1;
  while (axes < rows.size() && text_of(rows[axes - 1], "relation") != "unknown") ++axes;
  return axes;
}

/// With what writing takes away of the numbers themselves.
Eigen::MatrixXd covariance_of(const Json& json, std::size_t joints) {
  struct Place {
    Index row;
    double unit;
  };
  std::map<std::string, Place> places;
  for (std::size_t j = 0; j < joints; ++j)
    for (std::size_t k = 0; k < kDhNumbers.size(); ++k)
      places[fmt::format("{}{}_{}", kDhNumbers[k].name, j + 1, kDhNumbers[k].unit())] = {
          static_cast<Index>(kDhNumbers.size() * j + k), unit(kDhNumbers[k])};
  std::vector<Place> order;
  for (const Json& name : list_of(json, "names")) {
    const auto place = name.is_string() ? places.find(name.get<std::string>()) : places.end();
    if (place == places.end()) return {};
    order.push_back(place->second);
  }
  const Json& rows = list_of(json, "rows");
  if (order.empty() || rows.size() != order.size()) return {};
  const auto count = static_cast<Index>(5 * joints);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t r = 0; r < order.size(); ++r) {
    if (!rows[r].is_array() || rows[r].size() != order.size()) return {};
    for (std::size_t c = 0; c < order.size(); ++c) {
      if (!rows[r][c].is_number()) return {};
      covariance(order[r].row, order[c].row) =
          rows[r][c].get<double>() * order[r].unit * order[c].unit;
    }
    const Index at = order[r].row;
    const bool length = at % 5 == 0 || at % 5 == 2;
    const double step = std::pow(10.0, length ? -kLengthDecimals : -kAngleDecimals);
    covariance(at, at) += std::pow(step * order[r].unit, 2) / 12;
  }
  return covariance;
}

/// The middle of the square of how far a joint turned from home, in rad: no less than if home is in
/// the middle of its longest sweep.
double mean_square_turn(const Json& joint) {
  double range = 0;
  for (const Json& sweep : list_of(joint, "sweeps"))
    for (const char* name : {"range_deg", "range_mm"})
      if (const double told = number_of(sweep, name); flag_of(sweep, "used") && told > range)
        range = told;
  return std::pow(radians(range), 2) / 12;
}

/// By how much the joint's angles are off along a smooth curve, told minus seen, but for what noise
/// makes of the curve's six numbers; by how far it turned. Where positions and angles have one
/// source, the covariance holds all that they are off by.
std::optional<double> gear_of(const Json& angles, const Json& joint,
                              double samples_per_independent) {
  if (text_of(angles, "trust") == "trusted") return 0;
  const double samples = number_of(angles, "samples");
  const double turned = mean_square_turn(joint);
  if (!(samples > 0) || !(turned > 0)) return std::nullopt;
  const auto square = [&](const std::string& name) {
    const double linear = number_of(angles, name + "_mm");
    const double value = std::isfinite(linear)
                             ? linear / identify::kLinear_mm
                             : identify::kArcsec * number_of(angles, name + "_arcsec");
    return std::isfinite(value) ? value * value : 0;
  };
  const double chance = 6 * samples_per_independent / samples * square("expected_rms");
  return std::sqrt(std::max(0.0, square("error_rms") - square("remainder_rms") - chance) / turned);
}

/// The tool in the frame of the last axis.
Eigen::Vector3d tool_of(const Json& result) {
  Eigen::Vector3d point = vector_of(part_of(part_of(result, "tool"), "point_mm"));
  if (!point.allFinite()) return Eigen::Vector3d::Zero();
  const auto specified = table_of(list_of(result, "specified"));
  if (specified.empty()) return point;
  return transform(values(specified).back()) * point;
}

std::optional<identify::TurnRange> limits_of(const Json& limits, double home_deg) {
  if (!limits.is_array() || limits.size() != 2 || !limits[0].is_number() ||
      !limits[1].is_number() || !std::isfinite(home_deg))
    return std::nullopt;
  return identify::TurnRange{radians(limits[0].get<double>() - home_deg),
                             radians(limits[1].get<double>() - home_deg)};
}

/// Who tells it, and the rows of the table.
ToldArm table_told_in(const Json& json, const std::filesystem::path& file) {
  ToldArm told;
  told.file = file;
  told.robot = text_of(json, "robot");
  told.status = text_of(json, "status");
  told.reason = text_of(json, "reason");
  told.describes = text_of(json, "describes");
  if (told.status == "failed")
    refuse(told.file, "is a failed result, there is nothing to compare: " + told.reason);
  check_numbers(list_of(json, "dh"), told.file);
  told.arm.dh = table_of(list_of(json, "dh"));
  const std::size_t joints = told.joints();
  if (joints < 2 || joints > identify::kMostJoints)
    refuse(told.file, "has a table of " + std::to_string(joints) +
                          " joints: at least two are needed, and at most " +
                          std::to_string(identify::kMostJoints));
  told.all_joints = joints;
  return told;
}

/// The joints of the model by Denavit and Hartenberg; older results have their senses there.
const Json& dh_models_in(const Json& json) {
  return list_of(part_of(part_of(json, "models"), "dh"), "joints");
}

/// Refuses what leaves too much open to be compared. How many axes there are before the first that
/// is open.
std::size_t known_axes(const Json& json, const ToldArm& told) {
  const Json& table = list_of(json, "dh");
  const std::size_t joints = told.joints();
  const std::size_t known = axes_before_open(table);
  if (known < std::min(kFewestAxes, joints))
    refuse(told.file, "does not know enough of the table" +
                          (told.reason.empty() ? "" : " (" + told.reason + ')') +
                          ": identify it again with sweeps of every joint");
  if (dh_models_in(json).size() != joints && !table[0].contains("positive") &&
      !list_of(json, "specified").empty())
    refuse(told.file,
           "was written by an earlier sweepd and leaves axes open, without the senses of the "
           "others: make it again with replay or identify");
  return known;
}

void take_covariance(const Json& json, ToldArm& told) {
  told.arm.covariance = covariance_of(part_of(json, "covariance"), told.joints());
  if (told.arm.covariance.size() == 0)
    refuse(told.file,
           "has no covariance of its numbers: without it nobody can tell a change from noise. "
           "Make the result again with replay or identify, from samples and not from axes");
  check_covariance(told.arm.covariance, told.file);
}

/// Senses, home, gears and ranges; home is no better known than it is printed.
void take_joints(const Json& json, ToldArm& told) {
  const Json& table = list_of(json, "dh");
  const Json& models = dh_models_in(json);
  const Json& home = list_of(json, "home_deg");
  const Json& limits = list_of(json, "limits_deg");
  const Json& joint_list = list_of(json, "joints");
  const Json& chain = part_of(part_of(json, "estimates"), "chain");
  const Json& angles = list_of(chain, "angles");
  const double correlated = std::max(1.0, number_of(chain, "samples_per_independent"));
  const double step_deg = number_of(json, "angle_step_deg");
  told.with_limits = true;
  for (std::size_t j = 0; j < told.joints(); ++j) {
    told.reach.linear.push_back(told.arm.dh[j].linear);
    const Json& sense = table[j].contains("positive") || j >= models.size() ? table[j] : models[j];
    told.arm.positive.push_back(number_of(sense, "positive") < 0 ? -1 : 1);
    const double home_deg =
        j < home.size() && home[j].is_number() ? home[j].get<double>() : std::nan("");
    told.arm.home_rad.push_back(std::isfinite(home_deg) ? std::optional(radians(home_deg))
                                                        : std::nullopt);
    const Json evidence = j < angles.size() ? angles[j] : Json();
    told.arm.gear.push_back(
        gear_of(evidence, j < joint_list.size() ? joint_list[j] : Json(), correlated));
    const Index variable = static_cast<Index>(5 * j) + (told.arm.dh[j].linear ? 0 : 1);
    double& variance = told.arm.covariance(variable, variable);
    if (text_of(evidence, "trust") != "trusted" && variance > 0 && step_deg > 0)
      variance += std::pow(step_deg * (told.arm.dh[j].linear ? 1 : radians(1)), 2) / 12;
    const auto range = limits_of(j < limits.size() ? limits[j] : Json(), home_deg);
    told.with_limits = told.with_limits && range;
    told.reach.ranges.push_back(
        range.value_or(identify::TurnRange{-radians(kUsualTurn_deg), radians(kUsualTurn_deg)}));
  }
}

}  // namespace

std::string told_status(const std::string& who, const std::string& status,
                        const std::string& reason) {
  if (status == "complete") return {};
  std::string text = who + " is " + status + (reason.empty() ? "" : ": " + reason);
  if (text.back() != '?') text += '.';
  return text;
}

std::filesystem::path result_file(const std::filesystem::path& path) {
  return std::filesystem::is_directory(path) ? path / file_names::kResult : path;
}

Json parse_result(const std::filesystem::path& file, std::string_view text) {
  Json json = Json::parse(text, nullptr, false);
  require_result(json, file);
  return json;
}

Json read_result(const std::filesystem::path& file) {
  return parse_result(file, rsi::file_bytes(file));
}

ToldArm read_told_arm(const std::filesystem::path& path) {
  const auto file = result_file(path);
  return told_arm_in(read_result(file), file);
}

ToldArm told_arm(std::string_view bytes, const std::filesystem::path& file) {
  return told_arm_in(parse_result(file, bytes), file);
}

ToldArm told_arm_in(const Json& json, const std::filesystem::path& file) {
  ToldArm told = table_told_in(json, file);
  const std::size_t known = known_axes(json, told);
  take_covariance(json, told);
  const Json& warnings = list_of(json, "warnings");
  told.arm.height_known = std::none_of(warnings.begin(), warnings.end(), [](const Json& warning) {
    return text_of(warning, "code") == "height_unknown" && number_of(warning, "joint") == 1;
  });
  told.arm.specified = values(table_of(list_of(json, "specified")));
  take_joints(json, told);
  told.reach.tool_mm = tool_of(json);
  told.cut(known);
  return told;
}

void ToldArm::cut(std::size_t joints) {
  if (joints >= arm.dh.size()) return;
  const auto numbers = static_cast<Index>(kDhNumbers.size() * joints);
  arm.dh.resize(joints);
  arm.covariance = Eigen::MatrixXd(arm.covariance.topLeftCorner(numbers, numbers));
  arm.positive.resize(joints);
  arm.home_rad.resize(joints);
  arm.gear.resize(joints);
  reach.linear.resize(joints);
  reach.ranges.resize(joints);
  reach.tool_mm.setZero();
}

}  // namespace sweepd
