#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/settings/robot_setup.hpp"
#include "daemon/stream/kept_sweeps.hpp"
#include "daemon/stream/pipeline.hpp"
#include "identify/poses/pose.hpp"
#include "identify/sweeps/joint_assignment.hpp"
#include "identify/sweeps/sweep.hpp"
#include "rsi/datagram.hpp"

namespace sweepd {

struct DeviceTake;

/// What a session knew at one moment: enough to identify, in any thread.
struct Snapshot {
  std::string robot;
  std::string source_kind;
  SourceCounts counts;
  identify::Campaign campaign;
  std::vector<identify::Sweep> sweeps;
  KeptSweeps::LeftOut left_out = {};       ///< what there was no memory for
  std::vector<JointLimits> limits = {};    ///< of the joints, where the description has them
  std::vector<identify::Pose> poses = {};  ///< static ones, beside the sweeps
  std::vector<JointCurrents::Joint> currents = {};  ///< empty: the stream has none
  /// What missing_signals() says of the first telegram; or else what one in a hundred lacks.
  std::string missing_signals = {};
  std::string without_positions = {};  ///< what advice_on_positions() says of the first telegram
  /// What a device measured meanwhile: its positions take the place of the controller's.
  std::shared_ptr<const DeviceTake> device = {};
};

/// What to do about signals that the settings name and a telegram has not or not as numbers, in a
/// sentence; empty if there are none. Missing are some of a kind of which it has others, or all of
/// a kind where they are not the usual names, which other controllers leave out.
[[nodiscard]] std::string missing_signals(const SignalNames& names, std::size_t joints,
                                          std::string_view telegram);

/// What to do where telegrams carry no positions.
[[nodiscard]] std::string advice_on_positions(const SignalNames& names, std::string_view telegram);

/// One stream of a controller, from its first telegram to its end. No files. One thread, unless it
/// is asked for two. What it finds it passes on to its sink.
class Session : private StreamSink {
 public:
  /// `source_kind` is for the result. A recorded live stream is "trace" too: its result is that of
  /// its own trace, to the byte.
  /// `first`: the telegram that it begins with, which tells whether samples.csv has motor currents,
  /// and which signals are missing; empty: neither. It is not read as data.
  Session(const RobotSetup& setup, std::string source_kind, StreamSink& sink,
          std::string_view first = {});

  /// See Pipeline: only telegrams, replies and link() come before finish() then.
  void use_two_threads(SampleRelay::Beside beside = {}) {
    pipeline_.use_two_threads(std::move(beside));
  }
  void wait_for_beside() { pipeline_.wait_for_beside(); }
  /// What came from the controller, whatever it holds.
  void telegram(const rsi::Datagram& datagram) { pipeline_.telegram(datagram); }
  void reply(const rsi::Datagram& datagram) { pipeline_.reply(datagram); }
  /// The stream is over: the last stroke ends.
  void finish() { pipeline_.finish(); }

  /// What samples.csv begins with, without its end of line.
  [[nodiscard]] std::string csv_header() const { return pipeline_.csv_header(); }
  /// What missing_signals() says of the first telegram.
  [[nodiscard]] const std::string& missing_signals() const { return missing_signals_; }
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] const rsi::Link& link() const { return pipeline_.link(); }
  /// Whether as many strokes were seen as an identification needs.
  [[nodiscard]] bool worth_identifying() const;

  /// Samples that memory is set aside for, 160 bytes each: five minutes of sweeps at 4 ms. An
  /// identification takes about as much again.
  static constexpr std::size_t kMostSamples = 80'000;

 private:
  void sample(const identify::Sample& sample, std::string_view row) override {
    sink_.sample(sample, row);
  }
  void currents(const identify::Sample& sample, const Currents& currents) override {
    currents_.take(sample, currents);
  }
  void sweep(const identify::Sweep& sweep) override;

  RobotSetup setup_;
  std::string source_kind_;
  StreamSink& sink_;
  std::string missing_signals_;
  std::string without_positions_;
  Pipeline pipeline_;
  KeptSweeps kept_{kMostSamples};
  JointCurrents currents_;
  std::set<std::size_t> swept_joints_;  // by sweeps without a defect
  std::size_t without_joint_ = 0;       // such sweeps
};

/// Names the joint of each stroke as it happens where no angles tell it: strokes about another axis
/// than the one before are the turn of the plan's next joint. For people who watch; the result
/// looks at the geometry of all strokes, and may find another order. One thread.
class PlannedTurns {
 public:
  /// In the plan's order; empty: nothing is known.
  explicit PlannedTurns(std::vector<identify::DeclaredJoint> order = {})
      : order_(std::move(order)) {}

  /// The joint, counted from 0; nothing where the plan does not tell it, or the stroke has a
  /// defect.
  [[nodiscard]] std::optional<std::size_t> joint_of(const identify::Sweep& stroke);

 private:
  std::vector<identify::DeclaredJoint> order_;
  std::size_t turn_ = 0;
  std::optional<identify::Sweep> last_;
};

}  // namespace sweepd
