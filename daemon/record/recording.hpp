#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>

#include "daemon/record/session_folder.hpp"

namespace sweepd {

/// Datagrams of a trace and rows of samples.
struct RecordCount {
  std::uint64_t datagrams = 0;
  std::uint64_t samples = 0;

  RecordCount& operator+=(const RecordCount& other) {
    datagrams += other.datagrams;
    samples += other.samples;
    return *this;
  }
  friend RecordCount operator-(const RecordCount& a, const RecordCount& b) {
    return {a.datagrams - b.datagrams, a.samples - b.samples};
  }
  bool operator==(const RecordCount&) const = default;
};
/// "12 datagrams and 6 samples".
[[nodiscard]] std::string text(const RecordCount& count);

/// Why something is not in the recording.
enum class Missing {
  memory_full,  ///< the disk was slow or stood still, and the memory set aside was full
  disk,         ///< the disk had no room, or refused
};

/// How the recording of one session goes, and went. Any thread.
class Recording {
 public:
  struct Counts {
    RecordCount recorded;
    RecordCount memory_full;  ///< not recorded, by reason
    RecordCount disk;
    std::uint64_t files = 0;
    std::uint64_t bytes = 0;
    std::uint64_t pauses = 0;  ///< times that the disk had no room or refused
    /// Times that somebody deleted, moved or cut the folder or a file in it while it was written,
    /// and what of `recorded` went with it.
    std::uint64_t folders_deleted = 0;
    RecordCount deleted;
    /// Files of this session that went while it was written, as keep_bytes and keep_days say.
    std::uint64_t files_deleted = 0;

    [[nodiscard]] bool complete() const {
      return memory_full == RecordCount{} && disk == RecordCount{} && folders_deleted == 0 &&
             files_deleted == 0;
    }
    /// A sentence on its pauses and on what is not in it; empty if there is nothing to say.
    [[nodiscard]] std::string gaps() const;
    Counts& operator+=(const Counts& other);
  };

  /// The session's folder; empty until it is made.
  [[nodiscard]] std::filesystem::path folder() const;
  [[nodiscard]] Counts counts() const;

  /// Waits until all that can be recorded is on the disk.
  void wait() const;
  /// Whether it is: the counts are the last ones then.
  [[nodiscard]] bool finished() const;

  // The recorder's own:
  void made(const std::filesystem::path& folder);
  void written(const RecordCount& records, std::uint64_t files, std::uint64_t bytes);
  void paused();
  void deleted(const RecordCount& records);
  void outlived(std::uint64_t files);
  void lost(Missing reason, const RecordCount& records);
  void finish();

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable ended_;
  std::filesystem::path folder_;
  FolderLock lock_;  // as long as anybody knows of this
  Counts counts_;
  bool finished_ = false;
};

}  // namespace sweepd
