// Many controllers, each at 250 Hz and all at different moments of the cycle, from one thread and
// one socket; the servers, a reply thread each, in a process of their own. First N services, then N
// echo servers: what both have in common is the machine's, the rest is sweepd's.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <memory>
#include <system_error>
#include <unordered_map>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>

#include "daemon/service/robot_service.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace bench {
namespace {

using std::chrono::nanoseconds;
using Clock = std::chrono::system_clock;  // as the kernel stamps datagrams
using namespace std::chrono_literals;

nanoseconds now() {
  return Clock::now().time_since_epoch();
}

/// The controllers' side: sends, and times what comes back by the kernel's stamp, so that how soon
/// this thread gets to it does not count.
class Controllers {
 public:
  explicit Controllers(std::vector<std::uint16_t> ports)
      : ports_(std::move(ports)), sent_(ports_.size()), socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    if (socket_ < 0) throw std::system_error(errno, std::generic_category(), "socket");
    for (std::size_t i = 0; i < ports_.size(); ++i) place_[ports_[i]] = i;
    const int yes = 1;
    const int buffer = 8 << 20;
    setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &buffer, sizeof buffer);
    setsockopt(socket_, SOL_SOCKET, SO_SNDBUFFORCE, &buffer, sizeof buffer);
  }
  ~Controllers() { close(socket_); }
  Controllers(const Controllers&) = delete;
  Controllers& operator=(const Controllers&) = delete;

  /// Plays so many cycles; the reply latencies come on top of those that are there.
  void play(std::int64_t cycles) {
    prctl(PR_SET_TIMERSLACK, 1);
    const auto robots = static_cast<std::int64_t>(ports_.size());
    const auto start = now() + kCycle;
    for (std::int64_t cycle = 0; cycle < cycles; ++cycle) {
      const auto telegram = telegrams_.next();
      for (std::int64_t robot = 0; robot < robots; ++robot) {
        receive_until(start + cycle * nanoseconds(kCycle) + robot * nanoseconds(kCycle) / robots);
        send(static_cast<std::size_t>(robot), telegram);
      }
    }
    receive_until(now() + 100ms);
  }

  std::vector<nanoseconds>& latencies() { return latencies_; }
  [[nodiscard]] std::uint64_t telegrams() const { return telegrams_sent_; }

 private:
  struct Sent {
    std::uint64_t ipoc = 0;
    nanoseconds time{};
  };

  void send(std::size_t robot, std::string_view telegram) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(kLoopback);
    to.sin_port = htons(ports_[robot]);
    sent_[robot][telegrams_.ipoc() / 4 % kKept] = {telegrams_.ipoc(), now()};
    ++telegrams_sent_;
    if (sendto(socket_, telegram.data(), telegram.size(), 0, reinterpret_cast<sockaddr*>(&to),
               sizeof to) < 0)
      throw std::system_error(errno, std::generic_category(), "sendto");
  }

  void receive_until(nanoseconds due) {
    for (;;) {
      while (receive()) {
      }
      const auto left = due - now();
      if (left <= 0ns) return;
      pollfd readable{socket_, POLLIN, 0};
      const timespec wait{left / 1s, (left % 1s).count()};
      ppoll(&readable, 1, &wait, nullptr);
    }
  }

  bool receive() {
    sockaddr_in from{};
    iovec place{buffer_.data(), buffer_.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(timespec))> control;
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &place;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const auto size = recvmsg(socket_, &message, MSG_DONTWAIT);
    if (size < 0) return false;
    timespec stamp{};
    if (const auto* part = CMSG_FIRSTHDR(&message); part != nullptr)
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    answered(place_.at(ntohs(from.sin_port)), {buffer_.data(), static_cast<std::size_t>(size)},
             std::chrono::seconds(stamp.tv_sec) + nanoseconds(stamp.tv_nsec));
    return true;
  }

  void answered(std::size_t robot, std::string_view reply, nanoseconds time) {
    // An echo carries no IPOC that could be found: it answers the oldest that is open.
    auto& open = sent_[robot];
    Sent* telegram = nullptr;
    if (const auto ipoc = rsi::ipoc_number(rsi::find_ipoc(reply))) {
      telegram = &open[*ipoc / 4 % kKept];
      if (telegram->ipoc != *ipoc) return;
    } else {
      for (auto& one : open)
        if (one.ipoc != 0 && (telegram == nullptr || one.ipoc < telegram->ipoc)) telegram = &one;
      if (telegram == nullptr) return;
    }
    telegram->ipoc = 0;
    latencies_.push_back(time - telegram->time);
  }

  static constexpr std::size_t kKept = 64;

  Telegrams telegrams_;
  std::vector<std::uint16_t> ports_;
  std::vector<std::array<Sent, kKept>> sent_;  // by robot, and by telegram; IPOC 0: answered
  std::unordered_map<std::uint16_t, std::size_t> place_;
  std::vector<nanoseconds> latencies_;
  std::uint64_t telegrams_sent_ = 0;
  std::array<char, 65536> buffer_{};
  int socket_;
};

/// What threads of a service do, by the names that they bear.
const std::array<std::vector<std::string>, 4> kRoles{
    {{"reply"}, {"acquisition"}, {"recorder"}, {"identification", "interim result"}}};

constexpr double kRatioAim = 1.5;

