#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "rsi/asio.hpp"

#include "rsi/endpoint.hpp"
#include "rsi/telegram/tcp_framer.hpp"

namespace rsi {

/// A controller's end of the link: telegrams out, replies in. Neither call waits.
class ControllerSocket {
 public:
  using OnReply = std::function<void(std::string_view reply, const Endpoint& source)>;

  /// Throws std::runtime_error with what to do.
  [[nodiscard]] static std::unique_ptr<ControllerSocket> udp(boost::asio::io_context& context,
                                                             const Endpoint& local,
                                                             const Endpoint& server);
  /// Connects, and waits for that at most five seconds. Throws std::runtime_error with what to do.
  /// A length stands before telegrams, and must stand before replies, in this form.
  [[nodiscard]] static std::unique_ptr<ControllerSocket> tcp(boost::asio::io_context& context,
                                                             const Endpoint& local,
                                                             const Endpoint& server,
                                                             LengthPrefix length);

  virtual ~ControllerSocket() = default;
  ControllerSocket(const ControllerSocket&) = delete;
  ControllerSocket& operator=(const ControllerSocket&) = delete;

  [[nodiscard]] virtual Endpoint local() const = 0;
  virtual boost::system::error_code send(std::string_view telegram) = 0;
  /// Hands over what has come; of a flood only a part at a time.
  virtual void receive(const OnReply& on_reply) = 0;
  /// `handler` is called once receive() has something to do.
  virtual void async_wait(std::function<void(const boost::system::error_code&)> handler) = 0;
  virtual void close() = 0;

  /// Why nothing can be sent or received any more; empty while it can. UDP has no such state.
  [[nodiscard]] const std::string& broken() const { return broken_; }

 protected:
  ControllerSocket() = default;
  void break_off(std::string reason) {
    if (broken_.empty()) broken_ = std::move(reason);
  }

 private:
  std::string broken_;
};

}  // namespace rsi
