#include "daemon/record/recorder.hpp"

#include <algorithm>
#include <utility>

#include "rsi/capture/capture_writer.hpp"
#include "rsi/capture/packet.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

/// Bytes that are handed over together.
constexpr std::size_t kChunk = 64 << 10;
/// Chunks whose memory waits to be used again: what comes between three turns at a cycle of 4 ms.
constexpr std::size_t kSpares = 4;
/// Of memory for a session's begin and end, with its names.
constexpr std::size_t kSessionBytes = 1024;
constexpr auto kIdle = 60s;

}  // namespace

Recorder::Recorder(TurnThreads& threads, TurnThreads::Group disk, const RecordingSettings& settings,
                   Say say, RecorderOptions options)
    : say_(std::move(say)),
      period_(options.period),
      disk_of_(options.disk_of),
      writer_(say_, std::move(options)),
      settings_(settings),
      turns_(threads.begin(disk, [this] { return turn(); })) {}

Recorder::~Recorder() {
  stop(Steady::time_point::max());
}

std::shared_ptr<const Recording> Recorder::begin(SessionStart start) {
  end();
  recording_ = std::make_shared<Recording>();
  robot_folder_ = start.robot_folder;
  with_trace_ = start.trace;
  {
    const std::lock_guard lock(mutex_);
    queued_ = held_.bytes + kSessionBytes <= settings_.memory_bytes;
    if (queued_) {
      held_.bytes += kSessionBytes;
      unfinished_.push_back(recording_);
      queue_.emplace_back(Begin{recording_, std::move(start)});
    }
  }
  turns_->wake();
  return recording_;
}

bool Recorder::datagram(const rsi::Datagram& datagram) {
  if (!with_trace_) return true;
  rsi::Datagram fitting = datagram;
  fitting.payload = datagram.payload.substr(0, rsi::max_udp_payload);
  return keep({1, 0}, rsi::capture_record_size(fitting),
              [&fitting](Records& records) { rsi::append_capture_record(fitting, records.trace); });
}

bool Recorder::line(std::string_view line) {
  return keep({0, 1}, line.size() + 1, [line](Records& records) {
    records.samples += line;
    records.samples += '\n';
  });
}

template <typename Append>
bool Recorder::keep(const RecordCount& what, std::size_t bytes, const Append& append) {
  if (!recording_) return false;
  bool fits = false;
  bool half_full = false;
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    fits = queued_ && held_.bytes + bytes <= settings_.memory_bytes;
    if (fits) {
      auto* chunk = queue_.empty() ? nullptr : std::get_if<Chunk>(&queue_.back());
      if (chunk == nullptr || chunk->records.bytes() + bytes > kChunk) chunk = &next_chunk();
      append(chunk->records);
      chunk->count += what;
      const bool was_half_full = held_.bytes > settings_.memory_bytes / 2;
      held_.bytes += bytes;
      held_.records += what;
      half_full = held_.bytes > settings_.memory_bytes / 2;
      wake = half_full && !was_half_full;
    }
  }
  if (wake) turns_->wake();
  if (fits) {
    if (losing_ && !half_full) say_loss(false);
    return true;
  }
  if (!losing_) lost_before_ = recording_->counts().memory_full;
  const auto reason = writer_.lose(*recording_, what);
  if (reason == Missing::memory_full && !losing_) say_loss(true);
  return false;
}

/// New memory costs more than all else here: the system sets it to zero, page by page.
Recorder::Chunk& Recorder::next_chunk() {
  auto& chunk = std::get<Chunk>(queue_.emplace_back(Chunk{}));
  if (!spares_.empty()) {
    chunk.records = std::move(spares_.back());
    spares_.pop_back();
  }
  chunk.records.trace.reserve(kChunk);
  return chunk;
}

void Recorder::say_loss(bool losing) {
  losing_ = losing;
  if (losing)
    say_(Importance::error,
         "memory for the recording is full, as the disk of " + robot_folder_.string() +
             " is too slow: robots are answered, but not all of it is recorded: see what keeps "
             "the disk, or raise memory_bytes");
  else
    say_(Importance::warning, text(recording_->counts().memory_full - lost_before_) +
                                  " were not recorded, as the disk of " + robot_folder_.string() +
                                  " was too slow");
}

void Recorder::end() {
  if (!recording_) return;
  if (losing_) say_loss(false);
  if (queued_) {
    const std::lock_guard lock(mutex_);
    queue_.emplace_back(End{});
  } else {
    recording_->finish();
  }
  turns_->wake();
  recording_.reset();
}

