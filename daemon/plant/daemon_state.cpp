#include "daemon/plant/daemon_state.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kLoopback = 0x7f000001;
constexpr std::size_t kMostTold = 80;
constexpr std::size_t kLargest = std::size_t{16} << 20;

class Socket {
 public:
  Socket() : handle_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval patience{1, 0};
    for (const int way : {SO_RCVTIMEO, SO_SNDTIMEO})
      ::setsockopt(handle_, SOL_SOCKET, way, &patience, sizeof patience);
  }
  ~Socket() {
    if (handle_ >= 0) ::close(handle_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  [[nodiscard]] int handle() const { return handle_; }

 private:
  int handle_;
};

/// The answer with its head; empty where there is none, with errno.
std::string answer(const rsi::Endpoint& to, const std::string& request) {
  const Socket socket;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(to.port);
  address.sin_addr.s_addr = htonl(to.address);
  if (::connect(socket.handle(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return {};
  if (::send(socket.handle(), request.data(), request.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(request.size()))
    return {};
  std::string text;
  char part[8192];
  ssize_t size = 0;
  // Whoever sends a byte now and then must not hold the publisher up.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  while (text.size() < kLargest && std::chrono::steady_clock::now() < end &&
         (size = ::recv(socket.handle(), part, sizeof part, 0)) > 0)
    text.append(part, static_cast<std::size_t>(size));
  return size < 0 ? std::string() : text;
}

DaemonState trouble(const std::string& what) {
  return {what, {}};
}

}  // namespace

DaemonState parse_daemon_state(const std::string& body, const std::string& at) {
  const Json all = Json::parse(body, nullptr, false);
  if (text_of(all, "schema") != schemas::kState) return trouble("what answers is no sweepd");
  DaemonState state;
  for (const Json& robot : list_of(all, "robots")) {
    Json one = {{"schema", text_of(all, "schema")}, {"at", at}};
    for (const auto& [key, value] : all.items())
      if (key != "schema") one[key] = value;
    one["robots"] = Json::array({robot});
    state.robots[text_of(robot, "robot")] = std::move(one);
  }
  return state;
}

DaemonState parse_daemon_answer(const std::string& answer, const std::string& where,
                                const std::string& at) {
  const auto body = answer.find("\r\n\r\n");
  if (!answer.starts_with("HTTP/1.1 ") || body == answer.npos)
    return trouble("what answers on " + where + " is no sweepd");
  // It is told to the plant: a text from elsewhere may be neither UTF-8 nor short.
  if (!answer.starts_with("HTTP/1.1 200"))
    return trouble(where + " answers: " +
                   clean_text(answer.substr(0, std::min(answer.find('\r'), kMostTold))));
  return parse_daemon_state(answer.substr(body + 4), at);
}

DaemonState ask_daemon(const rsi::Endpoint& pages) {
  const rsi::Endpoint to{pages.address == 0 ? kLoopback : pages.address, pages.port};
  const std::string where = "http://" + rsi::text(to) + "/api/state";
  const std::string text = answer(
      to, "GET /api/state HTTP/1.1\r\nHost: " + rsi::text(to) + "\r\nConnection: close\r\n\r\n");
  if (text.empty())
    return trouble("sweepd does not answer on " + where + " (" +
                   std::generic_category().message(errno) + ')');
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return parse_daemon_answer(text, where, utc_text(now));
}

}  // namespace sweepd
