#pragma once

// A controller plays over a network that spoils its telegrams in every way that is known; all that
// can be counted is counted beside it. The next telegram leaves when the last one that can be
// answered was: so nothing depends on how fast the machine is.

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "rsi/asio.hpp"

#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "rsi/controller/faulty_wire.hpp"
#include "rsi/controller/simulated_controller.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/scenarios/sweepd_process.hpp"

namespace sweepd::test {

inline constexpr std::chrono::milliseconds kCycle{4};

/// A controller whose robot repeats the plan, and whose RSI is now and then restarted while the
/// robot rests. The same each time.
class RestlessController {
 public:
  explicit RestlessController(const rsi::Endpoint& server)
      : rsi_(rsi::EthernetConfig::load(kEthernet),
             {.server = server, .cycle = kCycle, .first_ipoc = next_start()}) {}

  /// Goes on by a cycle. True if RSI is to be restarted before its telegram.
  bool next() {
    const auto before = values_.ASPos;
    if (!robot_.next(values_)) {
      robot_ = start(++runs_);
      static_cast<void>(robot_.next(values_));
    }
    const bool rests = values_.ASPos == before;
    return rests && random_() % 250 == 0;
  }
  void restart() { rsi_.restart(next_start()); }
  /// The telegram of this cycle.
  std::string_view telegram() {
    telegram_.clear();
    if (!rsi_.next_telegram(values_, telegram_)) throw std::runtime_error("RSI has stopped");
    rsi_.sent({});
    return telegram_;
  }
  rsi::SimulatedController& rsi() { return rsi_; }

 private:
  /// Servos never wobble the same way again.
  static SimulatedRobot start(std::uint64_t run) {
    SimulatedRobot::Options options;
    options.seed = run;
    return {load_robot(kRobot), load_plan(kPlan), options};
  }

  /// Of real controllers, and just below the powers of two at which counters pass over.
  std::uint64_t next_start() {
    const std::uint64_t back = 4 * (100 + random_() % 400);
    const std::array starts{1'525'084 + back, (std::uint64_t{1} << 32) - back,
                            999'999'000'000 + back, 0 - back};
    return starts[starts_++ % starts.size()];
  }

  std::mt19937_64 random_{3};
  std::size_t starts_ = 0;
  std::uint64_t runs_ = 1;
  SimulatedRobot robot_ = start(runs_);
  rsi::SignalValues values_;
  rsi::SimulatedController rsi_;
  std::string telegram_;
};

/// A socket that waits at most ten seconds for a reply.
class LockstepPeer {
 public:
  LockstepPeer(const char* address, const rsi::Endpoint& server)
      : socket_(context_, {boost::asio::ip::make_address_v4(address), 0}),
        server_(boost::asio::ip::address_v4(server.address), server.port) {
    const timeval longest{10, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  }
  void send(std::string_view payload) {
    socket_.send_to(boost::asio::buffer(payload.data(), payload.size()), server_);
  }
  std::string_view reply() {
    const auto size = recv(socket_.native_handle(), buffer_.data(), buffer_.size(), 0);
    if (size < 0) throw std::runtime_error("no reply");
    return {buffer_.data(), static_cast<std::size_t>(size)};
  }
  [[nodiscard]] std::size_t waiting() const { return socket_.available(); }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint server_;
  std::array<char, 2048> buffer_{};
};

/// The kind of malformed datagram that this is, as result.json names it.
inline const char* kind_of(const rsi::Sent& sent) {
  constexpr std::string_view kBlank(" \t\r\n\0", 5);
  if (sent.payload.find_first_not_of(kBlank) == std::string_view::npos) return "empty";
  return sent.payload.starts_with("<Rob") ? "truncated" : "not a telegram";
}

/// sweepd answers what has an IPOC whose end tag begins.
inline bool has_ipoc(std::string_view payload) {
  const auto ipoc = payload.find("<IPOC>");
  return ipoc != std::string_view::npos && payload.find("</", ipoc) != std::string_view::npos;
}

inline std::uint64_t delay_in(std::string_view telegram) {
  constexpr std::string_view kTag = "<Delay D=\"";
  const auto at = telegram.find(kTag) + kTag.size();
  std::uint64_t delay = 0;
  std::from_chars(telegram.data() + at, telegram.data() + telegram.size(), delay);
  return delay;
}

/// What went out, counted here.
struct SentCounts {
  std::uint64_t whole = 0;
  std::uint64_t cut_known = 0;  ///< cut, but their IPOC says which they are
  std::uint64_t lost = 0;       ///< nothing tells of them, and later ones of their run do
  std::uint64_t restarts = 0;
  std::uint64_t answered = 0;
  std::uint64_t unanswerable = 0;
  std::uint64_t late = 0;  ///< by the Delay of the telegrams whose IPOC came, in order
  std::uint64_t late_runs = 0;
  std::uint64_t longest_late_run = 0;
  nlohmann::json malformed = nlohmann::json::object();
  std::vector<bool> came;  ///< by number, whole
};

/// Plays the controller over the faulty wire.
class FaultyCampaign {
 public:
  explicit FaultyCampaign(const rsi::Endpoint& server)
      : server_(server),
        controller_(server),
        wire_({.lose = 0.01,
               .duplicate = 0.005,
               .swap = 0.005,
               .cut = 0.01,
               .garbage = 0.005,
               .foreign = 0.005},
              7),
        peer_(std::make_unique<LockstepPeer>("127.0.0.1", server)),
        stranger_("127.0.0.2", server) {}

