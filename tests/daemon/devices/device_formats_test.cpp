// Files of every device, as they are: the points are those of the take.

#include "daemon/devices/device_formats.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/points/device_points.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/devices/device_files.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;
using namespace sweepd::test;

namespace {

/// Six decimals are printed, of metres at most: half of the last in each coordinate. And eight of a
/// quaternion (six of a matrix).
constexpr double kPrinted_mm = 9e-4;
constexpr double kPrinted_rad = 3e-6;
/// Times are printed to a tenth of a millisecond or, as FARO and SpatialAnalyzer do, to one.
constexpr double kPrinted_s = 1e-6;

std::string text_of(const DeviceFile& file) {
  return file.write(some_take());
}

/// Every point is one of the take, in its order. Returns how many there are.
std::size_t check_points(const PointsFile& file, const std::vector<std::string>& targets,
                         const Take& take, const DeviceFile& kind) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < take.frames.size(); ++i) {
    const Frame& frame = take.frames[i];
    std::vector<std::optional<Eigen::Vector3d>> places{frame.body_mm};
    if (kind.of == Of::markers) places = frame.markers_mm;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (!places[k]) continue;
      if (at == file.points.size()) return at;
      const Point& point = file.points[at++];
      REQUIRE(point.sample.has_position);
      REQUIRE((point.sample.position_mm - *places[k]).norm() < kPrinted_mm);
      if (kind.of == Of::markers && take.names[k] != targets[point.target])
        REQUIRE_THAT(targets[point.target], ContainsSubstring("marker " + std::to_string(k + 1)));
      REQUIRE(point.sample.has_orientation == kind.has_turn);
      if (kind.has_turn) {
        const Eigen::AngleAxisd off(identify::orientation(point.sample).transpose() *
                                    frame.body_turn.toRotationMatrix());
        REQUIRE(std::abs(off.angle()) < kPrinted_rad);
      }
      REQUIRE(point.sample.time_s ==
              Approx(kind.has_times ? frame.time_s : double(at - 1)).margin(kPrinted_s));
    }
  }
  CHECK(at == file.points.size());
  return at;
}

/// Bytes of a text as a file in UTF-16.
std::string utf16(std::string_view ascii, bool big) {
  std::string bytes = big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : ascii) {
    if (big) bytes += '\0';
    bytes += c;
    if (!big) bytes += '\0';
  }
  return bytes;
}

/// As a spreadsheet of a country with decimal commas writes it again.
std::string with_commas(std::string text, char separator) {
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    if (text[i] == ',') text[i] = separator;
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    if (text[i] == '.' && is_digit(text[i - 1]) && is_digit(text[i + 1])) text[i] = ',';
  }
  return text;
}

}  // namespace

TEST_CASE("a device's file is recognised by content and gives the points of its take",
          "[device_formats]") {
  const TemporaryFolder folder;
  for (const auto& kind : device_files()) {
    const Take take = some_take();
    const auto path = folder.write("any.name", kind.write(take));
    INFO(kind.format << '\n' << kind.write(some_take(3)));
    PointsReader reader({}, 6);
    const auto file = reader.read(path, {});
    const auto formats = device_formats();
    const auto format = std::find_if(formats.begin(), formats.end(),
                                     [&](const auto& one) { return one.name == kind.format; });
    REQUIRE(format != formats.end());
    CHECK(file.format == format->title);
    CHECK(file.with_times == kind.has_times);
    CHECK_FALSE(file.with_joints);
    CHECK(check_points(file, reader.targets(), take, kind) ==
          (kind.of == Of::markers ? 3 * take.frames.size() - 2 : take.frames.size()));
    CHECK(reader.targets().size() == (kind.of == Of::markers ? 3 : 1));
    CHECK(reader.resolution().position_mm > 0);
    CHECK(reader.resolution().position_mm <= 1e-3);
    // Forced, it is the same.
    PointsReader forced({}, 6, kind.format);
    CHECK(forced.read(path, {}).points.size() == file.points.size());
  }
}

TEST_CASE("UTF-16 and a byte order mark change nothing", "[device_formats]") {
  const TemporaryFolder folder;
  for (const auto& kind : device_files()) {
    INFO(kind.format);
    for (const auto& bytes : {utf16(text_of(kind), false), utf16(text_of(kind), true),
                              "\xef\xbb\xbf" + text_of(kind)}) {
      PointsReader reader({}, 6);
      const auto file = reader.read(folder.write("wide.csv", bytes), {});
      CHECK(check_points(file, reader.targets(), some_take(), kind) > 0);
    }
  }
}

