#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/line_file.hpp"
#include "daemon/outcome.hpp"
#include "daemon/pipeline.hpp"
#include "daemon/robot_setup.hpp"
#include "rsi/capture_writer.hpp"

namespace sweepd {

/// What a session knew at one moment: enough to identify, in any thread.
struct Snapshot {
  std::string robot;
  std::string source_kind;
  SourceCounts counts;
  identify::Campaign campaign;
  std::vector<identify::Sweep> sweeps;
  std::size_t sweeps_left_out = 0;       ///< beyond what memory is set aside for
  std::vector<JointLimits> limits = {};  ///< of the joints, where the description has them

  /// Runs the engine. The same snapshot gives the same outcome.
  [[nodiscard]] Outcome identified() const;
};

/// One stream of a controller, from its first telegram to its end, and the files that grow with it.
/// One thread.
class Session {
 public:
  struct Options {
    std::filesystem::path folder;  ///< must exist; empty: no files
    bool record = false;           ///< trace.pcap
    /// For the result. A recorded live stream is "trace" too: its result is that of its own trace,
    /// to the byte.
    std::string source_kind = "trace";
  };
  struct Events {
    std::function<void(const identify::Sweep&)> on_sweep;
    /// A file could not be written: said once a file.
    std::function<void(const std::string&)> on_trouble;
  };

  /// Throws std::runtime_error if a file cannot be created.
  Session(const RobotSetup& setup, Options options, Events events);

  /// What came from the controller, whatever it holds.
  void telegram(const rsi::Datagram& datagram);
  /// What was sent to it.
  void reply(const rsi::Datagram& datagram);

  /// Hands what was written so far to the operating system.
  void flush();
  /// The stream is over: the last stroke ends, the files are complete.
  void finish();

  [[nodiscard]] Snapshot snapshot() const;
  /// Whether as many strokes were seen as an identification needs.
  [[nodiscard]] bool worth_identifying() const;

 private:
  void keep(const identify::Sweep& sweep);
  void record(const rsi::Datagram& datagram);
  void complain_once();

  /// Samples that are kept for identification: some 80 MB, more than half an hour of sweeps.
  static constexpr std::size_t kMostSamples = 500'000;

  RobotSetup setup_;
  Options options_;
  Events events_;
  Pipeline pipeline_;
  std::optional<LineFile> samples_;
  std::optional<rsi::CaptureWriter> trace_;
  bool samples_failed_ = false;
  bool trace_failed_ = false;
  std::vector<identify::Sweep> sweeps_;
  std::size_t kept_samples_ = 0;
  std::size_t left_out_ = 0;
};

}  // namespace sweepd
