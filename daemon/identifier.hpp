#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
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
/// run.json. On threads of its own: what somebody waits for has a fair share of the processors and
/// never waits for an interim result, whose share is low. Nobody waits for them but drain(); what
/// goes wrong there is logged. All robots of this program together make their last results on half
/// of the processors, and their interim ones: the rest is for replies.
///
/// One thread hands over; took() and drain() are any thread's.
class Identifier {
 public:
  /// `status` learns of each result.
  explicit Identifier(std::shared_ptr<RobotStatus> status) : status_(std::move(status)) {}

  /// A result while the session goes on. Gives way to the next one where it has not begun, and to
  /// the last one in any case.
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
  struct Identified {
    Outcome outcome;
    std::chrono::steady_clock::time_point began;  ///< once its turn had come
    std::chrono::nanoseconds took{};
  };
  static Identified identify(const Snapshot& snapshot, Share share);
  void publish(const Identified& identified, bool interim, const Log& log);

  const std::shared_ptr<RobotStatus> status_;
  std::atomic<std::uint64_t> ended_{0};  // sessions whose last result is under way or done
  std::mutex mutex_;                     // of whoever publishes and writes a result
  std::atomic<std::chrono::steady_clock::duration> took_{};
  JobThread interim_jobs_{"interim result", Share::low};
  JobThread jobs_{"identification", Share::fair};
};

}  // namespace sweepd
