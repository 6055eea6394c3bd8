#include "daemon/commands/machine.hpp"

#include <algorithm>
#include <cerrno>
#include <exception>
#include <memory>
#include <system_error>
#include <thread>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <netinet/in.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include "daemon/text/numbers.hpp"
#include "rsi/server/port_owner.hpp"
#include "rsi/server/tcp_server.hpp"
#include "rsi/server/udp_server.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint32_t> own_addresses() {
  std::vector<std::uint32_t> addresses;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return addresses;
  for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next) {
    if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::copy_n(reinterpret_cast<const char*>(at->ifa_addr), sizeof address,
                reinterpret_cast<char*>(&address));
    addresses.push_back(ntohl(address.sin_addr.s_addr));
  }
  freeifaddrs(list);
  std::sort(addresses.begin(), addresses.end());
  addresses.erase(std::unique(addresses.begin(), addresses.end()), addresses.end());
  return addresses;
}

void try_to_listen(const RobotSettings& robot, rsi::Transport transport, Machine& machine) {
  rsi::Server::Options options;
  options.listen = robot.listen;
  try {
    std::unique_ptr<rsi::Server> server;
    if (transport == rsi::Transport::tcp)
      server = std::make_unique<rsi::TcpServer>(std::move(options));
    else
      server = std::make_unique<rsi::UdpServer>(std::move(options));
    machine.receive_buffer = server->receive_buffer();
  } catch (const std::exception& problem) {
    machine.port_taken_by = rsi::port_owner(transport, robot.listen);
    machine.cannot_listen = problem.what();
  }
}

RealTimeReport try_real_time(const RealTimeSettings& settings) {
  RealTimeReport report;
  lock_memory(report);
  std::thread([&] { enter_real_time(settings, report); }).join();
  return report;
}

