#include "identify/linear_advice.hpp"

#include <algorithm>
#include <cmath>

#include "identify/advice.hpp"
#include "identify/geometry/number_text.hpp"

namespace identify {
namespace {

constexpr double kLinearSigmas = 4;

std::string way(double turn_rad) {
  return brief(kLinear_mm * turn_rad) + " mm";
}

}  // namespace

std::vector<Warning> advice_of_linear(const Identification& found, std::size_t j,
                                      const Resolution& resolution, double by_delay_rad) {
  std::vector<Warning> advice;
  const auto warn = [&](const char* code, const std::string& text) {
    advice.push_back({code, j, joint_name(j) + ": " + text});
  };
  const JointResult& joint = found.joints[j];
  const double sigma = joint.axis ? joint.axis->direction_sigma_rad() : 0;
  if (!joint.axis || sigma > kPoorDirection_rad) {
    std::string remedy = "move it further";
    // Of as many samples a line's direction is known as the inverse of its length.
    if (joint.axis)
      remedy += ", " + fixed(joint.line->length_mm * sigma / kPoorDirection_rad, 0) +
                " mm would give about " + brief(kPoorDirection_rad / kDegree) + "°";
    warn("stroke_short",
         "its strokes determine its direction poorly (length " + fixed(joint.line->length_mm, 1) +
             " mm, direction uncertain by " +
             (joint.axis ? brief(sigma / kDegree) + "°" : std::string("more than 1°")) +
             "): " + remedy);
  }
  if (!found.chain || found.chain->angles[j].samples == 0) return advice;
  const AngleEvidence& seen = found.chain->angles[j];
  // Neighbours in time share their error, and so do the strokes' means.
  const double correlated = std::sqrt(found.chain->samples_per_independent);
  const double backlash = std::abs(seen.backlash_rad);
  if (seen.backlash_sigma_rad > 0 && backlash > resolution.angle_rad &&
      backlash > kLinearSigmas * std::hypot(correlated * seen.backlash_sigma_rad, by_delay_rad))
    warn("backlash", "its error depends on the direction of the motion, by " + way(backlash) +
                         ": move it in one direction only, or look after the drive");
  if (seen.trust == AngleTrust::free)
    warn("angles_not_used", "its mm were not used, each of its lines stands by its points alone: " +
                                seen.reason + " (error " + way(seen.error_rms_rad) + " rms, " +
                                way(seen.expected_rms_rad) + " expected)");
  return advice;
}

}  // namespace identify
