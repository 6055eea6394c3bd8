#include "rsi/controller/controller_link.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rsi {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

std::unique_ptr<ControllerSocket> open_socket(asio::io_context& context,
                                              const EthernetConfig& config,
                                              const ControllerLink::Options& options) {
  const auto& server = options.controller.server;
  if (server.address == 0 || server.port == 0)
    throw std::invalid_argument("a controller cannot send to " + text(server) +
                                ": give address and port of the RSI server");
  if (config.protocol == EthernetConfig::Protocol::UDP)
    return ControllerSocket::udp(context, options.local, server);
  return ControllerSocket::tcp(context, options.local, server,
                               config.length_first ? options.length : LengthPrefix::none);
}

}  // namespace

ControllerLink::ControllerLink(const EthernetConfig& config, const Options& options)
    : controller_(config, options.controller),
      wire_(options.faults, options.seed),
      cycle_(options.controller.cycle),
      socket_(open_socket(context_, config, options)),
      timer_(context_) {}

ControllerLink::Report ControllerLink::run(Program program, Progress progress) {
  program_ = std::move(program);
  progress_ = std::move(progress);
  due_ = Clock::now();
  wait_for_replies();
  wait_for_cycle();
  context_.run();
  report_.controller = controller_.counts();
  report_.wire = wire_.counts();
  report_.latency = controller_.latency();
  report_.first_fault = controller_.first_fault();
  for (const auto kind : {ReplyFault::missing_tag, ReplyFault::not_zero})
    if (report_.controller.remarks_of(kind) != 0)
      report_.first_remarks.push_back(controller_.first_fault(kind));
  return report_;
}

void ControllerLink::wait_for_cycle() {
  timer_.expires_at(due_);
  timer_.async_wait([this](const error_code& error) {
    if (!error) on_cycle();
  });
}

void ControllerLink::on_cycle() {
  // What came in before belongs to the cycle that ends now, even if the timer was noticed first.
  receive();
  if (!socket_->broken().empty()) return end(End::disconnected);
  if (stop_) return end(End::stopped);
  if (program_over_) return end(End::done);

  if (next_cycle_ == 0) due_ = Clock::now();  // the first telegram begins the grid
  if (program_(next_cycle_, values_)) {
    ++next_cycle_;
    if (Clock::now() - due_ > cycle_ / 2) {
      controller_.skip_cycle();
      ++report_.skipped;
    } else if (!send_telegram()) {
      return end(End::timed_out);
    }
  } else {
    // The last telegram had a whole cycle, unless it was held back.
    program_over_ = true;
    const auto& held_back = wire_.flush();
    if (held_back.empty()) return end(End::done);
    for (const auto& datagram : held_back) send(datagram.payload);
  }

  const auto a_second = std::max<Clock::duration::rep>(1, std::chrono::seconds(1) / cycle_);
  if (progress_ && next_cycle_ % static_cast<std::uint64_t>(a_second) == 0) progress_(controller_);

  due_ += cycle_;
  if (!waiting_for_replies_) wait_for_replies();
  wait_for_cycle();
}

bool ControllerLink::send_telegram() {
  telegram_.clear();
  if (!controller_.next_telegram(values_, telegram_)) return false;
  const auto& datagrams = wire_.pass(telegram_);
  controller_.sent(Clock::now().time_since_epoch());
  for (const auto& datagram : datagrams) send(datagram.payload);
  return true;
}

void ControllerLink::send(std::string_view datagram) {
  const error_code error = socket_->send(datagram);
  // A broken connection is told as such.
  if (error && socket_->broken().empty() && report_.send_failures++ == 0)
    report_.first_send_failure = error.message();
}

void ControllerLink::wait_for_replies() {
  waiting_for_replies_ = true;
  socket_->async_wait([this](const error_code& error) {
    // After an error the next cycle waits again: a lasting one must not spin.
    waiting_for_replies_ = false;
    if (error) return;
    receive();
    if (!socket_->broken().empty()) return end(End::disconnected);
    wait_for_replies();
  });
}

void ControllerLink::receive() {
  socket_->receive([this](std::string_view reply, const Endpoint& source) {
    controller_.on_reply(reply, source, Clock::now().time_since_epoch());
  });
}

void ControllerLink::end(End end) {
  controller_.finish();
  report_.end = end;
  report_.disconnection = socket_->broken();
  socket_->close();
  context_.stop();
}

}  // namespace rsi
