#include "daemon/page/http_connection.hpp"

#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <netinet/in.h>
#include <netinet/tcp.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnull-dereference"
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#pragma GCC diagnostic pop

namespace sweepd {
namespace {

using namespace std::chrono_literals;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::asio::ip::tcp;
using Error = boost::system::error_code;

using UserTimeout = boost::asio::detail::socket_option::integer<IPPROTO_TCP, TCP_USER_TIMEOUT>;

constexpr std::size_t kLeftover = 64 << 10;
constexpr auto kLinger = 1s;
constexpr int kViewerBuffer = 128 << 10;

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

HttpConnection::HttpConnection(HttpClients& clients, tcp::socket socket)
    : clients_(clients), stream_(std::move(socket)) {}

void HttpConnection::wait(HttpClients::List::iterator place) {
  place_ = place;
  wait();
}

void HttpConnection::close() {
  stream_.close();
  more_ = nullptr;
  auto& all = is_viewer_ ? clients_.viewers : clients_.connections;
  if (place_) all.erase(*std::exchange(place_, std::nullopt));
}

void HttpConnection::tell() {
  if (telling_) return;
  auto news = more_();
  if (!news) return close();
  const auto now = std::chrono::steady_clock::now();
  if (news->empty() && now - told_ < clients_.limits.heartbeat) return;
  told_ = now;
  send(news->empty() ? ":\n\n" : std::move(*news));
}

/// Goes on if all went well, else the connection is closed.
template <typename Next>
auto HttpConnection::then(Next next) {
  return [self = shared_from_this(), next = std::move(next)](Error error, std::size_t size) {
    if (error) return self->close();
    next(size);
  };
}

void HttpConnection::wait() {
  auto& all = clients_.connections;
  if (place_) all.splice(all.end(), all, *place_);
  if (buffer_.size() > 0) return read();
  stream_.expires_after(requests_ == 0 ? clients_.limits.request : clients_.limits.idle);
  stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t size) {
                            buffer_.commit(size);
                            read();
                          }));
}

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(HttpServer::kLargestHeader);
  stream_.expires_after(clients_.limits.request);
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

void HttpConnection::answer() {
  const auto& request = parser_->get();
  const bool has_body = parser_->chunked() || parser_->content_length().value_or(0) > 0;
  bool last = has_body || !request.keep_alive() || ++requests_ >= clients_.limits.requests;
  HttpResponse response;
  try {
    response = clients_.answer({view(request.method_string()), view(request.target()),
                                all(request, http::field::host), all(request, http::field::origin),
                                has_body, all(request, http::field::accept)});
  } catch (const std::exception&) {
    response = {500, HttpResponse{}.type, "this page cannot be made\n"};
  }
  const bool head = request.method() == http::verb::head;
  last = last || response.more;
  if (response.more && !head) {
    if (clients_.viewers.size() < clients_.limits.viewers) return go_on(std::move(response));
    response = {503, HttpResponse{}.type,
                std::to_string(clients_.limits.viewers) +
                    " viewers look already: close one of their pages, or come back later\n"};
  }
  write(std::move(response), request.version(), head, last);
}

/// The answer goes on until one of both ends it: chunks would only repeat what events tell.
void HttpConnection::go_on(HttpResponse response) {
  auto& viewers = clients_.viewers;
  viewers.splice(viewers.end(), clients_.connections, *place_);
  is_viewer_ = true;
  set_head(response, 11);
  response_.keep_alive(false);
  Error ignored;
  stream_.socket().set_option(boost::asio::socket_base::send_buffer_size(kViewerBuffer), ignored);
  stream_.socket().set_option(UserTimeout(static_cast<int>(clients_.limits.request.count())),
                              ignored);  // a viewer whose machine is gone
  more_ = std::move(response.more);
  auto head = (std::ostringstream() << response_.base()).str();
  stream_.expires_never();
  watch();
  send(std::move(head));
  if (viewers.size() == 1) clients_.first_viewer();
}

/// A viewer says nothing more: what comes is its end.
void HttpConnection::watch() {
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t) { watch(); }));
}

void HttpConnection::send(std::string news) {
  telling_ = true;
  news_ = std::move(news);
  stream_.expires_after(clients_.limits.request);
  boost::asio::async_write(stream_, boost::asio::buffer(news_),
                           then([this](std::size_t) { telling_ = false; }));
}

void HttpConnection::refuse(int status, const char* reason) {
  write({status, HttpResponse{}.type, reason}, 11, false, true);
}

void HttpConnection::set_head(const HttpResponse& response, unsigned version) {
  response_ = {static_cast<http::status>(response.status), version};
  response_.set(http::field::content_type,
                beast::string_view(response.type.data(), response.type.size()));
  response_.set(http::field::cache_control,
                beast::string_view(response.cache.data(), response.cache.size()));
  response_.set(http::field::vary, "Accept");
  response_.set("X-Content-Type-Options", "nosniff");
  response_.set("Content-Security-Policy", kPolicy);
}

void HttpConnection::write(HttpResponse response, unsigned version, bool head, bool last) {
  set_head(response, version);
  if (response_.result() == http::status::method_not_allowed)
    response_.set(http::field::allow, "GET, HEAD");
  response_.keep_alive(!last);
  if (!response.more) response_.content_length(response.body.size());
  if (!head) response_.body() = std::move(response.body);
  stream_.expires_after(clients_.limits.request);
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
void HttpConnection::drain() {
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kRoom), then([this](std::size_t size) {
                            drained_ += size;
                            if (drained_ > kLeftover) return close();
                            drain();
                          }));
}

}  // namespace sweepd
