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

class Turn {
 public:
  Turn() { turns().acquire(); }
  ~Turn() { turns().release(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  static std::counting_semaphore<>& turns() {
    static std::counting_semaphore<> half(std::max(1U, std::thread::hardware_concurrency() / 2));
    return half;
  }
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
  auto work = [this, recording = std::move(recording),
               snapshot = std::move(snapshot)](const Log& robot) {
    const Outcome outcome = identify(snapshot);
    publish(outcome, true, robot);
    const auto folder = recording->folder();
    if (!folder.empty()) write_result(folder, outcome);
    say(robot, "interim ", outcome.identification, folder);
    took_ = std::chrono::steady_clock::now() - began_;
  };
  jobs_.submit(logged(std::move(log), std::move(work)), true);
}

void Identifier::last(std::shared_ptr<const Recording> recording, Snapshot snapshot, RunFacts run,
                      LinkFiles link, Log log) {
  auto work = [this, recording = std::move(recording), snapshot = std::move(snapshot),
               run = std::move(run), link = std::move(link)](const Log& robot) mutable {
    Outcome outcome = identify(snapshot);
    recording->wait();
    run.recording = recording->counts();
    // A replay of what is not whole would give something else.
    if (!run.recording->complete()) outcome.source_kind = "live";
    publish(outcome, false, robot);
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

void Identifier::publish(const Outcome& outcome, bool interim, const Log& log) {
  const auto& result = outcome.identification;
  ResultState state = *status_->result.newest();
  ++state.count[static_cast<std::size_t>(result.status)];
  state.newest = {result.status,
                  interim,
                  log.subject().session,
                  rsi::now(),
                  identified_in_,
                  result.warnings.size(),
                  std::make_shared<const std::string>(result_json(outcome))};
  status_->result.publish(std::move(state));
}

Outcome Identifier::identify(const Snapshot& snapshot) {
  const Turn turn;
  began_ = std::chrono::steady_clock::now();
  Outcome outcome = snapshot.identified();
  identified_in_ = std::chrono::steady_clock::now() - began_;
  return outcome;
}

}  // namespace sweepd
