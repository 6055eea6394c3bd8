#include "daemon/page/http_server.hpp"

#include <list>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>

#include "rsi/asio.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#pragma GCC diagnostic pop

#include "daemon/system/realtime.hpp"
#include "rsi/asio_endpoint.hpp"
#include "rsi/server/port_owner.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;
using Error = boost::system::error_code;

using UserTimeout = boost::asio::detail::socket_option::integer<IPPROTO_TCP, TCP_USER_TIMEOUT>;

/// A page takes nothing from elsewhere, and runs nothing that is not a file of sweepd.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

std::vector<std::string_view> all(const http::fields& fields, http::field name) {
  std::vector<std::string_view> values;
  const auto [first, last] = fields.equal_range(name);
  for (auto at = first; at != last; ++at) values.push_back(view(at->value()));
  return values;
}

}  // namespace

class HttpServer::Running {
 public:
  Running(const rsi::Endpoint& listen, Answer answer, const Limits& limits);
  ~Running();

  [[nodiscard]] rsi::Endpoint local() const { return rsi::from_asio(acceptor_.local_endpoint()); }

 private:
  class Connection;
  using Connections = std::list<std::shared_ptr<Connection>>;

  void accept();
  void admit(tcp::socket socket);
  void tell_viewers();
  void run() noexcept;

  const Answer answer_;
  const Limits limits_;
  boost::asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  boost::asio::steady_timer pause_{context_};
  boost::asio::steady_timer pace_{context_};
  Connections connections_;  // the one that has waited longest for its client is the first
  Connections viewers_;      // the one that came first is the first
  std::thread thread_;
};

/// One client. Lives as long as it has something to wait for.
class HttpServer::Running::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Running& server, tcp::socket socket) : server_(server), stream_(std::move(socket)) {}

  /// For the next request; `place` is this one's among the connections.
  void wait(Connections::iterator place) {
    place_ = place;
    wait();
  }
  void close() {
    stream_.close();
    more_ = nullptr;
    auto& all = is_viewer_ ? server_.viewers_ : server_.connections_;
    if (place_) all.erase(*std::exchange(place_, std::nullopt));
  }
  /// To a viewer, unless the last news are still on their way.
  void tell() {
    if (telling_) return;
    auto news = more_();
    if (!news) return close();
    const auto now = std::chrono::steady_clock::now();
    if (news->empty() && now - told_ < server_.limits_.heartbeat) return;
    told_ = now;
    send(news->empty() ? ":\n\n" : std::move(*news));
  }

 private:
  static constexpr std::size_t kRoom = 2 * kLargestHeader;
  static constexpr std::size_t kLeftover = 64 << 10;
  static constexpr auto kLinger = 1s;
  static constexpr int kViewerBuffer = 128 << 10;

  /// Goes on if all went well, else the connection is closed.
  template <typename Next>
  auto then(Next next) {
    return [self = shared_from_this(), next = std::move(next)](Error error, std::size_t size) {
      if (error) return self->close();
      next(size);
    };
  }

  void wait() {
    auto& all = server_.connections_;
    if (place_) all.splice(all.end(), all, *place_);
    if (buffer_.size() > 0) return read();
    stream_.expires_after(requests_ == 0 ? server_.limits_.request : server_.limits_.idle);
    stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t size) {
                              buffer_.commit(size);
                              read();
                            }));
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    stream_.expires_after(server_.limits_.request);
    http::async_read_header(
        stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
          static const auto& protocol = http::make_error_code(http::error::bad_target).category();
          if (!error) return self->answer();
          if (error == http::error::header_limit)
            return self->refuse(431, "the header of the request is too large\n");
          if (error.category() == protocol && error != http::error::end_of_stream &&
              error != http::error::partial_message)
            return self->refuse(400, "this is no HTTP/1.1\n");
          self->close();
        });
  }

  void answer() {
    const auto& request = parser_->get();
    const bool has_body = parser_->chunked() || parser_->content_length().value_or(0) > 0;
    bool last = has_body || !request.keep_alive() || ++requests_ >= server_.limits_.requests;
    HttpResponse response;
    try {
      response = server_.answer_(
          {view(request.method_string()), view(request.target()), all(request, http::field::host),
           all(request, http::field::origin), has_body, all(request, http::field::accept)});
    } catch (const std::exception&) {
      response = {500, HttpResponse{}.type, "this page cannot be made\n"};
    }
    const bool head = request.method() == http::verb::head;
    last = last || response.more;
    if (response.more && !head) {
      if (server_.viewers_.size() < server_.limits_.viewers) return go_on(std::move(response));
      response = {503, HttpResponse{}.type,
                  std::to_string(server_.limits_.viewers) +
                      " viewers look already: close one of their pages, or come back later\n"};
    }
    write(std::move(response), request.version(), head, last);
  }

  /// The answer goes on until one of both ends it: chunks would only repeat what events tell.
  void go_on(HttpResponse response) {
    auto& viewers = server_.viewers_;
    viewers.splice(viewers.end(), server_.connections_, *place_);
    is_viewer_ = true;
    set_head(response, 11);
    response_.keep_alive(false);
    Error ignored;
    stream_.socket().set_option(boost::asio::socket_base::send_buffer_size(kViewerBuffer), ignored);
    stream_.socket().set_option(UserTimeout(static_cast<int>(server_.limits_.request.count())),
                                ignored);  // a viewer whose machine is gone
    more_ = std::move(response.more);
    auto head = (std::ostringstream() << response_.base()).str();
    stream_.expires_never();
    watch();
    send(std::move(head));
    if (viewers.size() == 1) server_.tell_viewers();
  }

  /// A viewer says nothing more: what comes is its end.
  void watch() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t) { watch(); }));
  }

  void send(std::string news) {
    telling_ = true;
    news_ = std::move(news);
    stream_.expires_after(server_.limits_.request);
    boost::asio::async_write(stream_, boost::asio::buffer(news_),
                             then([this](std::size_t) { telling_ = false; }));
  }

  void refuse(int status, const char* reason) {
    write({status, HttpResponse{}.type, reason}, 11, false, true);
  }

  void set_head(const HttpResponse& response, unsigned version) {
    response_ = {static_cast<http::status>(response.status), version};
    response_.set(http::field::content_type,
                  beast::string_view(response.type.data(), response.type.size()));
    response_.set(http::field::cache_control,
                  beast::string_view(response.cache.data(), response.cache.size()));
    response_.set(http::field::vary, "Accept");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Content-Security-Policy", kPolicy);
  }

  void write(HttpResponse response, unsigned version, bool head, bool last) {
    set_head(response, version);
    if (response_.result() == http::status::method_not_allowed)
      response_.set(http::field::allow, "GET, HEAD");
    response_.keep_alive(!last);
    if (!response.more) response_.content_length(response.body.size());
    if (!head) response_.body() = std::move(response.body);
    stream_.expires_after(server_.limits_.request);
    http::async_write(stream_, response_, then([this, last](std::size_t) {
                        if (!last) return wait();
                        Error ignored;
                        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                        stream_.expires_after(kLinger);
                        drain();
                      }));
  }

  /// What the client still sends is taken, within limits: else the system would reset the
  /// connection, and the client perhaps not see the answer.
  void drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t size) {
                              drained_ += size;
                              if (drained_ > kLeftover) return close();
                              drain();
                            }));
  }

  Running& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kRoom};
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::string_body> response_;
  std::optional<Connections::iterator> place_;
  std::size_t requests_ = 0;
  std::size_t drained_ = 0;

  // Of a viewer:
  bool is_viewer_ = false;
  bool telling_ = false;
  std::string news_;  // on its way
  std::function<std::optional<std::string>()> more_;
  std::chrono::steady_clock::time_point told_{};
};

