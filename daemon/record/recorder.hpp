#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/record/record_writer.hpp"
#include "daemon/record/recording.hpp"
#include "daemon/record/recording_files.hpp"
#include "daemon/settings/settings.hpp"
#include "daemon/system/turn_threads.hpp"
#include "rsi/datagram.hpp"

namespace sweepd {

/// Records the sessions of one robot. All work on the growing files is done in turns of the thread
/// of their file system: makes the session's folder, writes, syncs twice a second, goes on in new
/// files, deletes old ones. A disk that stands still thus holds up those who record to it, too.
///
/// begin(), datagram(), line() and end() are one thread's (acquisition). They copy into bounded
/// memory and never wait for the disk; what finds no room is left out as a whole and counted. Of
/// what was recorded, a power failure costs less than a second, a crash of sweepd 0.3 s.
///
/// While the disk has less room than is to be kept free, or refuses, recording pauses: memory takes
/// what it can, and goes to the disk when there is room again, in order. A session that ends while
/// recording is paused loses what waits in memory.
class Recorder {
 public:
  using Steady = std::chrono::steady_clock;

  /// On `disk`, a group of `threads`, until a session's folder is somewhere else. `say` is called
  /// once a change, in the recorder's thread or in one that calls the recorder.
  Recorder(TurnThreads& threads, TurnThreads::Group disk, const RecordingSettings& settings,
           Say say, RecorderOptions options = {});
  /// As stop(), but however long the disk takes.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// A session begins, after the end of the one before.
  std::shared_ptr<const Recording> begin(SessionStart start);
  /// False if there was no room: it is not in the recording.
  bool datagram(const rsi::Datagram& datagram);
  bool line(std::string_view line);
  /// Recording::wait() tells when everything is on the disk.
  void end();

  /// Ends the session under way and returns when all is on the disk: true. A disk that does not
  /// take it until `deadline` is given up: what was lost is said, no Recording is waited for any
  /// longer, and the destructor would wait for that disk. The thread of begin(), or after it.
  bool stop(Steady::time_point deadline);

  /// Other settings from now on. Any thread.
  void reconfigure(const RecordingSettings& settings);

  /// Of this robot from now on. A session for which no folder could be made is recorded there; one
  /// that has a folder stays in it, which is said where its disk takes nothing. Any thread.
  void write_to(std::filesystem::path robot_folder);

  /// Whether the disk has no room or refuses. Any thread.
  [[nodiscard]] bool paused() const { return writer_.paused(); }
  /// Bytes free on that disk when it was last looked at; nothing before. Any thread.
  [[nodiscard]] std::optional<std::uint64_t> disk_free() const { return writer_.disk_free(); }

 private:
  struct Begin {
    std::shared_ptr<Recording> recording;
    SessionStart start;
  };
  struct End {};
  struct Chunk {
    Records records;
    RecordCount count;  // of them
  };
  using Part = std::variant<Begin, Chunk, End>;

  /// Memory in use.
  struct Held {
    std::size_t bytes = 0;
    RecordCount records;
  };

  template <typename Append>
  bool keep(const RecordCount& what, std::size_t bytes, const Append& append);
  /// At the end of the queue. Under the mutex.
  Chunk& next_chunk();
  void say_loss(bool losing);

  TurnThreads::Next turn();
  /// The disk on which it goes on, if it is another one.
  std::optional<TurnThreads::Group> work(const RecordingSettings& settings);
  bool write(Chunk& chunk, const RecordingSettings& settings);
  void release(const Held& held);
  void close();

  const Say say_;
  const std::chrono::milliseconds period_;
  const std::function<TurnThreads::Group(const std::filesystem::path&)> disk_of_;
  RecordWriter writer_;
  std::atomic<bool> given_up_{false};

  // The mutex guards these.
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Part> queue_;
  std::vector<Records> spares_;  // empty, with their memory
  Held held_;                    // in the queue and in the backlog
  RecordingSettings settings_;
  std::deque<std::shared_ptr<Recording>> unfinished_;
  bool reconfigured_ = false;
  std::optional<std::filesystem::path> wanted_folder_;  // the writer does not know it yet
  bool stopping_ = false;
  bool done_ = false;

  // Of the thread that hands over.
  std::filesystem::path robot_folder_;
  std::shared_ptr<Recording> recording_;
  bool with_trace_ = false;
  bool queued_ = false;  // the session found room
  bool losing_ = false;
  RecordCount lost_before_;

  // Of the recorder's thread.
  std::deque<Part> backlog_;
  std::shared_ptr<Recording> current_;

  std::unique_ptr<TurnThreads::Work> turns_;
};

}  // namespace sweepd
