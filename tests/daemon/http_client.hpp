#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace sweepd::test {

/// A thousand connections are more than a process may open by default.
inline void allow_many_files() {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

/// The status line, the headers, and the body.
struct HttpAnswer {
  int status = 0;  ///< 0: the connection was closed instead
  std::string head;
  std::string body;
};

/// A client that sends what it is told, right or wrong, on one connection of the loopback
/// interface.
class HttpClient {
 public:
  explicit HttpClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    server.sin_port = htons(port);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&server), sizeof server) != 0) {
      const int error = errno;
      close(socket_);
      throw std::system_error(error, std::generic_category(), "connect");
    }
    const timeval longest{20, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof longest);
  }
  ~HttpClient() { close(socket_); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// False if the server has closed the connection.
  bool send(std::string_view text) {
    while (!text.empty()) {
      const auto sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// The next answer; without a body if it is one to a HEAD.
  HttpAnswer answer(bool head = false) {
    HttpAnswer answer;
    std::size_t end = 0;
    while ((end = received_.find("\r\n\r\n")) == received_.npos)
      if (!receive()) return answer;
    answer.head = received_.substr(0, end + 2);
    received_.erase(0, end + 4);
    answer.status = std::stoi(answer.head.substr(std::string_view("HTTP/1.1 ").size()));
    const std::string_view length = "Content-Length: ";
    const auto at = answer.head.find(length);
    if (head || at == answer.head.npos) return answer;
    const std::size_t size = std::stoul(answer.head.substr(at + length.size()));
    while (received_.size() < size && receive()) {
    }
    answer.body = received_.substr(0, size);
    received_.erase(0, answer.body.size());
    return answer;
  }
  HttpAnswer get(std::string_view target, std::string_view more_headers = "Host: localhost\r\n") {
    send("GET " + std::string(target) + " HTTP/1.1\r\n" + std::string(more_headers) + "\r\n");
    return answer();
  }
  /// What comes next, until it ends with `end` or the connection is closed.
  std::string until(std::string_view end) {
    std::size_t at = 0;
    while ((at = received_.find(end)) == received_.npos)
      if (!receive()) return std::exchange(received_, {});
    auto text = received_.substr(0, at + end.size());
    received_.erase(0, text.size());
    return text;
  }
  /// Whether the server has closed the connection; waits for it.
  bool closed() {
    while (receive()) {
    }
    return true;
  }
  /// The same at this moment.
  bool closed_now() {
    char byte = 0;
    const auto got = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
  }

 private:
  bool receive() {
    std::array<char, 65536> buffer{};
    const auto size = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
      throw std::runtime_error("the server neither answers nor closes");
    if (size <= 0) return false;
    received_.append(buffer.data(), static_cast<std::size_t>(size));
    return true;
  }

  int socket_;
  std::string received_;
};

}  // namespace sweepd::test
