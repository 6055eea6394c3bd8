#include "daemon/service/robot_inputs.hpp"

#include <fstream>
#include <sstream>
#include <utility>

#include <spdlog/fmt/ranges.h>

#include "daemon/system/disk_room.hpp"

namespace sweepd {
namespace {

std::vector<std::filesystem::path> files_of(const RobotSettings& settings) {
  std::vector<std::filesystem::path> files;
  if (!settings.description.empty()) files.push_back(settings.description);
  for (const auto& file : {settings.plan, settings.ethernet_config})
    if (file) files.push_back(*file);
  return files;
}

/// Empty if there is no file.
std::string content(const std::optional<std::filesystem::path>& file) {
  std::ostringstream text;
  if (file) text << std::ifstream(*file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

RobotFacts RobotInputs::facts() const {
  RobotFacts facts{setup.joints, {}, {}, setup.limits()};
  if (setup.description) {
    facts.home_deg = setup.description->home_deg;
    if (setup.description->arm) facts.specified = setup.description->arm->rows;
  }
  return facts;
}

RunFacts RobotInputs::run_facts() const {
  RunFacts facts;
  facts.robot = settings.name;
  facts.description = settings.description;
  facts.ethernet_config = settings.ethernet_config;
  facts.inputs = hashes;
  return facts;
}

RobotInputs RobotInputs::read(const RobotSettings& settings) {
  return {settings, load_setup(settings), hashes_of(files_of(settings)),
          file_system_of(settings.output / settings.name)};
}

ReloadedInputs::ReloadedInputs(const RobotSettings& given)
    : given_(given), ethernet_xml_(content(given.ethernet_config)) {}

void ReloadedInputs::reload(const RobotSettings& settings, const Log& log) {
  const auto changed = change(given_, settings);
  auto inputs = RobotInputs::read(settings);
  given_ = settings;
  if (!changed.after_restart.empty())
    log.warning("only a restart of sweepd takes over {}", fmt::join(changed.after_restart, ", "));
  if (content(settings.ethernet_config) != ethernet_xml_)
    log.warning("the Ethernet file has changed: restart sweepd before RSI uses it");
  log.note("{}",
           changed.live.empty()
               ? std::string("description and plan read again, for the next session")
               : fmt::format("taken over for the next session: {}", fmt::join(changed.live, ", ")));
  const std::lock_guard lock(mutex_);
  waiting_ = std::move(inputs);
}

std::optional<RobotInputs> ReloadedInputs::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace sweepd