struct Cost {
  double p50_us = 0, p999_us = 0, max_us = 0;
  std::uint64_t unanswered = 0;
  std::uint64_t beyond_2ms = 0;
  /// Time on a processor per telegram: of the reply, acquisition, recorder and identification
  /// threads.
  std::array<double, kRoles.size()> us{};
  double all_us = 0;
  double resident_before_mb = 0, resident_after_mb = 0;
  std::uint64_t superseded = 0, overflows = 0, dropped = 0;
};

/// The server says the port of each robot.
Cost play(const Child& server, std::chrono::seconds time) {
  const std::vector<std::uint16_t> ports(server.numbers().begin(), server.numbers().end());

  Controllers controllers(ports);
  controllers.play(1s / kCycle);  // sessions begin, buffers find their sizes
  controllers.latencies().clear();
  const auto before = controllers.telegrams();
  Cost cost;
  cost.resident_before_mb = resident_mb(server.process());
  auto used_before = processor_times(server.process());
  controllers.play(time / kCycle);
  auto used = processor_times(server.process());
  const auto telegrams = controllers.telegrams() - before;
  const auto us = [&](nanoseconds used_up) {
    return std::chrono::duration<double, std::micro>(used_up).count() /
           static_cast<double>(telegrams);
  };
  for (std::size_t role = 0; role < kRoles.size(); ++role)
    for (const auto& name : kRoles[role]) cost.us[role] += us(used[name] - used_before[name]);
  for (const auto& [name, time_used] : used) cost.all_us += us(time_used - used_before[name]);
  cost.resident_after_mb = resident_mb(server.process());
  auto& latencies = controllers.latencies();
  cost.unanswered = telegrams - latencies.size();
  cost.p50_us = quantile_us(latencies, 0.5);
  cost.p999_us = quantile_us(latencies, 0.999);
  cost.max_us = quantile_us(latencies, 1);
  cost.beyond_2ms = static_cast<std::uint64_t>(
      latencies.end() - std::upper_bound(latencies.begin(), latencies.end(), nanoseconds(2ms)));
  return cost;
}

Cost echoes(std::size_t robots, std::chrono::seconds time) {
  Child server([&](const Child::Ready& ready) {
    std::vector<std::unique_ptr<EchoServer>> servers;
    std::vector<int> numbers;
    for (std::size_t i = 0; i < robots; ++i) {
      servers.push_back(std::make_unique<EchoServer>([] { sweepd::name_thread("reply"); }));
      numbers.push_back(servers.back()->port());
    }
    ready(numbers);
  });
  const auto cost = play(server, time);
  server.stop();
  return cost;
}

Cost services(std::size_t robots, std::chrono::seconds time) {
  const sweepd::test::TemporaryFolder temporary;
  Child server([&](const Child::Ready& ready) {
    const auto threads = std::make_shared<sweepd::RobotThreads>();
    std::vector<std::unique_ptr<sweepd::RobotService>> services;
    std::vector<int> numbers;
    for (std::size_t i = 0; i < robots; ++i) {
      services.push_back(std::make_unique<sweepd::RobotService>(
          settings(temporary.path(), "robot-" + std::to_string(i + 1)), threads));
      services.back()->start();
      numbers.push_back(services.back()->local().port);
    }
    ready(numbers);
    for (const auto& service : services) service->stop();
  });
  auto cost = play(server, time);
  server.stop();
  cost.superseded = counted(temporary.path(), "superseded");
  cost.overflows = counted(temporary.path(), "overflows");
  cost.dropped = counted(temporary.path(), "dropped");
  return cost;
}

}  // namespace

void fleet(const std::vector<std::size_t>& robots, std::chrono::seconds time) {
  std::cout
      << time.count() << " s of telegrams at 250 Hz from each robot\n"
      << "               latency in us            replies     time on a processor, us a "
         "telegram            resident MB\n"
      << "robots            p50   p99.9     max    none >2 ms   reply acquis record identi    "
         "all  ratio  start    end\n";
  const auto print = [&](std::size_t count, const char* name, const Cost& cost, double ratio) {
    std::cout << right(std::to_string(count), 6) << left(std::string(" ") + name, 9)
              << right(cost.p50_us, 0, 6) << right(cost.p999_us, 0, 8) << right(cost.max_us, 0, 8)
              << right(std::to_string(cost.unanswered), 8)
              << right(std::to_string(cost.beyond_2ms), 6) << ' ';
    for (const double us : cost.us) std::cout << right(us, 2, 7);
    std::cout << right(cost.all_us, 2, 7) << right(ratio, 2, 7)
              << right(cost.resident_before_mb, 0, 7) << right(cost.resident_after_mb, 0, 7);
  };
  for (const auto count : robots) {
    const auto echo = echoes(count, time);
    print(count, "echo", echo, 1);
    std::cout << std::endl;
    const auto service = services(count, time);
    const double ratio = service.all_us / echo.all_us;
    print(count, "sweepd", service, ratio);
    if (service.max_us > echo.max_us + 2000) std::cout << "  LATER than the echo's latest + 2 ms";
    if (ratio > kRatioAim) std::cout << "  ratio above " << sweepd::fixed(kRatioAim, 1);
    if (service.superseded + service.overflows + service.dropped != 0)
      std::cout << "  superseded " << service.superseded << ", overflows " << service.overflows
                << ", dropped " << service.dropped;
    std::cout << std::endl;
  }
}

}  // namespace bench
