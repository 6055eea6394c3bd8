#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "daemon/points/device_recording.hpp"
#include "daemon/record/recording.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/service/link_watch.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/system/file_hash.hpp"
#include "daemon/system/log.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/conversation.hpp"

namespace sweepd {

/// A session that is over, until all that it leaves is written. One thread at a time.
struct SessionEnd {
  std::filesystem::path robot_folder;
  std::string started;                         ///< as its folder is named
  std::shared_ptr<const Recording> recording;  ///< null: all is in `folder` already
  std::filesystem::path folder;                ///< where it goes; empty: not known yet
  Snapshot snapshot;
  std::optional<LinkFiles> link;
  /// What run.json will be, with "ended".
  std::function<std::string(const std::filesystem::path& folder)> run;
  Log log;
  FolderLock lock = {};

  std::optional<Outcome> outcome = {};  ///< once it is identified
  std::set<std::string> written = {};
  bool link_written = false;
  bool old_result_stays = false;  ///< that one knew more
  bool failed_before = false;     ///< to be written

  /// Samples that are in memory for it.
  [[nodiscard]] std::size_t samples() const;
  /// Without a sweep that can be used there is little to write: no DH table, no report.
  [[nodiscard]] bool has_usable_sweeps() const;
  /// Writes what is not yet written: what matters most first, run.json last. Whatever can be
  /// written is, then std::runtime_error says what could not.
  void write();
};

/// Reads the recording of a session whose last result was never written, for its end. One thread.
class SessionReplay : private StreamSink {
 public:
  /// `lock`: of the folder, held. Throws rsi::CaptureError where there is nothing to read.
  SessionReplay(std::filesystem::path folder, FolderLock lock, const RobotSetup& setup);

  /// Reads on for some tenth of a second. False once all is read.
  bool step();
  /// Then: the end of the session, to be identified.
  /// `inputs`: the files that the setup was read from.
  [[nodiscard]] SessionEnd end(std::vector<FileHash> inputs, Log log);

 private:
  void sample(const identify::Sample& sample, std::string_view) override { device_.sample(sample); }
  /// As far as the recording tells. Nothing where it has gaps, or where more is written already.
  [[nodiscard]] std::optional<LinkFiles> link() const;

  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::filesystem::path> traces_;  // the next one is at the end
  rsi::Conversation conversation_;
  DeviceRecording device_;
  std::unique_ptr<Session> session_;
  std::optional<rsi::CaptureReader> trace_;
  rsi::Timestamp newest_{};
  std::vector<std::string> damage_;  // sentences
  bool has_gaps_ = false;            // before its end
};

/// Whether a session's folder has a trace that holds anything.
[[nodiscard]] bool has_trace(const std::filesystem::path& folder);

/// The end of a session that was cut and has no trace: it stays as it is, and run.json says so and
/// gets "ended", by the newest of its files. Throws std::runtime_error.
void end_without_trace(const std::filesystem::path& folder);

}  // namespace sweepd
