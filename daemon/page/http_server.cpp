#include "daemon/page/http_server.hpp"

#include <stdexcept>
#include <thread>
#include <utility>

#include "rsi/asio.hpp"

#include "daemon/page/http_connection.hpp"
#include "daemon/system/realtime.hpp"
#include "rsi/server/port_owner.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using boost::asio::ip::tcp;
using Error = boost::system::error_code;

}  // namespace

class HttpServer::Running {
 public:
  Running(const rsi::Endpoint& listen, Answer answer, const Limits& limits);
  ~Running();

  [[nodiscard]] rsi::Endpoint local() const { return rsi::from_asio(acceptor_.local_endpoint()); }

 private:
  void accept();
  void admit(tcp::socket socket);
  void tell_viewers();
  void run() noexcept;

  boost::asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  boost::asio::steady_timer pause_{context_};
  boost::asio::steady_timer pace_{context_};
  HttpClients clients_;
  std::thread thread_;
};

HttpServer::Running::Running(const rsi::Endpoint& listen, Answer answer, const Limits& limits)
    : clients_{std::move(answer), limits, [this] { tell_viewers(); }, {}, {}} {
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
    if (!clients_.viewers.empty()) clients_.viewers.front()->close();
    pause_.expires_after(100ms);  // no file or memory left: it would fail again at once
    pause_.async_wait([this](Error) { accept(); });
  });
}

void HttpServer::Running::admit(tcp::socket socket) {
  if (clients_.connections.size() >= clients_.limits.connections)
    clients_.connections.front()->close();
  clients_.connections.push_back(std::make_shared<HttpConnection>(clients_, std::move(socket)));
  clients_.connections.back()->wait(std::prev(clients_.connections.end()));
}

void HttpServer::Running::tell_viewers() {
  for (auto viewer = clients_.viewers.begin(); viewer != clients_.viewers.end();) {
    const auto one = *viewer++;  // it may go
    try {
      one->tell();
    } catch (const std::exception&) {
      one->close();
    }
  }
  if (clients_.viewers.empty()) return;
  pace_.expires_after(clients_.limits.pace);
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
