#pragma once

// A KR 5 arc as another device sees it, and the files that such a device leaves.

#include <string>
#include <vector>

#include "daemon/text/numbers.hpp"
#include "daemon/text/units.hpp"
#include "tests/identify/simulated_campaign.hpp"

namespace sweepd::test {

/// The samples of one sweep.
struct MeasuredSweep {
  std::size_t joint;  ///< from 1
  std::vector<identify::Sample> samples;
};

/// The paper's 90 degree set as it is run, positioning and all, and each sweep by itself.
struct Measured {
  std::vector<identify::Sample> stream;
  std::vector<MeasuredSweep> sweeps;
};

inline Measured measured_kr5(const identify::test::Noise& noise,
                             const Eigen::Vector3d& target_mm = {200, 0, 215}) {
  struct Planned {
    std::size_t joint;
    double start_deg;
    double end_deg;
  };
  auto arm = identify::test::kr5_arc();
  arm.tool_mm = target_mm;
  identify::test::Campaign campaign(arm, noise);
  Measured measured;
  campaign.rest();
  for (const auto& [joint, start_deg, end_deg] :
       {Planned{0, -45, 45}, Planned{1, -60, -130}, Planned{2, 120, 30}, Planned{3, 90, 0},
        Planned{4, 90, 0}, Planned{5, 0, 90}}) {
    const double home_deg = degrees(arm.home_rad[joint]);
    if (start_deg != home_deg) campaign.move(joint, start_deg, 60).rest();
    const auto begin = static_cast<std::ptrdiff_t>(campaign.samples().size());
    campaign.move(joint, end_deg);
    measured.sweeps.push_back(
        {joint + 1, {campaign.samples().begin() + begin, campaign.samples().end()}});
    campaign.rest();
    if (end_deg != home_deg) campaign.move(joint, home_deg, 60).rest();
  }
  measured.stream = campaign.samples();
  return measured;
}

/// What the lines of a file of points hold beside positions.
struct Layout {
  bool times = false;
  bool angles = false;
  std::string more = "";  ///< names of further columns: "joint,"
};

inline std::string points_header(const Layout& layout) {
  std::string header = layout.more + (layout.times ? "t_s," : "") + "x_mm,y_mm,z_mm";
  for (int j = 1; layout.angles && j <= 6; ++j) header += ",a" + std::to_string(j) + "_deg";
  return header + "\n";
}

/// A line a sample, six decimals; `more` stands at the beginning of each.
inline std::string points_lines(const std::vector<identify::Sample>& samples, const Layout& layout,
                                const std::string& more = "") {
  constexpr int kDecimals = 6;
  std::string lines;
  for (const auto& sample : samples) {
    lines += more;
    if (layout.times) lines += fixed(sample.time_s, 3) + ",";
    for (const double value : sample.position_mm) lines += fixed(value, kDecimals) + ",";
    for (std::size_t j = 0; layout.angles && j < 6; ++j)
      lines += fixed(degrees(sample.angles_rad[j]), kDecimals) + ",";
    lines.back() = '\n';
  }
  return lines;
}

/// All sweeps of a file that names the joint of each line.
inline std::string listed_points(const Measured& measured, const Layout& layout) {
  std::string text = points_header(layout);
  for (const auto& sweep : measured.sweeps)
    text += points_lines(sweep.samples, layout, std::to_string(sweep.joint) + ",");
  return text;
}

}  // namespace sweepd::test
