#include "daemon/service/device_port.hpp"

#include <exception>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/points/device_lines.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/counted.hpp"

namespace sweepd {

DevicePort::DevicePort(const DeviceSettings& settings, std::chrono::milliseconds between_tries)
    : port_(settings.listen), between_tries_(between_tries) {
  const DeviceLines lines(settings.columns);  // throws where they are wrong
}

DevicePort::~DevicePort() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (receiver_) receiver_->stop();
  }
  stopping_changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DevicePort::start() {
  thread_ = std::thread([this] {
    name_thread("device");
    take(Share::fair);
    listen();
  });
}

void DevicePort::listen() {
  for (;;) {
    std::string problem;
    try {
      auto receiver = std::make_unique<rsi::TextReceiver>(
          port_.tcp ? rsi::Transport::tcp : rsi::Transport::udp, port_.endpoint);
      const std::lock_guard lock(mutex_);
      if (stopping_) return;
      receiver_ = std::move(receiver);
      ready_ = receiver_.get();
    } catch (const std::exception& error) {
      problem = error.what();
    }
    if (problem.empty()) return receiver_->run();
    std::unique_lock lock(mutex_);
    problem_ = problem;
    if (stopping_changed_.wait_for(lock, between_tries_, [this] { return stopping_; })) return;
  }
}

bool DevicePort::pop(rsi::Datagram& datagram) {
  rsi::TextReceiver* const receiver = ready_;
  return receiver != nullptr && receiver->datagrams().pop(datagram);
}

std::optional<DevicePort::News> DevicePort::news() {
  if (said_ready_) return std::nullopt;
  if (ready_ != nullptr) {
    said_ready_ = true;
    return News{Importance::note, "listening for a device on " + text(port_)};
  }
  const std::lock_guard lock(mutex_);
  if (problem_ == said_problem_) return std::nullopt;
  said_problem_ = problem_;
  return News{Importance::error,
              problem_ +
                  "; the robot is served without its device, and the port is tried again "
                  "every few seconds"};
}

std::optional<std::string> DevicePort::complaint(std::chrono::steady_clock::time_point now) {
  using rsi::TextReceiver;
  const rsi::TextReceiver* const receiver = ready_;
  if (receiver == nullptr) return std::nullopt;
  const auto dropped = receiver->dropped() - dropped_, too_long = receiver->too_long() - too_long_;
  if (now < again_ || dropped + too_long == 0) return std::nullopt;
  std::string text;
  if (dropped > 0)
    text = fmt::format(
        "{} dropped, as they came faster than {} a second: let the device send less, and keep "
        "others off its port",
        rsi::counted(dropped, "datagram was", "datagrams were"), TextReceiver::kMostInASecond);
  if (too_long > 0)
    text += fmt::format(
        "{}more than {} bytes without an end of line came {}, and were left out: let the device "
        "end each line",
        text.empty() ? "" : "; ", TextReceiver::kLongestLine,
        rsi::counted(too_long, "time", "times"));
  dropped_ += dropped;
  too_long_ += too_long;
  again_ = now + std::chrono::minutes(1);
  return text;
}

}  // namespace sweepd
