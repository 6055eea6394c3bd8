#include "daemon/service/robot_inputs.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <spdlog/fmt/ranges.h>
#include <unistd.h>

#include "daemon/service/robot_server.hpp"
#include "daemon/system/disk_room.hpp"
#include "rsi/file_bytes.hpp"
#include "rsi/telegram/ethernet_config.hpp"

namespace sweepd {
namespace {

using Files = std::vector<std::filesystem::path>;

Files files_of(const RobotSettings& settings) {
  Files files;
  if (!settings.description.empty()) files.push_back(settings.description);
  if (settings.plan) files.push_back(*settings.plan);
  return files;
}

/// As much as an Ethernet file may have; empty if there is none.
std::string content(const std::optional<std::filesystem::path>& file) {
  std::error_code unreadable;
  return file ? rsi::file_bytes(*file, rsi::EthernetConfig::kMostBytes, unreadable) : "";
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

RobotState RobotInputs::first_state(const rsi::Server& server) const {
  RobotState state;
  state.name = settings.name;
  state.listen = server.local();
  state.transport = server.transport();
  state.replies = server.replies();
  for (std::size_t joint = 1; joint <= setup.joints; ++joint) state.sweeps[joint] = {};
  return state;
}

RunFacts RobotInputs::run_facts() const {
  RunFacts facts;
  facts.robot = settings.name;
  facts.description = settings.description;
  facts.ethernet_config = settings.ethernet_config;
  facts.inputs = hashes;
  facts.inputs.insert(facts.inputs.end(), ethernet.begin(), ethernet.end());
  return facts;
}

void RobotInputs::make_folder(const Log& log) const {
  std::error_code error;
  std::filesystem::create_directories(folder(), error);
  if (error)
    throw std::runtime_error("cannot make the folder " + folder().string() + " (" +
                             error.message() +
                             "): give one that may be written with `output` or --output");
  if (::faccessat(AT_FDCWD, folder().c_str(), W_OK | X_OK, AT_EACCESS) != 0)
    log.warning(
        "{} cannot be written ({}): until it can, nothing is recorded and no result is written: "
        "give the folder to the user who runs sweepd, or set `output`",
        folder().string(), std::generic_category().message(errno));
}

RobotInputs RobotInputs::read(const RobotSettings& settings) {
  return {settings, load_setup(settings), hashes_of(files_of(settings)),
          hashes_of(settings.ethernet_config ? Files{*settings.ethernet_config} : Files{}),
          file_system_of(settings.output / settings.name)};
}

ReloadedInputs::ReloadedInputs(const RobotSettings& given)
    : started_with_(given), given_(given), ethernet_xml_(content(given.ethernet_config)) {}

void ReloadedInputs::reload(const RobotSettings& settings, const Log& log) {
  auto inputs = RobotInputs::read(settings);
  static_cast<void>(ethernet_config_of(settings));  // it has to be good when sweepd starts again
  inputs.make_folder(log);
  const auto waits = change(started_with_, settings).of(TakesEffect::after_restart);
  const auto changed = change(given_, settings);
  given_ = settings;
  if (!waits.empty()) log.warning("only a restart of sweepd takes over {}", fmt::join(waits, ", "));
  if (content(settings.ethernet_config) != ethernet_xml_)
    log.warning("the Ethernet file has changed: restart sweepd before RSI uses it");
  if (const auto& keys = changed.of(TakesEffect::at_once); !keys.empty())
    log.note("taken over: {}", fmt::join(keys, ", "));
  const auto& next = changed.of(TakesEffect::next_session);
  log.note("{}", next.empty()
                     ? std::string("description and plan read again, for the next session")
                     : fmt::format("taken over for the next session: {}", fmt::join(next, ", ")));
  const std::lock_guard lock(mutex_);
  waiting_ = std::move(inputs);
}

std::optional<RobotInputs> ReloadedInputs::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, std::nullopt);
}

}  // namespace sweepd
