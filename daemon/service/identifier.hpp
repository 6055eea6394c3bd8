#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/record/recording.hpp"
#include "daemon/service/job_thread.hpp"
#include "daemon/service/link_watch.hpp"
#include "daemon/service/service_status.hpp"
#include "daemon/service/session_end.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/system/file_hash.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

/// Identifies one robot from its sessions and writes what they leave: results, link report,
/// run.json. On threads of its own while there is work: what somebody waits for has a fair share of
/// the processors and never waits for an interim result, whose share is low. Nobody waits for them
/// but drain(); what goes wrong there is logged. All robots of this program together make their
/// last results on half of the processors, and their interim ones: the rest is for replies.
///
/// What cannot be written is tried again until it is. Of sessions that wait for their disk a
/// bounded number is kept in memory; the oldest is given up then, and made from its recording at
/// the next start.
///
/// One thread hands over; took(), results() and drain() are any thread's.
class Identifier {
 public:
  using Steady = std::chrono::steady_clock;

  static constexpr std::size_t kMostWaiting = 64;
  /// Of all sessions that wait, as many as one session may have; the newest is always kept.
  static constexpr std::size_t kMostSamples = Session::kMostSamples;

  /// `status` learns of each result.
  explicit Identifier(std::shared_ptr<RobotStatus> status) : status_(std::move(status)) {}
  ~Identifier() { draining_ = true; }  ///< as drain(), however long it takes
  Identifier(const Identifier&) = delete;
  Identifier& operator=(const Identifier&) = delete;

  /// Identifies the sessions whose last result an earlier sweepd did not write, one after the
  /// other, between interim results and with their share.
  void finish_earlier(std::filesystem::path robot_folder, RobotSetup setup,
                      std::vector<FileHash> inputs, Log log);
  /// A result while the session goes on. Gives way to the next one where it has not begun, and to
  /// the last one in any case.
  void interim(std::shared_ptr<const Recording> recording, Snapshot snapshot, Log log);
  /// The last result, after the end of the recording, and how the link did. Once run.json has
  /// "ended", all files of the session are the final ones.
  void last(SessionEnd end);
  /// How the link does while the session goes on.
  void link(std::shared_ptr<const Recording> recording, LinkFiles link, Log log);
  /// Sessions that no folder could be made for are tried in this one from now on. Any thread.
  void write_to(std::filesystem::path robot_folder);
  /// To be called now and then: what could not be written is tried again when its time has come.
  void try_again(Steady::time_point now);

  /// What the newest interim result took.
  [[nodiscard]] std::chrono::steady_clock::duration took() const noexcept { return took_; }
  [[nodiscard]] ResultBacklog results() const noexcept { return {pending_, given_up_, refused_}; }
  /// Waits until all is done: true. Or until `deadline`. What the disk refused is tried once more;
  /// nothing of earlier sessions is begun any more.
  bool drain(Steady::time_point deadline);

 private:
  struct Identified {
    Outcome outcome;
    Steady::time_point began;  ///< once its turn had come
    std::chrono::nanoseconds took{};
  };
  static Identified identify(const Snapshot& snapshot, Share share);
  void publish(const Identified& identified, bool interim, const Log& log);
  void limit_waiting();
  void end_next();
  void make_outcome(SessionEnd& end);
  void write(std::unique_ptr<SessionEnd> end);
  void write_again();
  void go_on_with_earlier();

  const std::shared_ptr<RobotStatus> status_;
  std::atomic<std::chrono::steady_clock::duration> took_{};
  std::atomic<std::uint64_t> pending_{0};
  std::atomic<std::uint64_t> given_up_{0};
  std::atomic<std::uint64_t> refused_{0};  // of the pending ones, by the disk
  std::atomic<bool> draining_{false};
  std::atomic<std::uint64_t> ended_{0};  // sessions whose last result is under way or done
  std::mutex result_mutex_;              // of whoever publishes and writes a result

  std::mutex mutex_;                                   // of the following
  std::deque<std::unique_ptr<SessionEnd>> waiting_;    // for the identification; a job each
  std::deque<std::unique_ptr<SessionEnd>> unwritten_;  // older than those
  std::optional<std::filesystem::path> robot_folder_;  // given since the start
  Steady::time_point retry_at_{};
  Steady::duration retry_after_{};
  bool retrying_ = false;  // or about to

  struct Earlier {
    std::filesystem::path robot_folder;
    RobotSetup setup;
    std::vector<FileHash> inputs;  // that the setup was read from
    Log log;
    bool listed = false;
    std::vector<std::filesystem::path> folders;  // the next one is at the end
    std::filesystem::path folder;                // under way
    std::unique_ptr<SessionReplay> replay;
  };
  std::unique_ptr<Earlier> earlier_;  // of the thread of interim results

  JobThread jobs_{"identification", Share::fair};
  JobThread interim_jobs_{"interim result", Share::low};  // gives those jobs
};

}  // namespace sweepd