HttpServer::Running::Running(const rsi::Endpoint& listen, Answer answer, const Limits& limits)
    : answer_(std::move(answer)), limits_(limits) {
  try {
    const auto endpoint = rsi::to_asio<tcp>(listen);
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
  } catch (const boost::system::system_error& error) {
    const auto owner = rsi::port_owner(rsi::Transport::tcp, listen);
    throw std::runtime_error("cannot serve pages on " + rsi::text(listen) + " (" +
                             error.code().message() + (owner.empty() ? "" : ", " + owner) +
                             "): choose another port with `listen` of [http], or \"off\"");
  }
  accept();
  thread_ = std::thread([this] { run(); });
}

HttpServer::Running::~Running() {
  context_.stop();
  thread_.join();
}

void HttpServer::Running::accept() {
  acceptor_.async_accept([this](Error error, tcp::socket socket) {
    try {
      if (!error) admit(std::move(socket));
    } catch (const std::exception&) {
      error = boost::asio::error::no_memory;
    }
    if (!error) return accept();
    if (!viewers_.empty()) viewers_.front()->close();
    pause_.expires_after(100ms);  // no file or memory left: it would fail again at once
    pause_.async_wait([this](Error) { accept(); });
  });
}

void HttpServer::Running::admit(tcp::socket socket) {
  if (connections_.size() >= limits_.connections) connections_.front()->close();
  connections_.push_back(std::make_shared<Connection>(*this, std::move(socket)));
  connections_.back()->wait(std::prev(connections_.end()));
}

void HttpServer::Running::tell_viewers() {
  for (auto viewer = viewers_.begin(); viewer != viewers_.end();) {
    const auto one = *viewer++;  // it may go
    try {
      one->tell();
    } catch (const std::exception&) {
      one->close();
    }
  }
  if (viewers_.empty()) return;
  pace_.expires_after(limits_.pace);
  pace_.async_wait([this](Error error) {
    if (!error) tell_viewers();
  });
}

void HttpServer::Running::run() noexcept {
  name_thread("http");
  take(Share::low);
  while (!context_.stopped()) {
    try {
      context_.run();
    } catch (const std::exception&) {
      // Out of memory, perhaps: that connection is given up.
    }
  }
}

HttpServer::HttpServer(const rsi::Endpoint& listen, Answer answer, const Limits& limits)
    : running_(std::make_unique<Running>(listen, std::move(answer), limits)) {}

HttpServer::~HttpServer() = default;

rsi::Endpoint HttpServer::local() const {
  return running_->local();
}

}  // namespace sweepd
