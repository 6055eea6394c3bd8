#include "tests/scenarios/streamer.hpp"

#include <algorithm>
#include <array>

#include <poll.h>

#include "daemon/text/numbers.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "tests/daemon/telegrams.hpp"

namespace sweepd::test {

using namespace std::chrono_literals;
using boost::asio::ip::udp;

Streamer::Streamer(std::uint16_t port, Options options)
    : options_(std::move(options)),
      socket_(context_, {boost::asio::ip::address_v4::loopback(), 0}) {
  socket_.connect({boost::asio::ip::address_v4::loopback(), port});
  socket_.non_blocking(true);
  thread_ = std::thread([this] { run(); });
}

Streamer::~Streamer() {
  stop();
}

std::vector<Streamer::Sent> Streamer::sent() const {
  const std::lock_guard lock(mutex_);
  return sent_;
}

std::vector<Streamer::Sent> Streamer::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  return sent();
}

void Streamer::run() {
  auto due = Clock::now();
  for (std::uint64_t cycle = 0; !stop_; ++cycle) {
    if (options_.speaks(cycle)) send(cycle);
    due = std::max(due + options_.cycle, Clock::now() - options_.cycle);
    receive_until(due);
  }
  receive_until(Clock::now() + 100ms);
}

void Streamer::send(std::uint64_t cycle) {
  static const auto there = stroke_deg(0, 60);
  static const auto back = stroke_deg(60, 0);
  const auto& angles = cycle / there.size() % 2 == 0 ? there : back;
  const std::uint64_t ipoc = 1'000'000 + 4 * cycle;
  const auto text =
      telegram(ipoc, joint_1_at(angles[cycle % there.size()]) + std::string(options_.padding, ' '));
  {
    const std::lock_guard lock(mutex_);
    sent_.push_back({ipoc, Clock::now(), {}});
  }
  boost::system::error_code nobody_listens;
  socket_.send(boost::asio::buffer(text), 0, nobody_listens);
}

void Streamer::receive_until(Clock::time_point time) {
  std::array<char, 65536> buffer{};
  for (auto now = Clock::now(); now < time; now = Clock::now()) {
    const timespec left{0, std::chrono::nanoseconds(time - now).count()};
    pollfd wanted{socket_.native_handle(), POLLIN, 0};
    if (ppoll(&wanted, 1, &left, nullptr) <= 0) continue;
    boost::system::error_code error;
    const auto size = socket_.receive(boost::asio::buffer(buffer), 0, error);
    if (error) continue;
    const auto ipoc = rsi::ipoc_number(rsi::find_ipoc({buffer.data(), size}));
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(sent_.rbegin(), sent_.rend(),
                                    [&](const Sent& sent) { return sent.ipoc == ipoc; });
    if (found != sent_.rend()) found->answered_after = Clock::now() - found->at;
  }
}

Answers answers(const std::vector<Streamer::Sent>& sent, Streamer::Clock::time_point from,
                Streamer::Clock::time_point to) {
  Answers result;
  for (const auto& telegram : sent) {
    if (telegram.at < from || telegram.at >= to) continue;
    ++result.telegrams;
    if (telegram.answered_after)
      result.latency.add(*telegram.answered_after);
    else
      ++result.unanswered;
  }
  return result;
}

std::string Answers::text() const {
  const auto microseconds = [this](double level) {
    return fixed(static_cast<double>(latency.quantile(level).count()) / 1e3, 0) + " us";
  };
  return std::to_string(telegrams) + " telegrams, " + std::to_string(unanswered) +
         " unanswered, p50 " + microseconds(0.5) + ", p99 " + microseconds(0.99);
}

}  // namespace sweepd::test
