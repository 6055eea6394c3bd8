#pragma once

#include <span>
#include <string>
#include <string_view>

#include "daemon/devices/device_layout.hpp"
#include "daemon/devices/device_text.hpp"

namespace sweepd {

/// A kind of file that programs of measuring devices write.
struct DeviceFormat {
  std::string_view name;   ///< as --format takes it
  std::string_view title;  ///< for people
  /// By content; the first lines of a file are enough.
  bool (*is)(const DeviceText& text);
  /// Throws CsvError where the file is none of this kind, or cut.
  DeviceLayout (*layout)(const DeviceText& text);
};

/// All of them: this table is the one place that names them. The first that recognises a file reads
/// it.
[[nodiscard]] std::span<const DeviceFormat> device_formats();

/// Nothing where none of them recognises `head`, the beginning of a file.
[[nodiscard]] const DeviceFormat* recognised_format(const DeviceText& head);

/// What --format takes for a file of sweepd's own columns.
inline constexpr std::string_view kOwnFormat = "sweepd";

/// One a line, with what they are.
[[nodiscard]] std::string format_list();

}  // namespace sweepd
