#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "rsi/asio.hpp"

#include "rsi/simulated_controller.hpp"

namespace rsi {

/// Runs a simulated controller over UDP in real time: telegram k leaves at start + k cycles, by the
/// steady clock. A machine that oversleeps by more than half a cycle gets whole cycles to catch up
/// in, so that two telegrams never go out in one burst; they are counted as `skipped`.
///
/// For an RSI restart take a second link: a new socket has a new port, as at a controller.
class ControllerLink {
 public:
  struct Options {
    SimulatedController::Options controller;
    Endpoint local{};  ///< sends from here; 0.0.0.0:0: the system chooses
    FaultyWire::Rates faults{};
    std::uint64_t seed = 1;  ///< of the faults
  };

  enum class End {
    done,       ///< the program ended
    timed_out,  ///< too many cycles without a reply
    stopped,    ///< stop() was called
  };

  struct Report {
    End end = End::done;
    SimulatedController::Counts controller;
    FaultyWire::Counts wire;
    LatencyHistogram latency;
    std::string first_fault;          ///< empty: none
    std::uint64_t skipped = 0;        ///< cycles that this machine overslept
    std::uint64_t send_failures = 0;  ///< datagrams that the system refused
    std::string first_send_failure;   ///< why it refused the first; empty: none
  };

  /// Fills in what the robot does in cycle k, counted from 0; false: the program is over. Called
  /// just before the telegram goes out.
  using Program = std::function<bool(std::uint64_t cycle, SignalValues& values)>;
  /// Called about once a second.
  using Progress = std::function<void(const SimulatedController& controller)>;

  /// Opens the socket. Throws std::runtime_error with what to do, std::invalid_argument for wrong
  /// options.
  ControllerLink(const EthernetConfig& config, const Options& options);

  /// Runs until the end, on the calling thread; call it once. What the program throws comes out.
  /// That nobody listens at the other end (ICMP) is nothing but an unanswered cycle.
  [[nodiscard]] Report run(Program program, Progress progress = {});

  /// Ends run() within a cycle. From any thread or signal handler, also before run().
  void stop() noexcept { stop_ = true; }

  /// Where telegrams come from.
  [[nodiscard]] Endpoint local() const;

 private:
  using Clock = std::chrono::steady_clock;

  void wait_for_cycle();
  void wait_for_replies();
  void on_cycle();
  void send(std::string_view datagram);
  void receive();
  void end(End end);

  SimulatedController controller_;
  FaultyWire wire_;
  Clock::duration cycle_;
  boost::asio::io_context context_{1};
  boost::asio::ip::udp::socket socket_;
  boost::asio::steady_timer timer_;
  boost::asio::ip::udp::endpoint server_;

  Program program_;
  Progress progress_;
  Clock::time_point due_;  // of the next telegram
  std::uint64_t next_cycle_ = 0;
  bool program_over_ = false;
  bool waiting_for_replies_ = false;
  SignalValues values_;
  std::string telegram_;
  std::array<char, 65536> received_{};
  Report report_;
  std::atomic<bool> stop_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace rsi
