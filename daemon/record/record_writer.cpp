#include "daemon/record/record_writer.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/record/retention.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/numbers.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;

constexpr auto kBetweenRoomChecks = 1s;
constexpr auto kLongestRetry = 60s;
constexpr auto kBetweenDeletions = 60s;

/// Beyond what is to be kept free, before a pause ends: else it would begin again at once.
std::uint64_t margin(std::uint64_t keep_free, std::uint64_t total) {
  return std::min(std::max(keep_free / 8, std::uint64_t{16} << 20), total / 20);
}

std::string size_text(std::uint64_t bytes) {
  return fixed(static_cast<double>(bytes) / 1e6, 1) + " MB";
}

}  // namespace

RecordWriter::RecordWriter(Say say, RecorderOptions options)
    : say_(std::move(say)), options_(std::move(options)) {
  if (!options_.room) options_.room = disk_room;
}

void RecordWriter::open(std::shared_ptr<Recording> recording, SessionStart start) {
  session_ = std::make_unique<Session>();
  session_->recording = std::move(recording);
  session_->start = std::move(start);
  robot_folder_ = session_->start.robot_folder;
  room_checked_.reset();
  tidy_soon();
  try {
    make_folder();
  } catch (const std::exception& error) {
    pause(error.what(), false);
  }
}

void RecordWriter::write_to(const std::filesystem::path& robot_folder) {
  if (!session_ || !paused_ || robot_folder == robot_folder_) return;
  if (!session_->files) {
    robot_folder_ = robot_folder;
    try_again();
    return;
  }
  say_(Importance::warning, "the session under way stays in " + session_->files->folder().string() +
                                ", where its recording began: make room there, or see what is "
                                "wrong with that disk; the next session goes to " +
                                robot_folder.string());
}

bool RecordWriter::write(Records& records, const RecordingSettings& settings) {
  const auto now = options_.now();
  if (paused_ && now < retry_at_) return false;
  const auto bytes = records.bytes();
  try {
    look_for_folder("; recording goes on in a new folder");
    make_folder();
    check_room(settings, now);
    if (session_->files->write(records, {settings.rotate_bytes, settings.rotate}, now)) tidy_soon();
  } catch (const NoRoom& full) {
    pause(full.what(), true);
  } catch (const std::exception& error) {
    pause(error.what(), false);
  }
  if (records.bytes() < bytes && !unsynced_since_) unsynced_since_ = now;
  return records.bytes() == 0;
}

void RecordWriter::resume() {
  if (!paused_) return;
  resumed_at_ = options_.now();
  const auto missing = lost() - lost_before_pause_;
  paused_ = false;
  say_(Importance::warning, "recording goes on, the disk of " + robot_folder_.string() +
                                " has room again: " + text(missing) +
                                " were not recorded meanwhile");
}

void RecordWriter::tidy(const RecordingSettings& settings) {
  const auto now = options_.now();
  if (unsynced_since_ && now - *unsynced_since_ >= options_.period) sync();
  if (session_)
    report();
  else
    look_at_idle_disk(settings, now);
  if (tidied_at_ && now - *tidied_at_ < kBetweenDeletions) return;
  tidied_at_ = now;
  delete_old(settings);
}

void RecordWriter::try_again() {
  retry_at_ = options_.now();
}

void RecordWriter::close() {
  report();
  look_for_folder({});
  sync();
  if (session_->files) sync_folder(session_->files->folder());
  session_->recording->finish();
  session_.reset();
}

Missing RecordWriter::lose(Recording& recording, const RecordCount& records) {
  const auto reason = paused_ ? Missing::disk : Missing::memory_full;
  lost_datagrams_ += records.datagrams;
  lost_samples_ += records.samples;
  recording.lost(reason, records);
  return reason;
}

void RecordWriter::make_folder() {
  if (session_->files) return;
  const auto& start = session_->start;
  const auto folder = make_session_folder(robot_folder_, start.name);
  session_->files.emplace(folder, start.trace, start.csv_header);
  session_->recording->made(folder);
  if (start.on_folder) start.on_folder(folder);
  if (session_->files_before > 0 && start.on_loss) start.on_loss(folder);
  if (paused_) tell_pause();
}

