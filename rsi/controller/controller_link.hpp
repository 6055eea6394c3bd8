#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "rsi/asio.hpp"

#include "rsi/controller/controller_socket.hpp"
#include "rsi/controller/faulty_wire.hpp"
#include "rsi/controller/simulated_controller.hpp"

namespace rsi {

/// Runs a simulated controller in real time, over UDP or, if its Ethernet file says so, over TCP:
/// telegram k leaves at start + k cycles, by the steady clock. Robot and IPOC go on with time: what
/// this machine oversleeps by more than half a cycle does not leave at all, so that IPOC and clock
/// never part and two telegrams never go out in one burst. It is counted as `skipped`; at the other
/// end it is lost.
///
/// For an RSI restart take a second link: a new socket has a new port, as at a controller. A TCP
/// connection that breaks ends the link, since no controller is known to connect by itself again:
/// its program has to start RSI anew.
class ControllerLink {
 public:
  struct Options {
    SimulatedController::Options controller;
    Endpoint local{};  ///< sends from here; 0.0.0.0:0: the system chooses
    FaultyWire::Rates faults{};
    std::uint64_t seed = 1;  ///< of the faults
    /// How lengths are written over TCP if the Ethernet file asks for them (PROTCOLLENGTH).
    LengthPrefix length = LengthPrefix::decimal;
  };

  enum class End {
    done,          ///< the program ended
    timed_out,     ///< too many cycles without a reply
    stopped,       ///< stop() was called
    disconnected,  ///< TCP: the connection broke, or what came is no stream of replies
  };

  struct Report {
    End end = End::done;
    SimulatedController::Counts controller;
    FaultyWire::Counts wire;
    LatencyHistogram latency;
    std::string first_fault;                 ///< empty: none
    std::vector<std::string> first_remarks;  ///< one of each kind that came up
    std::uint64_t skipped = 0;               ///< cycles that this machine overslept: no telegram
    std::uint64_t send_failures = 0;         ///< datagrams that the system refused
    std::string first_send_failure;          ///< why it refused the first; empty: none
    std::string disconnection;               ///< why it is disconnected
  };

  /// Fills in what the robot does in cycle k, counted from 0; false: the program is over. Called
  /// for each cycle, just before its telegram goes out or is skipped.
  using Program = std::function<bool(std::uint64_t cycle, SignalValues& values)>;
  /// Called about once a second.
  using Progress = std::function<void(const SimulatedController& controller)>;

  /// Opens the socket; over TCP it connects, and waits for that at most five seconds. Throws
  /// std::runtime_error with what to do, std::invalid_argument for wrong options.
  ControllerLink(const EthernetConfig& config, const Options& options);

  /// Runs until the end, on the calling thread; call it once. What the program throws comes out.
  /// That nobody listens at the other end (ICMP) is nothing but an unanswered cycle.
  [[nodiscard]] Report run(Program program, Progress progress = {});

  /// Ends run() within a cycle. From any thread or signal handler, also before run().
  void stop() noexcept { stop_ = true; }

  /// Where telegrams come from.
  [[nodiscard]] Endpoint local() const { return socket_->local(); }

 private:
  using Clock = std::chrono::steady_clock;

  void wait_for_cycle();
  void wait_for_replies();
  void on_cycle();
  [[nodiscard]] bool send_telegram();
  void send(std::string_view datagram);
  void receive();
  void end(End end);

  SimulatedController controller_;
  FaultyWire wire_;
  Clock::duration cycle_;
  boost::asio::io_context context_{1};
  std::unique_ptr<ControllerSocket> socket_;
  boost::asio::steady_timer timer_;

  Program program_;
  Progress progress_;
  Clock::time_point due_;  // of the next telegram
  std::uint64_t next_cycle_ = 0;
  bool program_over_ = false;
  bool waiting_for_replies_ = false;
  SignalValues values_;
  std::string telegram_;
  Report report_;
  std::atomic<bool> stop_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace rsi
