#include "daemon/result_csv.hpp"

#include <optional>

#include "daemon/numbers.hpp"
#include "daemon/units.hpp"
#include "identify/circle_fit.hpp"
#include "identify/dh_comparison.hpp"

namespace sweepd {
namespace {

using identify::DhNumber;
using identify::Knowledge;

std::string length(double mm) {
  return fixed(mm, kLengthDecimals);
}
std::string angle(double radians) {
  return fixed(degrees(radians), kAngleDecimals);
}

}  // namespace

std::string dh_csv(const Outcome& outcome) {
  const auto& found = outcome.identification;
  const auto differences = compare_with_specified(found);
  std::string csv = "joint";
  for (const std::string name : {"b_mm", "theta_deg", "a_mm", "alpha_deg"}) {
    const auto unit = name.find('_');
    const std::string base = name.substr(0, unit);
    const std::string suffix = name.substr(unit);
    csv += "," + name + "," + base + "_sigma" + suffix + "," + base + "_specified" + suffix + "," +
           base + "_difference" + suffix;
  }
  csv += ",relation,by_convention\n";
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
      if (number.knowledge == Knowledge::identified) csv += unit(number.sigma);
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
    add("b_mm", row.b_mm, expected.b_mm, difference.b_mm, length);
    add("theta_deg", row.theta_rad, expected.theta_rad, difference.theta_rad, angle);
    add("a_mm", row.a_mm, expected.a_mm, difference.a_mm, length);
    add("alpha_deg", row.alpha_rad, expected.alpha_rad, difference.alpha_rad, angle);
    csv += "," + std::string(identify::text(row.relation)) + "," + by_convention + "\n";
  }
  return csv;
}

std::string sweeps_csv(const Outcome& outcome) {
  const auto& joints = outcome.identification.joints;
  std::size_t angles = 0;
  for (const auto& joint : joints)
    for (const auto& sweep : joint.sweeps)
      angles = std::max<std::size_t>(angles, sweep.first().joints);

  std::string csv = "joint,sweep,t_s,x_mm,y_mm,z_mm";
  for (std::size_t k = 0; k < angles; ++k) csv += ",a" + std::to_string(k + 1) + "_deg";
  csv += ",plane_residual_mm,radial_residual_mm\n";
  constexpr std::size_t kUsualNumber = 11;
  std::size_t samples = 0;
  for (const auto& joint : joints)
    for (std::size_t s = 0; s < joint.sweeps.size(); ++s)
      if (joint.used[s]) samples += joint.sweeps[s].samples->size();
  csv.reserve(samples * (angles + 8) * kUsualNumber);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!joints[j].circle) continue;
    for (std::size_t s = 0; s < joints[j].sweeps.size(); ++s) {
      if (!joints[j].used[s]) continue;
      const std::string start = std::to_string(j + 1) + "," + std::to_string(s + 1) + ",";
      const auto add = [&](double value) {
        csv += ',';
        append_fixed(csv, value, kLengthDecimals);
      };
      for (const auto& sample : *joints[j].sweeps[s].samples) {
        if (!sample.has_position) continue;
        const auto residual = identify::residual(*joints[j].circle, sample.position_mm);
        csv += start;
        append_fixed(csv, sample.time_s, 3);
        for (const double value : sample.position_mm) add(value);
        for (std::size_t k = 0; k < angles; ++k)
          if (k < sample.joints)
            add(degrees(sample.angles_rad[k]));
          else
            csv += ',';
        add(residual.plane_mm);
        add(residual.radial_mm);
        csv += '\n';
      }
    }
  }
  return csv;
}

}  // namespace sweepd
