#include "daemon/service/identifier.hpp"

#include <algorithm>
#include <exception>
#include <semaphore>
#include <thread>
#include <utility>

#include "daemon/results/outcome.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

constexpr auto kFirstRetry = 1s;
constexpr auto kLongestResultRetry = 60s;

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
         const std::filesystem::path& see) {
  const std::string text = std::string(which) + "result " +
                           std::string(identify::text(result.status)) +
                           (result.reason.empty() ? "" : ": ") + result.reason +
                           (see.empty() ? "" : "; see " + see.string());
  if (result.status == identify::Status::doubtful)
    log.warning("{}", text);
  else
    log.note("{}", text);
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

void Identifier::finish_earlier(std::filesystem::path robot_folder, RobotSetup setup,
                                std::vector<FileHash> inputs, Log log) {
  auto earlier = std::make_shared<Earlier>();
  earlier->robot_folder = std::move(robot_folder);
  earlier->setup = std::move(setup);
  earlier->inputs = std::move(inputs);
  earlier->log = std::move(log);
  interim_jobs_.submit(
      [this, earlier] {
        earlier_ = std::make_unique<Earlier>(std::move(*earlier));
        go_on_with_earlier();
      },
      false);
}

void Identifier::interim(std::shared_ptr<const Recording> recording, Snapshot snapshot, Log log) {
  auto work = [this, recording = std::move(recording), snapshot = std::move(snapshot),
               before = ended_.load()](const Log& robot) {
    if (ended_ != before) return;
    const auto identified = identify(snapshot, Share::low);
    took_ = std::max<Steady::duration>(identified.took, std::chrono::milliseconds(1));
    const std::lock_guard lock(result_mutex_);
    if (ended_ != before) return;  // the last result is under way, or there already
    publish(identified, true, robot);
    const auto folder = recording->folder();
    if (!folder.empty()) write_interim_result(folder, identified.outcome);
    say(robot, "interim ", identified.outcome.identification,
        folder.empty() ? folder : folder / file_names::kReport);
    took_ = Steady::now() - identified.began;
  };
  interim_jobs_.submit(logged(std::move(log), std::move(work)), true);
}

void Identifier::last(SessionEnd end) {
  ++ended_;
  ++pending_;
  std::size_t jobs = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto before = waiting_.size();
    waiting_.push_back(std::make_unique<SessionEnd>(std::move(end)));
    limit_waiting();
    jobs = waiting_.size() - std::min(before, waiting_.size());
  }
  if (jobs > 0) jobs_.submit([this] { end_next(); }, false);
}

/// With the mutex held.
void Identifier::limit_waiting() {
  std::size_t samples = 0;
  for (const auto* ends : {&unwritten_, &waiting_})
    for (const auto& end : *ends) samples += end->samples();
  while (waiting_.size() + unwritten_.size() > 1 &&
         (samples > kMostSamples || waiting_.size() + unwritten_.size() > kMostWaiting)) {
    auto& ends = unwritten_.empty() ? waiting_ : unwritten_;
    const auto oldest = std::move(ends.front());
    ends.pop_front();
    samples -= oldest->samples();
    --pending_;
    if (oldest->failed_before) --refused_;
    ++given_up_;
    oldest->log.error(
        "the disk of {} takes no results, and others wait: the last result of the session {} is "
        "given up; the next start of sweepd makes it from the recording, as far as there is one",
        oldest->robot_folder.string(), oldest->started);
  }
}

void Identifier::end_next() {
  std::unique_ptr<SessionEnd> end;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return;
    end = std::move(waiting_.front());
    waiting_.pop_front();
  }
  try {
    make_outcome(*end);
    write(std::move(end));
  } catch (const std::exception& error) {
    Log().error("{}", error.what());  // no memory
    --pending_;
  }
}

void Identifier::make_outcome(SessionEnd& end) {
  auto identified = identify(end.snapshot, Share::fair);
  end.recording->wait();
  // A replay of what is not whole would give something else.
  const auto recorded = end.recording->counts();
  if (!recorded.complete()) identified.outcome.source_kind = "live";
  {
    const std::lock_guard lock(result_mutex_);
    publish(identified, false, end.log);
  }
  if (const auto gaps = recorded.gaps(); !gaps.empty()) end.log.warning("{}", gaps);
  if (!end.link->good) end.log.warning("the link is {}", end.link->verdict);
  if (!end.link->bad_end.empty())
    end.log.warning("the stream ended badly: {}; its last cycles are in last_cycles.csv",
                    end.link->bad_end);
  end.outcome = std::move(identified.outcome);
}