void RecordWriter::look_for_folder(const std::string& what_then) {
  if (!session_->files || session_->files->in_place()) return;
  const RecordingFiles& files = *session_->files;
  say_(Importance::error, "somebody deleted or moved " + files.folder().string() +
                              " or a file in it, or cut such a file, while it was written: " +
                              text(files.recorded()) + " went with it" + what_then);
  session_->recording->deleted(files.recorded());
  session_->records_before += files.recorded();
  session_->files_before += files.files();
  session_->bytes_before += files.bytes();
  session_->files.reset();
  unsynced_since_.reset();
}

bool RecordWriter::has_room(const std::filesystem::path& folder, const RecordingSettings& settings,
                            Steady::time_point now) {
  if (!room_checked_ || now - *room_checked_ >= kBetweenRoomChecks) {
    room_ = options_.room(folder);
    room_checked_ = now;
    free_ = room_ ? room_->free : kUnknown;
  }
  const auto keep = settings.keep_free_bytes;
  return !room_ || room_->free >= keep + (paused_ && for_room_ ? margin(keep, room_->total) : 0);
}

void RecordWriter::check_room(const RecordingSettings& settings, Steady::time_point now) {
  const auto& folder = session_->files->folder();
  if (!has_room(folder, settings, now))
    throw NoRoom(
        fmt::format("the disk of {} has {} free, and keep_free_bytes is {}: make room, or lower "
                    "keep_free_bytes",
                    folder.string(), size_text(room_->free), settings.keep_free_bytes));
}

void RecordWriter::look_at_idle_disk(const RecordingSettings& settings, Steady::time_point now) {
  if (!robot_folder_.empty() && has_room(robot_folder_, settings, now) && for_room_) resume();
}

void RecordWriter::pause(const std::string& why, bool for_room) {
  const auto now = options_.now();
  const bool news = !paused_;
  for_room_ = for_room;
  if (news) {
    // A disk that has room for a moment only is asked, and spoken of, less and less often.
    const bool again = resumed_at_ && now - *resumed_at_ < kLongestRetry;
    retry_after_ =
        again ? std::min<Steady::duration>(2 * retry_after_, kLongestRetry) : kBetweenRoomChecks;
    lost_before_pause_ = lost();
  }
  retry_at_ = now + retry_after_;
  if (!news) return;
  session_->recording->paused();
  tell_pause();
  paused_ = true;
  say_(Importance::error, "recording pauses, replies go on: " + why);
}

void RecordWriter::tell_pause() {
  if (session_->files && session_->start.on_pause)
    session_->start.on_pause(session_->files->folder());
}

void RecordWriter::sync() {
  if (!std::exchange(unsynced_since_, std::nullopt) || !session_) return;
  try {
    session_->files->sync();
  } catch (const std::exception& error) {
    pause(error.what(), false);
  }
}

void RecordWriter::delete_old(const RecordingSettings& settings) {
  if (robot_folder_.empty() || !options_.may_delete()) return;
  InUse in_use;
  if (session_ && session_->files)
    in_use = {session_->files->folder().filename().string(), session_->files->part()};
  const auto deleted =
      delete_old_recordings(robot_folder_, settings, std::chrono::system_clock::now(), in_use);
  if (deleted.of_session > 0) session_->recording->outlived(deleted.of_session);
  if (deleted.files > 0)
    say_(Importance::note,
         "deleted the oldest recordings in " + robot_folder_.string() +
             ", as keep_days and keep_bytes say: " + rsi::counted(deleted.files, "file") + ", " +
             size_text(deleted.bytes));
  if (!deleted.trouble.empty() && deleted.trouble != retention_trouble_)
    say_(Importance::warning, "old recordings in " + robot_folder_.string() +
                                  " stay: " + deleted.trouble + ": check its permissions");
  retention_trouble_ = deleted.trouble;
}

void RecordWriter::report() const {
  if (!session_->files) return;
  auto records = session_->records_before;
  records += session_->files->recorded();
  session_->recording->written(records, session_->files_before + session_->files->files(),
                               session_->bytes_before + session_->files->bytes());
}

}  // namespace sweepd
