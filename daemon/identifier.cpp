#include "daemon/identifier.hpp"

#include <algorithm>
#include <exception>
#include <semaphore>
#include <thread>
#include <utility>

#include <spdlog/spdlog.h>

#include "daemon/atomic_file.hpp"
#include "daemon/result_files.hpp"

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

void say(const std::string& robot, const char* which, const identify::Identification& result) {
  spdlog::info("{}: {}result {}{}{}", robot, which, identify::text(result.status),
               result.reason.empty() ? "" : ": ", result.reason);
}

/// What a job does, with its exceptions logged.
template <typename Work>
auto logged(std::string robot, Work work) {
  return [robot = std::move(robot), work = std::move(work)]() mutable {
    try {
      work(robot);
    } catch (const std::exception& error) {
      spdlog::error("{}: {}", robot, error.what());
    }
  };
}

}  // namespace

void Identifier::interim(std::shared_ptr<const Recording> recording, Snapshot snapshot,
                         std::string robot) {
  jobs_.submit(logged(std::move(robot),
                      [this, recording = std::move(recording),
                       snapshot = std::move(snapshot)](const std::string& name) {
                        const Outcome outcome = identify(snapshot);
                        const auto folder = recording->folder();
                        if (!folder.empty()) write_result(folder, outcome);
                        say(name, "interim ", outcome.identification);
                        took_ = std::chrono::steady_clock::now() - began_;
                      }),
               true);
}

void Identifier::last(std::shared_ptr<const Recording> recording, Snapshot snapshot, RunFacts run,
                      LinkFiles link) {
  auto work = [this, recording = std::move(recording), snapshot = std::move(snapshot), run,
               link = std::move(link)](const std::string& name) mutable {
    Outcome outcome = identify(snapshot);
    recording->wait();
    run.recording = recording->counts();
    // A replay of what is not whole would give something else.
    if (!run.recording->complete()) outcome.source_kind = "live";
    run.folder = recording->folder();
    if (!link.good) spdlog::warn("{}: the link is {}", name, link.verdict);
    if (!link.bad_end.empty())
      spdlog::warn("{}: the stream ended badly: {}{}", name, link.bad_end,
                   run.folder.empty() ? "" : "; its last cycles are in last_cycles.csv");
    if (!run.folder.empty()) {
      write_result(run.folder, outcome);
      write_link(run.folder, link);
      write_atomically(run.folder / "run.json", run_json(run));
    }
    say(name, "", outcome.identification);
  };
  jobs_.submit(logged(run.robot, std::move(work)), false);
}

void Identifier::link(std::shared_ptr<const Recording> recording, std::string robot,
                      LinkFiles link) {
  auto work = [recording = std::move(recording), link = std::move(link)](const std::string& name) {
    const auto folder = recording->folder();
    if (!folder.empty()) write_link(folder, link);
    spdlog::info("{}: the link is {}{}", name, link.verdict,
                 folder.empty() ? "" : "; see " + (folder / "link.txt").string());
  };
  jobs_.submit(logged(std::move(robot), std::move(work)), false);
}

Outcome Identifier::identify(const Snapshot& snapshot) {
  const Turn turn;
  began_ = std::chrono::steady_clock::now();
  return snapshot.identified();
}

}  // namespace sweepd
