#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "daemon/record/recording.hpp"
#include "daemon/record/recording_files.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/system/disk_room.hpp"
#include "daemon/system/log.hpp"
#include "daemon/system/turn_threads.hpp"

namespace sweepd {

/// Takes a sentence for the log.
using Say = std::function<void(Importance, const std::string& text)>;

struct RecorderOptions {
  /// How often memory goes to the disk.
  std::chrono::milliseconds period{250};
  /// From which rotation, pauses and the rest count.
  std::function<std::chrono::steady_clock::time_point()> now = [] {
    return std::chrono::steady_clock::now();
  };
  /// Of the disk that a folder is on; nothing if it cannot be told. Default: statvfs.
  std::function<std::optional<DiskRoom>(const std::filesystem::path&)> room = {};
  /// Which disk that is, as a group of the threads that record.
  std::function<TurnThreads::Group(const std::filesystem::path&)> disk_of = file_system_of;
  /// Whether old recordings may be deleted by now. Default: always.
  std::function<bool()> may_delete = [] { return true; };
};

struct SessionStart {
  std::filesystem::path robot_folder;  ///< the session's folder is made in it; made if missing
  std::string name;        ///< of that folder; "-2" and so on is added where it is taken
  bool trace = true;       ///< datagrams are recorded
  std::string csv_header;  ///< of the samples, without an end of line
  /// That folder is to be on this one; nothing: on that of the session before.
  std::optional<TurnThreads::Group> disk = {};
  /// In the recorder's thread, once the folder is made.
  std::function<void(const std::filesystem::path& folder)> on_folder = {};
  /// In that thread, once recording pauses, for each such folder: the disk may take nothing then.
  std::function<void(const std::filesystem::path& folder)> on_pause = {};
  /// In that thread, for a folder in which the session goes on after somebody deleted, moved or cut
  /// what was recorded before.
  std::function<void(const std::filesystem::path& folder)> on_loss = {};
};

/// The disk side of the recorder: the files of one session after the other, when recording pauses
/// and goes on, and which old recordings go. One thread but where said. Waits for the disk; never
/// throws.
class RecordWriter {
 public:
  using Steady = std::chrono::steady_clock;

  RecordWriter(Say say, RecorderOptions options);

  void open(std::shared_ptr<Recording> recording, SessionStart start);
  /// As Recorder::write_to().
  void write_to(const std::filesystem::path& robot_folder);
  /// Takes what it wrote out of `records`. False if something is left: recording is paused.
  bool write(Records& records, const RecordingSettings& settings);
  /// Everything that waited is written: a pause is over.
  void resume();
  /// What was written is synced once it is a period old, and what is too old or too much deleted.
  void tidy(const RecordingSettings& settings);
  /// At the next tidy(), whenever the last one was.
  void tidy_soon() { tidied_at_.reset(); }
  /// The next write() tries the disk even if it has just refused.
  void try_again();
  void close();

  [[nodiscard]] bool session_open() const { return session_ != nullptr; }

  // Any thread:
  [[nodiscard]] bool paused() const { return paused_; }
  /// Bytes free on the disk when it was last looked at; nothing before.
  [[nodiscard]] std::optional<std::uint64_t> disk_free() const {
    const auto free = free_.load(std::memory_order_relaxed);
    return free == kUnknown ? std::nullopt : std::optional(free);
  }
  /// These are not in the recording. Returns why.
  Missing lose(Recording& recording, const RecordCount& records);

 private:
  struct Session {
    std::shared_ptr<Recording> recording;
    SessionStart start;
    std::optional<RecordingFiles> files;  // once there is a folder
    // In folders that were deleted.
    RecordCount records_before;
    std::uint64_t files_before = 0;
    std::uint64_t bytes_before = 0;
  };

  void make_folder();
  void look_for_folder(const std::string& what_then);
  [[nodiscard]] bool has_room(const std::filesystem::path& folder,
                              const RecordingSettings& settings, Steady::time_point now);
  /// Between sessions, too, a disk that was full has room again, and is said to.
  void look_at_idle_disk(const RecordingSettings& settings, Steady::time_point now);
  void check_room(const RecordingSettings& settings, Steady::time_point now);
  void pause(const std::string& why, bool for_room);
  void tell_pause();
  void sync();
  void delete_old(const RecordingSettings& settings);
  void report() const;
  [[nodiscard]] RecordCount lost() const { return {lost_datagrams_, lost_samples_}; }

  static constexpr auto kUnknown = ~std::uint64_t{0};

  const Say say_;
  RecorderOptions options_;
  std::atomic<bool> paused_{false};
  std::atomic<std::uint64_t> free_{kUnknown};
  std::atomic<std::uint64_t> lost_datagrams_{0}, lost_samples_{0};  // of all sessions

  std::filesystem::path robot_folder_;  // of the last session
  std::unique_ptr<Session> session_;
  std::optional<DiskRoom> room_;
  std::optional<Steady::time_point> room_checked_;
  bool for_room_ = false;  // why it is paused
  Steady::time_point retry_at_;
  Steady::duration retry_after_{};
  std::optional<Steady::time_point> resumed_at_;
  RecordCount lost_before_pause_;
  std::optional<Steady::time_point> unsynced_since_;
  std::optional<Steady::time_point> tidied_at_;
  std::string retention_trouble_;
};

}  // namespace sweepd
