#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/record/recording.hpp"
#include "daemon/results/link_totals.hpp"
#include "daemon/service/live_slices.hpp"
#include "daemon/service/published.hpp"
#include "daemon/settings/robot_description.hpp"
#include "identify/identification.hpp"
#include "rsi/link/link_verdict.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// RSI that streams now.
struct StreamState {
  std::string session;  ///< its start, as its folder is named
  rsi::Timestamp since{};
  std::uint32_t controller = 0;      ///< its address, in host byte order
  std::chrono::nanoseconds cycle{};  ///< 0 until it is known
  /// Of its replies.
  std::chrono::nanoseconds latency_p50{}, latency_p99{}, latency_max{};
};

/// What link.txt would say of a stream first.
struct LinkVerdict {
  rsi::Grade grade = rsi::Grade::good;
  std::string reason;  ///< the worst one; empty where it is good
};

/// Strokes of one joint between two rests.
struct SweepCounts {
  std::uint64_t usable = 0;
  std::uint64_t not_usable = 0;
};

/// Last results of sessions.
struct ResultBacklog {
  std::uint64_t pending = 0;   ///< under way, or waiting for a disk that takes them
  std::uint64_t given_up = 0;  ///< as too many others waited, since sweepd started
  std::uint64_t refused = 0;   ///< of the pending ones: the disk has no room, or refuses
};

/// What an operator may want to know of a robot at one moment. Counts are those since sweepd
/// started, over all sessions; they never fall.
struct RobotState {
  std::string name;
  rsi::Endpoint listen;
  rsi::Transport transport = rsi::Transport::udp;
  bool replies = true;  ///< false: the controller wants none

  std::optional<StreamState> stream;
  std::optional<LinkVerdict> verdict;  ///< of it, or of the one before
  std::uint64_t sessions = 0;          ///< that have begun
  rsi::Server::Counts server;
  LinkTotals link;

  Recording::Counts recording;
  bool recording_paused = false;           ///< the disk has no room, or refuses
  std::optional<std::uint64_t> disk_free;  ///< bytes, when the recorder last looked

  ResultBacklog results;

  /// By joint, from 1; 0: no angles tell which one it was.
  std::map<std::size_t, SweepCounts> sweeps;
  std::string last_sweep;  ///< in words; empty before the first
};

/// What was identified, since sweepd started.
struct ResultState {
  /// Identifications by identify::Status, interim ones included.
  std::array<std::uint64_t, 4> count{};

  struct Newest {
    identify::Status status{};
    bool interim = false;  ///< its session goes on
    std::string session;
    rsi::Timestamp at{};
    std::chrono::nanoseconds took{};
    std::size_t warnings = 0;
    std::shared_ptr<const std::string> json;  ///< result.json, to the byte
  };
  std::optional<Newest> newest;
};

/// What is known of a robot before its first telegram; empty where it is not.
struct RobotFacts {
  std::size_t joints = 0;
  std::vector<identify::DhRow> specified = {};
  std::vector<double> home_deg = {};     ///< of a linear joint mm
  std::vector<JointLimits> limits = {};  ///< one a joint
};

/// Where a robot's threads publish how it is. Any thread; no reply thread comes near it.
struct RobotStatus {
  Published<RobotFacts> facts;
  Published<RobotState> state;
  Published<ResultState> result;
  LiveSlices live;
  /// No session of an earlier sweepd waits for its last result any longer.
  std::atomic<bool> earlier_finished{false};
};

/// How the whole service is, as the thread that leads it publishes it about once a second.
struct ServiceStatus {
  enum class Phase { starting, serving, stopping };
  Phase phase = Phase::starting;
  std::vector<std::shared_ptr<const RobotStatus>> robots;  ///< that are served
  /// The threads that stand still, a sentence each: see Heartbeat.
  std::vector<std::string> standstills;
  std::chrono::steady_clock::time_point looked{};  ///< when that was found out

  struct NotServed {
    std::string robot;
    std::string reason;
  };
  std::vector<NotServed> not_served = {};  ///< robots of the settings that are tried again

  [[nodiscard]] bool ready() const { return phase == Phase::serving && not_served.empty(); }
};

/// What `systemctl status` shows: of each robot the stream, its telegrams, the last sweep and the
/// last result; before them what is wrong: threads that stand still, robots that are not served.
[[nodiscard]] std::string status_line(const ServiceStatus& status);

}  // namespace sweepd