/// The folder itself or the one that it would be made in.
fs::path nearest(fs::path folder) {
  std::error_code error;
  folder = fs::absolute(folder, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

std::string days_text(double value) {
  return value < 2 ? fixed(24 * value, 0) + " hours" : fixed(value, 0) + " days";
}

std::string gigabytes(double bytes) {
  return fixed(bytes / 1e9, 1) + " GB";
}

std::string list(const std::vector<std::uint32_t>& addresses) {
  std::string text;
  for (const auto address : addresses)
    text += (text.empty() ? "" : ", ") + rsi::address_text(address);
  return text.empty() ? "none" : text;
}

void judge_port(const Machine& machine, const RobotSettings& robot, Findings& findings) {
  const auto place = "listen " + rsi::text(robot.listen);
  if (machine.cannot_listen.empty())
    findings.ok(
        fmt::format("{}: free; receive buffer {} KiB", place, machine.receive_buffer / 1024));
  else if (machine.port_taken_by.starts_with("sweepd "))
    findings.ok(place + ": " + machine.port_taken_by + " listens there");
  else
    findings.not_ready(machine.cannot_listen);
}

void judge_addresses(const Machine& machine, const RobotSettings& robot,
                     const rsi::EthernetConfig* ethernet, Findings& findings) {
  const bool named = ethernet != nullptr && rsi::parse_address(ethernet->ip_number).has_value();
  const bool own = named && std::binary_search(machine.addresses.begin(), machine.addresses.end(),
                                               rsi::parse_address(ethernet->ip_number).value_or(0));
  if (named && !own)
    findings.warning(fmt::format(
        "{}: IP_NUMBER: this machine has no interface with the address {}, it has {}: correct the "
        "file here and on the controller, or the interface",
        ethernet->name, ethernet->ip_number, list(machine.addresses)));
  if (!robot.controller) return;
  const auto controller = "controller " + rsi::address_text(*robot.controller);
  if (!machine.towards_controller)
    findings.warning(controller + ": there is no way to it from here: see `ip route`");
  else if (own && ethernet->ip_number != rsi::address_text(*machine.towards_controller))
    findings.warning(controller + " sends to " + ethernet->ip_number + ", but is reached from " +
                     rsi::address_text(*machine.towards_controller) +
                     ": use one network for both ways");
  else
    findings.ok(controller + ": reached from " + rsi::address_text(*machine.towards_controller));
}

void judge_real_time(const Machine& machine, const RobotSettings& robot, Findings& findings) {
  if (robot.real_time.wish == RealTime::off) return findings.ok("realtime: off, as is wished");
  for (const auto& granted : machine.real_time.granted) findings.ok("realtime: " + granted);
  for (const auto& refused : machine.real_time.refused) {
    const auto text = "realtime: " + refused + "; the unit sweepd.service has limits of its own";
    if (robot.real_time.wish == RealTime::require)
      findings.not_ready(text);
    else
      findings.warning(text);
  }
}

void judge_disk(const Machine& machine, const RobotSettings& robot, Findings& findings) {
  const auto folder = (robot.output / robot.name).string();
  if (!machine.cannot_write.empty()) return findings.not_ready(machine.cannot_write);
  if (!machine.room)
    return findings.warning(folder + ": how much room there is cannot be told: see `df`");
  const auto& recording = robot.recording;
  const auto free = static_cast<double>(machine.room->free);
  const auto kept = static_cast<double>(recording.keep_free_bytes);
  if (free < kept)
    return findings.not_ready(fmt::format(
        "{}: {} free, and recording needs more than {} (keep_free_bytes): make room, or set it "
        "lower",
        folder, gigabytes(free), gigabytes(kept)));
  if (recording.keep_bytes > 0 && recording.keep_bytes < recording.rotate_bytes)
    findings.warning(fmt::format(
        "{}: a trace grows to {} (rotate_bytes) before a part of it can be deleted, and all are to "
        "be kept within {} (keep_bytes): set rotate_bytes lower, or keep_bytes higher",
        folder, gigabytes(static_cast<double>(recording.rotate_bytes)),
        gigabytes(static_cast<double>(recording.keep_bytes))));
  // Telegrams of usual length, their replies and samples.csv: 0.2 MB a second at a cycle of 4 ms.
  constexpr double kADay = 0.2e6 * 86'400;
  const double left = (free - kept) / kADay;
  const bool deletes = recording.keep_bytes > 0 || recording.keep.count() > 0;
  const auto text = fmt::format("{}: {} free, enough for {} of streaming at 4 ms", folder,
                                gigabytes(free), days_text(left));
  if (deletes)
    findings.ok(text + "; the oldest recordings are deleted by keep_bytes and keep_days");
  else if (left < 1)
    findings.warning(text + ": make room, or set keep_bytes");
  else
    findings.ok(text + "; none is deleted (keep_bytes, keep_days)");
}

}  // namespace

Machine look_at_machine(const RobotSettings& robot, rsi::Transport transport) {
  Machine machine;
  machine.root = geteuid() == 0;
  machine.addresses = own_addresses();
  try_to_listen(robot, transport, machine);
  if (robot.controller)
    machine.towards_controller = rsi::local_address_towards({*robot.controller, 1});
  if (robot.real_time.wish != RealTime::off) machine.real_time = try_real_time(robot.real_time);
  const auto folder = nearest(robot.output / robot.name);
  machine.room = disk_room(folder);
  std::error_code unknown;
  if (!std::filesystem::is_directory(folder, unknown) && !unknown)
    machine.cannot_write = folder.string() + ": is no folder: move it away, or set `output`";
  else if (::access(folder.c_str(), W_OK | X_OK) != 0)
    machine.cannot_write = (robot.output / robot.name).string() + ": cannot be written (" +
                           std::generic_category().message(errno) +
                           "): give the folder to the user who runs sweepd, or set `output`";
  return machine;
}

void judge_machine(const Machine& machine, const RobotSettings& robot,
                   const rsi::EthernetConfig* ethernet, Findings& findings) {
  judge_port(machine, robot, findings);
  judge_addresses(machine, robot, ethernet, findings);
  judge_real_time(machine, robot, findings);
  judge_disk(machine, robot, findings);
  if (machine.root)
    findings.line("note",
                  "root may do all this, which proves nothing for the service: run `sudo -u sweepd "
                  "sweepd check`");
}

}  // namespace sweepd
