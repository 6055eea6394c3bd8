#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "daemon/results/run_json.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/turn_threads.hpp"

namespace sweepd {

/// What a session is made of, beside its telegrams: the robot's settings and the files they name.
struct RobotInputs {
  RobotSettings settings;
  RobotSetup setup;
  std::vector<FileHash> hashes;    ///< of description and plan
  std::vector<FileHash> ethernet;  ///< of the Ethernet file
  TurnThreads::Group disk;         ///< the file system of the output

  /// Where its sessions lie.
  [[nodiscard]] std::filesystem::path folder() const { return settings.output / settings.name; }

  /// What viewers are told of the robot.
  [[nodiscard]] RobotFacts facts() const;
  /// What is told of it while nothing has come to `server`.
  [[nodiscard]] RobotState first_state(const rsi::Server& server) const;
  /// What a session's run.json is told of them.
  [[nodiscard]] RunFacts run_facts() const;

  /// Makes folder(), and warns where this user may not write into it: telegrams are answered all
  /// the same. Throws std::runtime_error.
  void make_folder(const Log& log) const;

  /// Reads the files. Throws ConfigError.
  [[nodiscard]] static RobotInputs read(const RobotSettings& settings);
};

/// Inputs that were read again wait here for the next session.
class ReloadedInputs {
 public:
  explicit ReloadedInputs(const RobotSettings& given);

  /// Reads the files again, makes the output folder, and says what changes with the next session
  /// and what needs a restart. Throws ConfigError or std::runtime_error, and changes nothing then.
  /// One thread at a time.
  void reload(const RobotSettings& settings, const Log& log);
  /// Nothing if there are none. Another thread's.
  [[nodiscard]] std::optional<RobotInputs> take();

 private:
  const RobotSettings started_with_;
  RobotSettings given_;       // by the last reload
  std::string ethernet_xml_;  // what the Ethernet file held at the start
  std::mutex mutex_;
  std::optional<RobotInputs> waiting_;
};

}  // namespace sweepd
