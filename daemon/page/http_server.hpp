#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include "daemon/page/http_pages.hpp"
#include "rsi/endpoint.hpp"

namespace sweepd {

/// Serves pages over HTTP/1.1 on a thread of its own, which lets all others go first. Whatever
/// clients do, it takes bounded memory and time; nothing but the answers is shared with them.
///
/// An answer that goes on, to a viewer, is asked for more at a steady pace, and not before the
/// viewer has taken what was sent: who does not in the time of a request is let go. Where files or
/// memory run out, viewers go first.
class HttpServer {
 public:
  using Answer = std::function<HttpResponse(const HttpRequest&)>;

  struct Limits {
    std::size_t connections = 64;   ///< of one more, that which was idle longest is closed
    std::size_t requests = 10'000;  ///< on one connection
    std::chrono::milliseconds request{5000};  ///< for one to come whole, or its answer to go
    std::chrono::milliseconds idle{30'000};   ///< from one answer to the next request
    std::size_t viewers = 8;  ///< of answers that go on, beside the connections; one more gets 503
    std::chrono::milliseconds pace{200};        ///< of such an answer
    std::chrono::milliseconds heartbeat{5000};  ///< an empty line where there is nothing to tell
  };
  static constexpr std::size_t kLargestHeader = 8192;  ///< of a request, in bytes

  /// Listens. `answer` is called on its thread; an exception of it becomes a 500. Throws
  /// std::runtime_error if the port is not to be had, and says who has it.
  HttpServer(const rsi::Endpoint& listen, Answer answer)
      : HttpServer(listen, std::move(answer), Limits{}) {}
  HttpServer(const rsi::Endpoint& listen, Answer answer, const Limits& limits);
  ~HttpServer();  ///< closes all connections
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] rsi::Endpoint local() const;

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace sweepd
