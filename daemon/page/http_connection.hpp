#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>

#include "rsi/asio.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#pragma GCC diagnostic pop

#include "daemon/page/http_server.hpp"

namespace sweepd {

class HttpConnection;

/// All connections of a server, which share its limits. Of its thread.
struct HttpClients {
  using List = std::list<std::shared_ptr<HttpConnection>>;

  HttpServer::Answer answer;
  HttpServer::Limits limits;
  std::function<void()> first_viewer;  ///< called when there is one to be told
  List connections;  ///< the one that has waited longest for its client is the first
  List viewers;      ///< the one that came first is the first
};

/// One client. Lives as long as it has something to wait for. Of the server's thread.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(HttpClients& clients, boost::asio::ip::tcp::socket socket);

  /// For the next request; `place` is this one's among the connections.
  void wait(HttpClients::List::iterator place);
  void close();
  /// To a viewer, unless the last news are still on their way.
  void tell();

 private:
  template <typename Next>
  auto then(Next next);
  void wait();
  void read();
  void answer();
  void go_on(HttpResponse response);
  void watch();
  void send(std::string news);
  void refuse(int status, const char* reason);
  void set_head(const HttpResponse& response, unsigned version);
  void write(HttpResponse response, unsigned version, bool head, bool last);
  void drain();

  static constexpr std::size_t kRoom = 2 * HttpServer::kLargestHeader;

  HttpClients& clients_;
  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_{kRoom};
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  boost::beast::http::response<boost::beast::http::string_body> response_;
  std::optional<HttpClients::List::iterator> place_;
  std::size_t requests_ = 0;
  std::size_t drained_ = 0;

  // Of a viewer:
  bool is_viewer_ = false;
  bool telling_ = false;
  std::string news_;  // on its way
  std::function<std::optional<std::string>()> more_;
  std::chrono::steady_clock::time_point told_{};
};

}  // namespace sweepd