  void play(std::uint64_t telegrams) {
    expected_.came.resize(telegrams);
    for (number_ = 0; number_ < telegrams; ++number_) {
      if (controller_.next() && number_ > 0) {
        end_run();
        auto renewed = std::make_unique<LockstepPeer>("127.0.0.1", server_);  // has another port
        peer_ = std::move(renewed);
        controller_.restart();
        ++expected_.restarts;
      }
      const auto telegram = controller_.telegram();
      known_.push_back(false);
      send(wire_.pass(telegram));
    }
    end_run();
    CHECK(stranger_.waiting() == 0);
  }

  [[nodiscard]] const SentCounts& expected() const { return expected_; }
  [[nodiscard]] const rsi::FaultyWire::Counts& wire() const { return wire_.counts(); }
  [[nodiscard]] const rsi::SimulatedController& rsi() { return controller_.rsi(); }

 private:
  void end_run() {
    --number_;  // one that was held back is the last of this run
    send(wire_.flush());
    ++number_;
    auto end = known_.end();
    while (end != known_.begin() && !end[-1]) --end;
    expected_.lost += static_cast<std::uint64_t>(std::count(known_.begin(), end, false));
    known_.clear();
    controller_.rsi().finish();
    CHECK(peer_->waiting() == 0);
  }

  void send(const std::vector<rsi::Sent>& datagrams) {
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      const auto& sent = datagrams[i];
      if (sent.what == rsi::Sent::What::foreign) {
        stranger_.send(sent.payload);
        continue;
      }
      if (sent.what == rsi::Sent::What::telegram) {
        const bool again = i > 0 && sent.payload == datagrams[0].payload &&
                           datagrams[0].what == rsi::Sent::What::telegram;
        const bool overtaken = i > 0 && !again && datagrams[0].what == rsi::Sent::What::telegram;
        ++expected_.whole;
        expected_.came[overtaken ? number_ - 1 : number_] = true;
        known_.end()[overtaken ? -2 : -1] = true;
        if (!again && !overtaken) count_late(delay_in(sent.payload));
      } else {
        auto& kind = expected_.malformed[kind_of(sent)];
        kind = kind.is_null() ? 1 : kind.get<int>() + 1;
        if (sent.what == rsi::Sent::What::cut && has_ipoc(sent.payload)) {
          ++expected_.cut_known;
          known_.back() = true;
          count_late(delay_in(sent.payload));
        }
      }
      peer_->send(sent.payload);
      if (has_ipoc(sent.payload))
        take_reply(sent.payload);
      else
        ++expected_.unanswerable;
    }
  }

  std::string_view reply_to(std::string_view telegram) {
    try {
      return peer_->reply();
    } catch (const std::exception& error) {
      FAIL("telegram " << number_ << ", " << telegram << ": " << error.what());
    }
    return {};
  }

  void take_reply(std::string_view telegram) {
    const auto reply = reply_to(telegram);
    // Not a CHECK for each of a million.
    if (rsi::find_ipoc(reply) != rsi::find_ipoc(telegram))
      FAIL("to " << telegram << " the reply " << reply);
    controller_.rsi().on_reply(reply, server_, {});
    ++expected_.answered;
  }

  /// One in order was answered, whatever was before it: its Delay ends a run.
  void count_late(std::uint64_t delay) {
    if (delay == 0) return;
    expected_.late += delay;
    ++expected_.late_runs;
    expected_.longest_late_run = std::max(expected_.longest_late_run, delay);
  }

  rsi::Endpoint server_;
  RestlessController controller_;
  rsi::FaultyWire wire_;
  std::unique_ptr<LockstepPeer> peer_;
  LockstepPeer stranger_;
  std::uint64_t number_ = 0;
  std::vector<bool> known_;  ///< of the telegrams of this run: sweepd got their IPOC
  SentCounts expected_;
};

}  // namespace sweepd::test
