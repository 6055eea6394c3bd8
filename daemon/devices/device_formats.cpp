#include "daemon/devices/device_formats.hpp"

#include <array>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/maker_formats.hpp"

namespace sweepd {

std::span<const DeviceFormat> device_formats() {
  // Tables of trackers are recognised by less than the others, the one without a maker by least.
  static constexpr auto kFormats = std::to_array<DeviceFormat>({
      {"motive", "OptiTrack Motive CSV", is_motive_csv, motive_layout},
      {"vicon", "Vicon Nexus or Tracker CSV", is_vicon_csv, vicon_layout},
      {"qtm", "Qualisys QTM TSV", is_qtm_tsv, qtm_layout},
      {"ndi", "NDI ToolBox or First Principles CSV", is_ndi_csv, ndi_layout},
      {"ros", "ROS PoseStamped CSV", is_ros_csv, ros_layout},
      {"polyworks", "PolyWorks text", is_polyworks_text, tracker_layout},
      {"faro", "FARO CSV", is_faro_csv, tracker_layout},
      {"leica", "Leica T-Mac or AT9x0 CSV", is_leica_csv, tracker_layout},
      {"spatialanalyzer", "SpatialAnalyzer text", is_spatial_analyzer_text, tracker_layout},
      {"tracker", "table of X, Y, Z with units", is_tracker_table, tracker_layout},
  });
  return kFormats;
}

const DeviceFormat* recognised_format(const DeviceText& head) {
  for (const DeviceFormat& format : device_formats())
    if (format.is(head)) return &format;
  return nullptr;
}

std::string format_list() {
  std::string list;
  for (const DeviceFormat& format : device_formats())
    list += fmt::format("  {:<17}{}\n", format.name, format.title);
  return list + fmt::format("  {:<17}{}\n", kOwnFormat, "sweepd's own columns, or --columns");
}

}  // namespace sweepd
