#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/record/recording.hpp"
#include "daemon/service/service_status.hpp"
#include "identify/sweeps/sweep.hpp"
#include "rsi/link/link.hpp"

namespace sweepd {

/// Adds up what happened to one robot, session after session. One thread.
class RobotTally {
 public:
  /// `robot`: its name and how it is served; the rest is zero.
  explicit RobotTally(RobotState robot) : state_(std::move(robot)), ended_(state_.link) {}

  void begin_session(StreamState stream, std::shared_ptr<const Recording> recording);
  /// `words`: what is said of it.
  void sweep(const identify::Sweep& sweep, std::string words);
  void end_session(const rsi::LinkReport& report);
  void results(const ResultBacklog& results) { state_.results = results; }
  void disk_free(std::optional<std::uint64_t> bytes) { state_.disk_free = bytes; }

  /// At this moment; `under_way`: of the session, if there is one. What is settled of it is
  /// counted.
  [[nodiscard]] const RobotState& state(const rsi::Server::Counts& server, bool recording_paused,
                                        const std::optional<rsi::Link::Reports>& under_way);

 private:
  void add_recordings();

  RobotState state_;
  LinkTotals ended_;            // sessions
  Recording::Counts recorded_;  // by recordings that are complete on the disk
  std::vector<std::shared_ptr<const Recording>> recordings_;  // the others
};

}  // namespace sweepd
