#include "daemon/results/displacement_csv.hpp"

#include <array>
#include <cmath>

#include "daemon/report/file_parts.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

constexpr double kUnknownRange_deg = 90;
constexpr std::array kSliceNames = {"x", "y", "z"};

void add_displaced(std::string& csv, const char* slice,
                   const std::vector<identify::DisplacedPoint>& points) {
  for (const auto& point : points) {
    csv += slice;
    for (const double value : point.at_mm) append_fixed(csv += ',', value, 0);
    for (const double value : point.by_mm) append_fixed(csv += ',', value, 4);
    append_fixed(csv += ',', point.by_mm.norm(), 4);
    append_fixed(csv += ',', point.band_mm, 4);
    csv += '\n';
  }
}

}  // namespace

identify::JointRanges joint_ranges(const PosePredictor& predictor,
                                   const std::vector<JointLimits>& limits) {
  identify::JointRanges ranges;
  const auto& home_rad = predictor.fit.model.home_rad;
  for (std::size_t j = 0; j < home_rad.size(); ++j) {
    const bool known =
        j < limits.size() && std::isfinite(limits[j].min_deg) && std::isfinite(limits[j].max_deg);
    if (known)
      ranges.push_back({radians(limits[j].min_deg), radians(limits[j].max_deg)});
    else
      ranges.push_back(
          {home_rad[j] - radians(kUnknownRange_deg), home_rad[j] + radians(kUnknownRange_deg)});
  }
  return ranges;
}

std::vector<JointLimits> limits_in(const nlohmann::ordered_json& result) {
  std::vector<JointLimits> limits;
  for (const auto& json : list_of(result, "limits_deg")) {
    limits.emplace_back();
    if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
      continue;
    const double least = json[0].get<double>(), most = json[1].get<double>();
    if (!(least < most)) continue;  // of a joint that cannot move nothing is a range
    limits.back() = {least, most};
  }
  return limits;
}

identify::DisplacementMap displacement_of(const PosePredictor& predictor,
                                          const std::vector<JointLimits>& limits) {
  if (predictor.levels.empty()) return {};
  return displacement_map(predictor.fit, predictor.levels.front(), joint_ranges(predictor, limits));
}

std::string displacement_csv(const identify::DisplacementMap& map) {
  std::string csv = "slice,x_mm,y_mm,z_mm,dx_mm,dy_mm,dz_mm,size_mm,band95_mm\n";
  add_displaced(csv, "", map.grid);
  for (const auto& slice : map.slices)
    add_displaced(csv, kSliceNames.at(slice.across), slice.points);
  return csv;
}

}  // namespace sweepd
