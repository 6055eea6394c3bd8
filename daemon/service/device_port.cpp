#include "daemon/service/device_port.hpp"

#include <spdlog/fmt/fmt.h>

#include "daemon/points/device_lines.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/counted.hpp"

namespace sweepd {

DevicePort::DevicePort(const DeviceSettings& settings)
    : receiver_(settings.listen.tcp ? rsi::Transport::tcp : rsi::Transport::udp,
                settings.listen.endpoint) {
  const DeviceLines lines(settings.columns);  // throws where they are wrong
}

DevicePort::~DevicePort() {
  receiver_.stop();
  if (thread_.joinable()) thread_.join();
}

void DevicePort::start() {
  thread_ = std::thread([this] {
    name_thread("device");
    take(Share::fair);
    receiver_.run();
  });
}

std::optional<std::string> DevicePort::complaint(std::chrono::steady_clock::time_point now) {
  using rsi::TextReceiver;
  const auto dropped = receiver_.dropped() - dropped_, too_long = receiver_.too_long() - too_long_;
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
