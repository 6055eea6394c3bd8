// What a user edits: settings, robot descriptions (input that begins with "r") and sweep plans
// ("p"). Nothing but a ConfigError comes out, with a line for each mistake; what is accepted can be
// used as it is.
#include <algorithm>
#include <cmath>

#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/text/text_layout.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

bool are_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

void check_settings(const std::filesystem::path& path) {
  const auto settings = sweepd::load_settings(path);
  expect(!settings.robots.empty(), "there is a robot");
  expect(!settings.http.listen || settings.http.listen->port > 0, "pages have a port");
  for (const auto& host : settings.http.hosts.names)
    expect(!host.empty() && host.find_first_of(":/ ") == std::string::npos, "a host is a name");
  for (const auto& robot : settings.robots) {
    expect(!robot.name.empty() && robot.name.find('/') == std::string::npos && robot.name != "..",
           "a name can name a folder");
    expect(robot.listen.port > 0, "there is a port");
    expect(robot.silence.count() > 0 && robot.queue_bytes > 0, "there is time and room");
    expect(!robot.output.empty() && !robot.description.empty(), "there are paths");
    expect(!robot.signals.angles.empty() && robot.signals.angles.size() <= 12, "angles of an arm");
  }
}

sweepd::RobotDescription check_robot(const std::filesystem::path& path) {
  auto robot = sweepd::load_robot(path);
  expect(robot.joints() >= 1 && robot.joints() <= 12, "an arm has joints");
  expect(robot.home_deg.empty() || robot.home_deg.size() == robot.joints(), "home is whole");
  expect(are_finite(robot.home_deg), "home is a pose");
  for (const auto& limits : robot.limits)
    expect(limits.min_deg < limits.max_deg, "limits in order");
  if (!robot.arm) return robot;
  expect(robot.arm->rows.size() == robot.joints(), "a row a joint");
  expect(robot.arm->positive.size() == robot.joints(), "a direction a joint");
  expect(robot.arm->home_rad.size() == robot.joints(), "an angle a joint");
  expect(robot.arm->tool_mm.allFinite(), "the tool point is a point");
  return robot;
}

void check_plan(const std::filesystem::path& path) {
  const auto plan = sweepd::load_plan(path);
  expect(!plan.sweeps.empty() && are_finite(plan.home_deg), "a plan has sweeps and a home");
  for (const auto& sweep : plan.sweeps) {
    expect(sweep.joint >= 1 && sweep.joint <= plan.home_deg.size(), "a sweep has a joint");
    expect(sweep.start_deg != sweep.end_deg && sweep.speed_deg_s > 0, "a sweep ends");
  }
  sweepd::RobotDescription robot;
  robot.limits.assign(6, {-90, 90});
  for (const auto& finding : sweepd::check_plan(plan, robot))
    expect(fuzz::is_one_line(finding), "a finding is one line");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File file;
  const auto input = fuzz::text(data, size);
  const char kind = input.empty() ? ' ' : input.front();
  const auto toml = kind == 'r' || kind == 'p' ? input.substr(1) : input;
  file.write(toml);
  try {
    if (kind == 'r')
      check_robot(file.path());
    else if (kind == 'p')
      check_plan(file.path());
    else
      check_settings(file.path());
  } catch (const sweepd::ConfigError& error) {
    for (const auto& mistake : sweepd::lines_of(error.what())) {
      expect(mistake.starts_with(file.path().native()), "the file is named");
      expect(fuzz::is_one_line(mistake), "a mistake is one line");
    }
  }
  return 0;
}
