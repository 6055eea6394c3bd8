#include "daemon/record/recording.hpp"

#include <utility>

#include "rsi/counted.hpp"

namespace sweepd {

std::string text(const RecordCount& count) {
  return rsi::counted(count.datagrams, "datagram") + " and " +
         rsi::counted(count.samples, "sample");
}

std::filesystem::path Recording::folder() const {
  const std::lock_guard lock(mutex_);
  return folder_;
}

std::string Recording::Counts::gaps() const {
  std::string missing;
  const auto add = [&missing](bool any, const std::string& what) {
    if (any) missing += (missing.empty() ? "" : ", ") + what;
  };
  add(disk != RecordCount{}, text(disk) + " as the disk had no room or refused");
  add(memory_full != RecordCount{}, text(memory_full) + " as the disk was too slow");
  add(deleted != RecordCount{},
      text(deleted) + " with a folder or file that somebody deleted, moved or cut");
  add(files_deleted > 0,
      rsi::counted(files_deleted, "file") + " deleted as keep_bytes and keep_days say");
  if (pauses == 0 && missing.empty()) return {};
  return "the recording of this session " +
         (pauses > 0 ? "paused " + rsi::counted(pauses, "time") + ", and " : "") +
         (missing.empty() ? "lacks nothing" : "lacks " + missing);
}

Recording::Counts& Recording::Counts::operator+=(const Counts& other) {
  recorded += other.recorded;
  memory_full += other.memory_full;
  disk += other.disk;
  files += other.files;
  bytes += other.bytes;
  pauses += other.pauses;
  folders_deleted += other.folders_deleted;
  deleted += other.deleted;
  files_deleted += other.files_deleted;
  return *this;
}

Recording::Counts Recording::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void Recording::wait() const {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return finished_; });
}

bool Recording::finished() const {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void Recording::made(const std::filesystem::path& folder) {
  FolderLock folder_lock(folder);
  const std::lock_guard lock(mutex_);
  folder_ = folder;
  std::swap(lock_, folder_lock);
}

void Recording::written(const RecordCount& records, std::uint64_t files, std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  counts_.recorded = records;
  counts_.files = files;
  counts_.bytes = bytes;
}

void Recording::paused() {
  const std::lock_guard lock(mutex_);
  ++counts_.pauses;
}

void Recording::deleted(const RecordCount& records) {
  const std::lock_guard lock(mutex_);
  ++counts_.folders_deleted;
  counts_.deleted += records;
}

void Recording::outlived(std::uint64_t files) {
  const std::lock_guard lock(mutex_);
  counts_.files_deleted += files;
}

void Recording::lost(Missing reason, const RecordCount& records) {
  const std::lock_guard lock(mutex_);
  (reason == Missing::disk ? counts_.disk : counts_.memory_full) += records;
}

void Recording::finish() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  ended_.notify_all();
}

}  // namespace sweepd
