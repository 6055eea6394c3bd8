// Lines that a measuring device sends. The first line is taken for its columns, the rest for what
// came in one datagram: points are finite, and any bytes are told from points.
#include <cmath>
#include <stdexcept>

#include "daemon/points/device_lines.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  auto input = fuzz::text(data, size);
  try {
    sweepd::DeviceLines lines(sweepd::next_line(input));
    while (!input.empty()) {
      const auto before = input.size();
      sweepd::Point point;
      point.sample.time_s = 4;
      const auto kind = lines.read(sweepd::next_line(input), point);
      expect(input.size() < before, "a line takes something");
      expect(!text(kind).empty(), "each kind of line has words");
      if (kind != sweepd::DeviceLines::Line::point) continue;
      expect(point.sample.has_position && point.sample.position_mm.allFinite(),
             "a position is finite");
      expect(std::isfinite(point.sample.time_s), "a time is finite");
      expect(lines.with_times() || point.sample.time_s == 4, "time is left as it was");
      expect(point.target < lines.targets().size() && lines.targets().size() <= 64,
             "a target has a name");
      expect(std::isfinite(lines.step_mm()) && lines.step_mm() >= 0, "the step is a length");
    }
  } catch (const std::invalid_argument& error) {
    expect(fuzz::is_one_line(error.what()), "an error is one line");
  }
  return 0;
}