TEST_CASE("semicolons or tabs with decimal commas change nothing", "[device_formats]") {
  const TemporaryFolder folder;
  for (const auto& kind : device_files()) {
    if (kind.format == "ros" || kind.format == "polyworks") continue;  // no spreadsheet's
    for (const char separator : {';', '\t'}) {
      const auto text = with_commas(text_of(kind), separator);
      INFO(kind.format << '\n' << text.substr(0, 1500));
      PointsReader reader({}, 6);
      const auto file = reader.read(folder.write("german.csv", text), {});
      CHECK(check_points(file, reader.targets(), some_take(), kind) > 0);
    }
  }
}

TEST_CASE("a file that is cut anywhere is an error with its place, or gives the points before",
          "[device_formats]") {
  const Take take = some_take(4);
  for (const auto& kind : device_files()) {
    const auto text = kind.write(take);
    for (const bool is_wide : {false, true}) {
      const auto bytes = is_wide ? utf16(text, false) : text;
      std::size_t read = 0, refused = 0;
      for (std::size_t size = 0; size < bytes.size(); ++size) {
        INFO(kind.format << ", cut after " << size << " of " << bytes.size() << " bytes:\n"
                         << text.substr(0, size / (is_wide ? 2 : 1)));
        try {
          const DeviceText cut("cut.csv", bytes.substr(0, size));
          const DeviceFormat* format = recognised_format(cut);
          if (format == nullptr) continue;  // too little is left
          TargetNames targets;
          std::optional<double> step_mm;
          const auto file = device_points(*format, cut, 6, targets, step_mm, {});
          DeviceFile left = kind;
          left.has_times = file.with_times;  // dates of one point tell no rate
          check_points(file, targets.all(), take, left);
          ++read;
        } catch (const CsvError& error) {
          REQUIRE_THAT(error.what(), Catch::Matchers::StartsWith("cut.csv: "));
          ++refused;
        }
      }
      CHECK(read > 0);
      CHECK(refused > read);
    }
  }
}

TEST_CASE("files of sweepd's own columns are no device's", "[device_formats]") {
  for (const std::string text :
       {"t_s,x_mm,y_mm,z_mm\n0,1.5,2.5,3.5\n", "T_S,X_MM,Y_MM,Z_MM\n0,1.5,2.5,3.5\n",
        "joint,x_m,y_m,z_m,qx,qy,qz,qw\n1,1,2,3,0,0,0,1\n", "x_mm;y_mm;z_mm\n1.5;2.5;3.5\n",
        "1.5,2.5,3.5\n", "1.5 2.5 3.5\n", "x,y,z\n1.5,2.5,3.5\n",
        "# Leica AT960, FARO, T-Mac\nx_mm,y_mm,z_mm\n1.5,2.5,3.5\n", "", "\n", "Frame\n", "Tools\n",
        "Objects\n", "joint,x_mm,y_mm,z_mm,dx,dy,dz\n", "t_s,X [mm],Y [mm],Z [mm]\n0,1.5,2.5,3.5\n",
        "Time [s],X [mm],Y [mm],Z [mm],A1,A2 [deg],a3_mm\n0,1.5,2.5,3.5,1,2,3\n"}) {
    INFO(text);
    CHECK(recognised_format(DeviceText("x.csv", text)) == nullptr);
  }
}

TEST_CASE("a format that is forced tells what it did not find", "[device_formats]") {
  const TemporaryFolder folder;
  for (const auto& format : device_formats())
    for (const std::string text : {"", "\n\n", "hello\n", "a,b\n1,2\n", "\"\n", "x_mm,y_mm\n"}) {
      INFO(format.name << ": " << text);
      const auto path = folder.write("x.csv", text);
      PointsReader reader({}, 6, format.name);
      CHECK_THROWS_AS(reader.read(path, {}), CsvError);
      CHECK_THROWS_WITH(reader.read(path, {}), ContainsSubstring("x.csv: ") &&
                                                   ContainsSubstring("expected ") &&
                                                   ContainsSubstring(", found "));
    }
  CHECK_THROWS_WITH(PointsReader({}, 6, "moive"), ContainsSubstring("--format moive"));
  CHECK_THROWS_AS(PointsReader({"x_mm"}, 6, "motive"), std::invalid_argument);
  CHECK_NOTHROW(PointsReader({"x_mm"}, 6, "sweepd"));
}
