#include "daemon/service/device_port.hpp"

#include <stdexcept>

#include "daemon/points/device_lines.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/counted.hpp"

namespace sweepd {

DevicePort::DevicePort(const DeviceSettings& settings)
    : receiver_(settings.listen.tcp ? rsi::Transport::tcp : rsi::Transport::udp,
                settings.listen.endpoint) {
  try {
    const DeviceLines lines(settings.columns.text);
  } catch (const std::invalid_argument& error) {
    throw ConfigError("[[robot.device]]: columns: " + std::string(error.what()));
  }
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
  const auto dropped = receiver_.dropped();
  if (dropped == said_ || now < again_) return std::nullopt;
  std::string text = rsi::counted(dropped - said_, "datagram", "datagrams") +
                     (dropped - said_ == 1 ? " was " : " were ") +
                     "dropped, as the device sends faster than 10,000 lines a second: let it send "
                     "less, and keep others off its port";
  said_ = dropped;
  again_ = now + std::chrono::minutes(1);
  return text;
}

}  // namespace sweepd
