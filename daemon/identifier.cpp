#include "daemon/identifier.hpp"

#include <algorithm>
#include <exception>
#include <semaphore>
#include <thread>
#include <utility>

#include "daemon/atomic_file.hpp"
#include "daemon/result_files.hpp"
#include "daemon/result_json.hpp"

namespace sweepd {
namespace {

/// Half of the processors for each share, so that what is waited for does not wait for the other.
class Turn {
 public:
  explicit Turn(Share share) : turns_(turns(share)) { turns_.acquire(); }
  ~Turn() { turns_.release(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  using Turns = std::counting_semaphore<>;
  static Turns& turns(Share share) {
    static const auto half = std::max(1U, std::thread::hardware_concurrency() / 2);
    static Turns fair(half);
    static Turns low(half);
    return share == Share::fair ? fair : low;
  }

  Turns& turns_;
};

void say(const Log& log, const char* which, const identify::Identification& result,
         const std::filesystem::path& folder) {
  log.note("{}result {}{}{}{}", which, identify::text(result.status),
           result.reason.empty() ? "" : ": ", result.reason,
           folder.empty() ? "" : "; see " + (folder / "report.txt").string());
}

/// What a job does, with its exceptions logged.
template <typename Work>
auto logged(Log log, Work work) {
  return [log = std::move(log), work = std::move(work)]() mutable {
    try {
      work(log);
    } catch (const std::exception& error) {
      log.error("{}", error.what());
    }
  };
}

}  // namespace

void Identifier::interim(std::shared_ptr<const Recording> recording, Snapshot snapshot, Log log) {
  auto work = [this, recording = std::move(recording), snapshot = std::move(snapshot),
               before = ended_.load()](const Log& robot) {
    if (ended_ != before) return;
    const auto identified = identify(snapshot, Share::low);
    const std::lock_guard lock(mutex_);
    if (ended_ != before) return;  // the last result is under way, or there already
    publish(identified, true, robot);
    const auto folder = recording->folder();
    if (!folder.empty()) write_result(folder, identified.outcome);
    say(robot, "interim ", identified.outcome.identification, folder);
    took_ = std::chrono::steady_clock::now() - identified.began;
  };
  interim_jobs_.submit(logged(std::move(log), std::move(work)), true);
}

void Identifier::last(std::shared_ptr<const Recording> recording, Snapshot snapshot, RunFacts run,
                      LinkFiles link, Log log) {
  ++ended_;
  auto work = [this, recording = std::move(recording), snapshot = std::move(snapshot),
               run = std::move(run), link = std::move(link)](const Log& robot) mutable {
    auto identified = identify(snapshot, Share::fair);
    Outcome& outcome = identified.outcome;
    recording->wait();
    run.recording = recording->counts();
    // A replay of what is not whole would give something else.
    if (!run.recording->complete()) outcome.source_kind = "live";
    const std::lock_guard lock(mutex_);
    publish(identified, false, robot);
    run.folder = recording->folder();
    if (!link.good) robot.warning("the link is {}", link.verdict);
    if (!link.bad_end.empty())
      robot.warning("the stream ended badly: {}{}", link.bad_end,
                    run.folder.empty() ? "" : "; its last cycles are in last_cycles.csv");
    if (!run.folder.empty()) {
      write_result(run.folder, outcome);
      write_link(run.folder, link);
      write_atomically(run.folder / "run.json", run_json(run));
    }
    say(robot, "", outcome.identification, run.folder);
  };
  jobs_.submit(logged(std::move(log), std::move(work)), false);
}

void Identifier::link(std::shared_ptr<const Recording> recording, LinkFiles link, Log log) {
  auto work = [recording = std::move(recording), link = std::move(link)](const Log& robot) {
    const auto folder = recording->folder();
    if (!folder.empty()) write_link(folder, link);
    robot.note("the link is {}{}", link.verdict,
               folder.empty() ? "" : "; see " + (folder / "link.txt").string());
  };
  jobs_.submit(logged(std::move(log), std::move(work)), false);
}

void Identifier::publish(const Identified& identified, bool interim, const Log& log) {
  const auto& result = identified.outcome.identification;
  ResultState state = *status_->result.newest();
  ++state.count[static_cast<std::size_t>(result.status)];
  state.newest = {result.status,
                  interim,
                  log.subject().session,
                  rsi::now(),
                  identified.took,
                  result.warnings.size(),
                  std::make_shared<const std::string>(result_json(identified.outcome))};
  status_->result.publish(std::move(state));
}

Identifier::Identified Identifier::identify(const Snapshot& snapshot, Share share) {
  const Turn turn(share);
  Identified identified;
  identified.began = std::chrono::steady_clock::now();
  identified.outcome = snapshot.identified();
  identified.took = std::chrono::steady_clock::now() - identified.began;
  return identified;
}

}  // namespace sweepd
