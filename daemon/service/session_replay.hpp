#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/points/device_recording.hpp"
#include "daemon/service/session_end.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/session.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/conversation.hpp"

namespace sweepd {

/// Reads the recording of a session whose last result was never written. One thread.
class SessionReplay : private StreamSink {
 public:
  /// `lock`: of the folder, held. Throws rsi::CaptureError where there is nothing to read.
  SessionReplay(std::filesystem::path folder, FolderLock lock, const RobotSetup& setup);

  /// Reads on for some tenth of a second. False once all is read.
  bool step();
  /// Then: the end of the session, to be identified.
  [[nodiscard]] SessionEnd end(Log log);

 private:
  void sample(const identify::Sample& sample, std::string_view) override { device_.sample(sample); }

  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::filesystem::path> traces_;  // the next one is at the end
  rsi::Conversation conversation_;
  DeviceRecording device_;
  std::unique_ptr<Session> session_;
  std::optional<rsi::CaptureReader> trace_;
  rsi::Timestamp newest_{};
  std::vector<std::string> damage_;  // sentences
};

/// The end of a session that was cut and has no trace: it stays as it is, and run.json says so and
/// gets "ended", by the newest of its files. Throws std::runtime_error.
void end_without_trace(const std::filesystem::path& folder);

}  // namespace sweepd
