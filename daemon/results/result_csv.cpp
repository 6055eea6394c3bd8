#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <spdlog/fmt/fmt.h>

#include "daemon/results/result_formats.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "identify/chain/chain_start.hpp"
#include "identify/dh/dh_comparison.hpp"
#include "identify/dh/dh_extraction.hpp"
#include "identify/geometry/circle_fit.hpp"
#include "identify/geometry/spread.hpp"
#include "identify/identification.hpp"
#include "identify/models/kinematic_model.hpp"

namespace sweepd {
namespace {

using identify::DhNumber;
using identify::Knowledge;

std::string length_text(double mm) {
  return fixed(mm, kLengthDecimals);
}
std::string angle_text(double radians) {
  return fixed(degrees(radians), kAngleDecimals);
}

/// Distances from the fitted circle's plane and from the circle; of a linear joint from the line,
/// along two directions across it.
std::array<double, 2> off_fit(const identify::JointResult& joint, const Eigen::Vector3d& position) {
  if (joint.line) {
    const Eigen::Vector2d off = identify::across(*joint.line, position);
    return {off(0), off(1)};
  }
  const auto residual = identify::residual(*joint.circle, position);
  return {residual.plane_mm, residual.radial_mm};
}

/// The last columns of a line of sweeps.csv. A linear joint has no error in arcsec.
void add_seen(std::string& csv, const std::optional<identify::SeenTurn>& seen, bool linear) {
  if (!seen) {
    csv += ",,,,";
    return;
  }
  for (const double residual : {seen->axial_mm, seen->radial_mm}) {
    csv += ',';
    append_fixed(csv, residual, kLengthDecimals);
  }
  for (const auto& error : {seen->angle_error_rad, seen->curve_rad}) {
    csv += ',';
    if (error && !linear) append_fixed(csv, arcsec(*error), kArcsecDecimals);
  }
}

/// Whether the estimator in `dh` used a sweep: the circles those from the common home, the chain
/// also those that tell from elsewhere.
bool in_use(const identify::Identification& found, const identify::JointResult& joint,
            std::size_t s) {
  return joint.used[s] || (found.estimator != identify::Estimator::circle && found.chain &&
                           tells_from_elsewhere(joint.sweeps[s], found.home_rad,
                                                identify::known_of(found.chain->axes)));
}

}  // namespace

std::string dh_csv(const Outcome& outcome) {
  const auto& found = outcome.identification;
  const auto differences = compare_with_specified(found.dh, found.specified, found.home_rad);
  std::string csv = "joint";
  for (const auto& of : std::span(identify::kDhNumbers).first(4))  // beta stands behind
    csv += fmt::format(",{0}_{1},{0}_sigma_{1},{0}_specified_{1},{0}_difference_{1}", of.name,
                       of.unit());
  csv += ",relation,by_convention,beta_deg,beta_sigma_deg";
  for (const auto& of : identify::kDhNumbers)
    csv += fmt::format(",{0}_low_{1},{0}_high_{1}", of.name, of.unit());
  csv += ",positive,home_deg,variable\n";
  for (std::size_t i = 0; i < found.dh.size(); ++i) {
    const auto& row = found.dh[i];
    const auto* specified = differences.empty() ? nullptr : &found.specified[i];
    std::string by_convention;
    csv += std::to_string(i + 1);
    const auto add = [&](const char* name, const DhNumber& number, double expected,
                         const std::optional<double>& difference, auto unit) {
      csv += ',';
      if (number.knowledge != Knowledge::undetermined) csv += unit(number.value);
      csv += ',';
      if (number.has_sigma()) csv += unit(number.sigma);
      csv += ',';
      if (specified != nullptr) csv += unit(expected);
      csv += ',';
      if (difference) csv += unit(*difference);
      if (number.knowledge == Knowledge::by_convention)
        by_convention += (by_convention.empty() ? "" : " ") + std::string(name);
    };
    const identify::DhRow expected = specified != nullptr ? *specified : identify::DhRow{};
    const identify::DhDifference difference =
        specified != nullptr ? differences[i] : identify::DhDifference{};
    add("b_mm", row.b_mm, expected.b_mm, difference.b_mm, length_text);
    add("theta_deg", row.theta_rad, expected.theta_rad, difference.theta_rad, angle_text);
    add("a_mm", row.a_mm, expected.a_mm, difference.a_mm, length_text);
    add("alpha_deg", row.alpha_rad, expected.alpha_rad, difference.alpha_rad, angle_text);
    if (has_beta(row) && row.beta_rad.knowledge == Knowledge::by_convention)
      by_convention += " beta_deg";
    csv += "," + std::string(identify::text(row.relation)) + "," + by_convention + ",";
    if (has_beta(row)) csv += angle_text(row.beta_rad.value);
    csv += ",";
    const bool beta_uncertain = has_beta(row) && row.beta_rad.has_sigma();
    if (beta_uncertain) csv += angle_text(row.beta_rad.sigma);
    const auto interval = [&](const DhNumber& number, auto unit) {
      const double half = identify::kSigmasOf95Percent * number.sigma;
      csv += number.has_sigma() ? "," + unit(number.value - half) + "," + unit(number.value + half)
                                : ",,";
    };
    interval(row.b_mm, length_text);
    interval(row.theta_rad, angle_text);
    interval(row.a_mm, length_text);
    interval(row.alpha_rad, angle_text);
    interval(beta_uncertain ? row.beta_rad : DhNumber{}, angle_text);
    csv += "," + std::to_string(i < outcome.positive.size() ? outcome.positive[i] : 1) + ",";
    if (i < found.home_rad.size() && found.home_rad[i]) csv += angle_text(*found.home_rad[i]);
    csv += row.linear ? ",b_mm\n" : ",theta_deg\n";
  }
  return csv;
}

std::string sweeps_csv(const Outcome& outcome) {
  const auto& joints = outcome.identification.joints;
  std::size_t angles = 0;
  for (const auto& joint : joints)
    for (const auto& sweep : joint.sweeps)
      angles = std::max<std::size_t>(angles, sweep.first().joints);

  const bool timed = is_timed(outcome);
  std::string csv = timed ? "joint,sweep,t_s,x_mm,y_mm,z_mm" : "joint,sweep,x_mm,y_mm,z_mm";
  for (std::size_t k = 0; k < angles; ++k) csv += ",a" + std::to_string(k + 1) + "_deg";
  csv +=
      ",plane_residual_mm,radial_residual_mm,chain_axial_residual_mm,chain_radial_residual_mm"
      ",angle_error_arcsec,curve_error_arcsec,target\n";
  constexpr std::size_t kUsualNumber = 11;
  std::size_t samples = 0;
  for (const auto& joint : joints)
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      if (in_use(outcome.identification, joint, s)) samples += joint.sweeps[s].samples->size();
  csv.reserve(samples * (angles + 12) * kUsualNumber);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!joints[j].circle && !joints[j].line) continue;
    for (std::size_t s = 0; s < joints[j].sweeps.size(); ++s) {
      if (!in_use(outcome.identification, joints[j], s)) continue;
      const std::string end = "," + std::to_string(joints[j].sweeps[s].target + 1) + "\n";
      const std::string start = std::to_string(j + 1) + "," + std::to_string(s + 1);
      const auto add = [&](double value) {
        csv += ',';
        append_fixed(csv, value, kLengthDecimals);
      };
      for (const auto& sample : *joints[j].sweeps[s].samples) {
        if (!sample.has_position) continue;
        csv += start;
        if (timed) append_fixed(csv += ',', sample.time_s, 3);
        for (const double value : sample.position_mm) {
          csv += ',';
          append_measured(csv, value, kLengthDecimals);
        }
        for (std::size_t k = 0; k < angles; ++k) {
          csv += ',';
          if (k < sample.joints)
            append_measured(csv, degrees(sample.angles_rad[k]), kLengthDecimals);
        }
        if (joints[j].used[s]) {
          for (const double residual : off_fit(joints[j], sample.position_mm)) add(residual);
        } else {
          csv += ",,";
        }
        add_seen(csv,
                 identify::seen_turn(outcome.identification, j, joints[j].sweeps[s].target, sample),
                 joints[j].linear);
        csv += end;
      }
    }
  }
  return csv;
}

std::string poses_csv(const Outcome& outcome) {
  const identify::PoseEstimate& found = *outcome.identification.poses;
  const std::size_t joints = outcome.identification.joints.size();
  std::string csv = "pose,target,x_mm,y_mm,z_mm";
  for (std::size_t j = 1; j <= joints; ++j) csv += ",a" + std::to_string(j) + "_deg";
  csv += ",x_residual_mm,y_residual_mm,z_residual_mm,sigma_residual\n";
  for (std::size_t i = 0; i < found.poses.size(); ++i) {
    const identify::Pose& pose = found.poses[i];
    csv += std::to_string(i + 1) + "," + std::to_string(pose.target + 1);
    for (const double value : pose.sample.position_mm)
      append_measured(csv += ',', value, kLengthDecimals);
    for (std::size_t j = 0; j < joints; ++j)
      append_measured(csv += ',', degrees(pose.sample.angles_rad[j]), kLengthDecimals);
    for (const double off : found.fit.rows[i].off.head<3>()) append_fixed(csv += ',', off, 6);
    append_fixed(csv += ',', found.fit.sigmas_off(i), 3);
    csv += '\n';
  }
  return csv;
}

}  // namespace sweepd
