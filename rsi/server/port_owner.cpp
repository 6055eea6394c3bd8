#include "rsi/server/port_owner.hpp"

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include <arpa/inet.h>
#include <unistd.h>

namespace rsi {
namespace {

namespace fs = std::filesystem;

std::uint32_t hexadecimal(std::string_view text) {
  std::uint32_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return value;
}

/// Whether a socket at `text`, "0100007F:C000" as /proc/net writes it, keeps others from `wanted`.
bool takes(const std::string& text, const Endpoint& wanted) {
  const auto colon = text.find(':');
  if (colon == text.npos || hexadecimal(text.substr(colon + 1)) != wanted.port) return false;
  if (colon != 8) return true;  // IPv6: a socket for all addresses takes those of IPv4 too
  const auto address = ntohl(hexadecimal(text.substr(0, colon)));
  return address == wanted.address || address == 0 || wanted.address == 0;
}

/// The sockets at this endpoint, as links in /proc/PID/fd name them: "socket:[4711]".
std::set<std::string> sockets_at(Transport transport, const Endpoint& wanted) {
  constexpr std::string_view kListening = "0A";
  std::set<std::string> sockets;
  const std::string protocol = transport == Transport::udp ? "udp" : "tcp";
  for (const auto& table : {protocol, protocol + '6'}) {
    std::ifstream lines("/proc/net/" + table);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string slot, local, remote, state, queues, timer, retransmits, user, timeout, inode;
      words >> slot >> local >> remote >> state >> queues >> timer >> retransmits >> user >>
          timeout >> inode;
      if (transport == Transport::tcp && state != kListening) continue;
      if (takes(local, wanted)) sockets.insert("socket:[" + inode + "]");
    }
  }
  return sockets;
}

bool has_one_of(const fs::path& process, const std::set<std::string>& sockets) {
  std::error_code error;
  for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code gone;
    if (sockets.contains(fs::read_symlink(*file, gone).string())) return true;
  }
  return false;
}

}  // namespace

std::string text(Transport transport) {
  return transport == Transport::udp ? "UDP" : "TCP";
}

std::string port_owner(Transport transport, const Endpoint& local) {
  const auto sockets = sockets_at(transport, local);
  if (sockets.empty()) return {};
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error)) {
    const auto id = process->path().filename().string();
    if (id.find_first_not_of("0123456789") != id.npos || !has_one_of(*process, sockets)) continue;
    std::string name;
    std::getline(std::ifstream(process->path() / "comm"), name);
    name += " (process " + id + ')';
    return name;
  }
  return {};
}

std::string cannot_listen(Transport transport, const Endpoint& local, int error,
                          std::string_view other_port) {
  const auto place = text(transport) + ' ' + text(local);
  if (error != EADDRINUSE)
    return "cannot listen on " + place + " (" + std::generic_category().message(error) +
           (error == EACCES ? "): ports below 1024 are for the system: use a higher one"
                            : "): use an address of this machine, or 0.0.0.0");
  const auto owner = port_owner(transport, local);
  const bool own = owner.ends_with("(process " + std::to_string(::getpid()) + ')');
  std::string text = place + " is in use by ";
  if (own)
    text += "this program itself: ";
  else
    text += owner.empty() ? "another program: stop that one (as root, `ss -ulptn` names it), or "
                          : "another program, " + owner + ": stop it, or ";
  return text.append(other_port);
}

}  // namespace rsi
