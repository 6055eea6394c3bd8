// Files of measuring devices: recognition, and the reader of every format. A first byte from 1 on
// forces the format of that number. Only a CsvError comes out, in one line, with the file's name;
// what is read is finite and in order.
#include <cmath>

#include "daemon/devices/device_formats.hpp"
#include "daemon/points/device_points.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

constexpr std::size_t kJoints = 6;

void check_points(const sweepd::DeviceFormat& format, const sweepd::DeviceText& text) {
  sweepd::TargetNames targets;
  std::optional<double> step_mm;
  const auto file = sweepd::device_points(format, text, kJoints, targets, step_mm, {});
  expect(!file.points.empty(), "there are points");
  expect(step_mm && std::isfinite(*step_mm) && *step_mm >= 0, "the resolution is a length");
  for (const auto& note : file.notes) expect(fuzz::is_one_line(note), "a note is one line");
  std::vector<double> last(targets.all().size(), -1e300);
  for (const auto& point : file.points) {
    expect(point.target < targets.all().size(), "a target has a name");
    expect(point.joint <= kJoints, "a joint is one of the arm");
    expect(file.with_joints == (point.joint > 0), "all points have a joint, or none");
    expect(point.sample.has_position && point.sample.position_mm.allFinite(),
           "a position is finite");
    if (point.sample.has_orientation)
      for (const double angle : point.sample.abc_rad)
        expect(std::isfinite(angle), "A, B, C are finite");
    expect(std::isfinite(point.sample.time_s), "a time is finite");
    if (file.with_joints) continue;
    expect(point.sample.time_s >= last[point.target], "times are in order");
    last[point.target] = point.sample.time_s;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto formats = sweepd::device_formats();
  auto input = fuzz::text(data, size);
  const sweepd::DeviceFormat* format = nullptr;
  if (!input.empty() && input.front() > 0 &&
      static_cast<std::size_t>(input.front()) <= formats.size()) {
    format = &formats[static_cast<std::size_t>(input.front()) - 1];
    input.remove_prefix(1);
  }
  try {
    const sweepd::DeviceText text("take.csv", std::string(input));
    if (format == nullptr) format = sweepd::recognised_format(text);
    if (format != nullptr) check_points(*format, text);
  } catch (const sweepd::CsvError& error) {
    expect(std::string_view(error.what()).starts_with("take.csv: "), "the file is named");
    expect(fuzz::is_one_line(error.what()), "an error is one line");
  }
  return 0;
}