void Identifier::write(std::unique_ptr<SessionEnd> end) {
  try {
    const std::lock_guard lock(result_mutex_);
    end->write();
    if (!end->old_result_stays)
      say(end->log,
          end->recording ? "" : "from an earlier recording: ", end->outcome->identification,
          end->has_usable_sweeps() ? end->folder / file_names::kReport : end->folder);
    if (end->failed_before) --refused_;
    --pending_;
  } catch (const std::exception& error) {
    if (!std::exchange(end->failed_before, true)) {
      ++refused_;
      if (!end->old_result_stays) say(end->log, "", end->outcome->identification, {});
      end->log.error("{}; it is tried again until it is written", error.what());
    }
    const std::lock_guard lock(mutex_);
    const auto place = std::find_if(unwritten_.begin(), unwritten_.end(), [&](const auto& other) {
      return other->started > end->started;
    });
    unwritten_.insert(place, std::move(end));
    retry_after_ = std::clamp<Steady::duration>(2 * retry_after_, kFirstRetry, kLongestResultRetry);
    retry_at_ = Steady::now() + retry_after_;
    limit_waiting();
  }
}

void Identifier::write_to(std::filesystem::path robot_folder) {
  const std::lock_guard lock(mutex_);
  robot_folder_ = std::move(robot_folder);
}

void Identifier::try_again(Steady::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    if (retrying_ || unwritten_.empty() || now < retry_at_) return;
    retrying_ = true;
  }
  jobs_.submit([this] { write_again(); }, false);
}

void Identifier::write_again() {
  std::deque<std::unique_ptr<SessionEnd>> ends;
  {
    const std::lock_guard lock(mutex_);
    ends.swap(unwritten_);
    for (auto& end : ends)
      if (robot_folder_ && end->folder.empty()) end->robot_folder = *robot_folder_;
  }
  const auto failures = ends.size();
  for (auto& end : ends) write(std::move(end));
  const std::lock_guard lock(mutex_);
  retrying_ = false;
  if (unwritten_.size() < failures) retry_after_ = {};
}

void Identifier::go_on_with_earlier() {
  if (draining_ || !earlier_) return;
  Earlier& earlier = *earlier_;
  try {
    if (!std::exchange(earlier.listed, true)) {
      earlier.folders = unfinished_sessions(earlier.robot_folder);
      std::reverse(earlier.folders.begin(), earlier.folders.end());
    } else if (!earlier.replay) {
      const auto& folder = earlier.folder = std::move(earlier.folders.back());
      earlier.folders.pop_back();
      FolderLock lock(folder);
      if (lock.held() && !has_trace(folder)) {
        end_without_trace(folder);
        earlier.log.note("{} has no last result, and no trace to make it of: what is there stays",
                         folder.string());
      } else if (lock.held()) {  // else a session is written there just now
        earlier.replay = std::make_unique<SessionReplay>(folder, std::move(lock), earlier.setup);
        earlier.log.note("{} has no last result: it is made from the recording", folder.string());
      }
    } else if (!earlier.replay->step()) {
      auto end = std::exchange(earlier.replay, nullptr)->end(earlier.inputs, earlier.log);
      auto identified = identify(end.snapshot, Share::low);
      {
        const std::lock_guard lock(result_mutex_);
        if (!end.old_result_stays && !status_->result.newest()->newest)
          publish(identified, false, end.log);
      }
      end.outcome = std::move(identified.outcome);
      ++pending_;
      write(std::make_unique<SessionEnd>(std::move(end)));
    }
  } catch (const std::exception& error) {
    earlier.replay.reset();
    earlier.log.warning(
        "no result is made of the recording in {}: {}; the next start tries it again, unless the "
        "folder is moved elsewhere",
        (earlier.folder.empty() ? earlier.robot_folder : earlier.folder).string(), error.what());
  }
  if (earlier.replay || !earlier.folders.empty()) {
    interim_jobs_.submit([this] { go_on_with_earlier(); }, false);
  } else {
    earlier_.reset();
    status_->earlier_finished = true;
  }
}

void Identifier::link(std::shared_ptr<const Recording> recording, LinkFiles link, Log log) {
  auto work = [recording = std::move(recording), link = std::move(link)](const Log& robot) {
    const auto folder = recording->folder();
    if (!folder.empty()) write_link(folder, link);
    robot.note("the link is {}{}", link.verdict,
               folder.empty() ? "" : "; see " + (folder / file_names::kLinkText).string());
  };
  jobs_.submit(logged(std::move(log), std::move(work)), false);
}

bool Identifier::drain(Steady::time_point deadline) {
  draining_ = true;
  try_again(Steady::time_point::max());
  if (!jobs_.drain(deadline)) return false;
  const std::lock_guard lock(mutex_);
  for (const auto& end : unwritten_)
    end->log.error(
        "the last result of the session {} is not written: make room on the disk, or correct the "
        "permissions; the next start of sweepd makes it from the recording, as far as there is "
        "one",
        end->started);
  return true;
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
  identified.began = Steady::now();
  identified.outcome = outcome_of(snapshot);
  identified.took = Steady::now() - identified.began;
  return identified;
}

}  // namespace sweepd
