#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <utility>

#include "daemon/job_thread.hpp"
#include "daemon/link_watch.hpp"
#include "daemon/log.hpp"
#include "daemon/recording.hpp"
#include "daemon/robot_state.hpp"
#include "daemon/run_json.hpp"
#include "daemon/session.hpp"

namespace sweepd {

/// Identifies one robot from its sessions and writes what they leave: results, link report,
/// run.json. On a thread of its own, on which nobody waits but drain(); what goes wrong there is
/// logged. All robots of this program together identify on half of the processors: the rest is for
/// replies.
///
/// One thread hands over; took() and drain() are any thread's.
class Identifier {
 public:
  /// `status` learns of each result.
  explicit Identifier(std::shared_ptr<RobotStatus> status) : status_(std::move(status)) {}

  /// A result while the session goes on. Gives way to the next one where it has not begun.
  void interim(std::shared_ptr<const Recording> recording, Snapshot snapshot, Log log);
  /// The last result, after the end of the recording, and how the link did. Once run.json has
  /// "ended", all files of the session are the final ones.
  void last(std::shared_ptr<const Recording> recording, Snapshot snapshot, RunFacts run,
            LinkFiles link, Log log);
  /// How the link does while the session goes on.
  void link(std::shared_ptr<const Recording> recording, LinkFiles link, Log log);

  /// What the newest interim result took.
  [[nodiscard]] std::chrono::steady_clock::duration took() const noexcept { return took_; }
  /// Waits until all is written: true. Or until `deadline`.
  bool drain(std::chrono::steady_clock::time_point deadline) { return jobs_.drain(deadline); }

 private:
  Outcome identify(const Snapshot& snapshot);
  void publish(const Outcome& outcome, bool interim, const Log& log);

  const std::shared_ptr<RobotStatus> status_;
  std::chrono::steady_clock::time_point began_;  // the newest, once its turn had come
  std::chrono::nanoseconds identified_in_{};
  std::atomic<std::chrono::steady_clock::duration> took_{};
  JobThread jobs_;
};

}  // namespace sweepd