bool Recorder::stop(Steady::time_point deadline) {
  end();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  turns_->wake();
  Held held;
  std::deque<std::shared_ptr<Recording>> unfinished;
  {
    std::unique_lock lock(mutex_);
    if (changed_.wait_until(lock, deadline, [this] { return done_; })) return true;
    if (given_up_.exchange(true)) return false;
    held = held_;
    unfinished = unfinished_;
  }
  say_(Importance::error, "the disk of " + robot_folder_.string() +
                              " does not take the recording: it is given up, and " +
                              text(held.records) + " with it: see what is wrong with the disk");
  if (!unfinished.empty()) unfinished.back()->lost(Missing::disk, held.records);
  for (const auto& recording : unfinished) recording->finish();
  return false;
}

void Recorder::reconfigure(const RecordingSettings& settings) {
  {
    const std::lock_guard lock(mutex_);
    settings_ = settings;
    reconfigured_ = true;
  }
  turns_->wake();
}

void Recorder::write_to(std::filesystem::path robot_folder) {
  {
    const std::lock_guard lock(mutex_);
    wanted_folder_ = std::move(robot_folder);
  }
  turns_->wake();
}

TurnThreads::Next Recorder::turn() {
  std::unique_lock lock(mutex_);
  if (done_) return {Steady::time_point::max()};
  const bool last = stopping_;
  for (Part& part : queue_) backlog_.push_back(std::move(part));
  queue_.clear();
  if (std::exchange(reconfigured_, false)) writer_.tidy_soon();
  const auto settings = settings_;
  const auto wanted_folder = std::exchange(wanted_folder_, std::nullopt);
  lock.unlock();
  if (wanted_folder) writer_.write_to(*wanted_folder);
  const auto other_disk = work(settings);
  if (other_disk) return {Steady::now(), other_disk};
  lock.lock();
  if (last) {
    done_ = true;
    changed_.notify_all();
  }
  const bool busy = writer_.session_open() || writer_.paused() || !backlog_.empty();
  return {Steady::now() + (busy ? period_ : kIdle)};
}

std::optional<TurnThreads::Group> Recorder::work(const RecordingSettings& settings) {
  const auto ends = [this] {
    return std::any_of(backlog_.begin(), backlog_.end(),
                       [](const Part& part) { return std::holds_alternative<End>(part); });
  };
  if (ends()) writer_.try_again();  // the last chance
  bool written = false;
  for (; !backlog_.empty(); backlog_.pop_front()) {
    Part& part = backlog_.front();
    if (auto* const begin = std::get_if<Begin>(&part)) {
      const auto disk = std::exchange(begin->start.disk, std::nullopt);
      if (disk && *disk != turns_->group()) return disk;
      current_ = begin->recording;
      writer_.open(begin->recording, std::move(begin->start));
      release({kSessionBytes, {}});
      const auto folder = current_->folder();
      if (folder.empty()) continue;
      if (const auto made_on = disk_of_(folder); made_on != turns_->group()) {
        backlog_.pop_front();
        return made_on;
      }
    } else if (auto* const chunk = std::get_if<Chunk>(&part)) {
      written = write(*chunk, settings);
      if (written) continue;
      if (!ends()) break;
      if (!given_up_) writer_.lose(*current_, chunk->count);  // else it was counted then
      release({chunk->records.bytes(), chunk->count});
    } else {
      if (written) writer_.resume();
      close();
    }
  }
  if (written && backlog_.empty()) writer_.resume();
  writer_.tidy(settings);
  return std::nullopt;
}

bool Recorder::write(Chunk& chunk, const RecordingSettings& settings) {
  if (given_up_) return false;
  auto& [records, count] = chunk;
  const Held before{records.bytes(), count};
  const bool all = writer_.write(records, settings);
  count = records.count();
  release({before.bytes - records.bytes(), before.records - count});
  if (!all) return false;
  const std::lock_guard lock(mutex_);
  if (spares_.size() < kSpares) spares_.push_back(std::move(records));
  return true;
}

void Recorder::release(const Held& held) {
  const std::lock_guard lock(mutex_);
  held_.bytes -= held.bytes;
  held_.records = held_.records - held.records;
}

void Recorder::close() {
  writer_.close();
  current_.reset();
  const std::lock_guard lock(mutex_);
  unfinished_.pop_front();
  spares_.clear();
}

}  // namespace sweepd
