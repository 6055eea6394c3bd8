#include "rsi/controller_link.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rsi {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;
using std::chrono::nanoseconds;

namespace {

udp::endpoint to_asio(const Endpoint& endpoint) {
  return {asio::ip::address_v4(endpoint.address), endpoint.port};
}

Endpoint from_asio(const udp::endpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

}  // namespace

ControllerLink::ControllerLink(const EthernetConfig& config, const Options& options)
    : controller_(config, options.controller),
      wire_(options.faults, options.seed),
      cycle_(options.controller.cycle),
      socket_(context_),
      timer_(context_),
      server_(to_asio(options.controller.server)) {
  if (options.controller.server.address == 0 || options.controller.server.port == 0)
    throw std::invalid_argument("a controller cannot send to " + text(options.controller.server) +
                                ": give address and port of the RSI server");
  error_code error;
  socket_.open(udp::v4(), error);
  if (!error) socket_.bind(to_asio(options.local), error);
  if (!error) socket_.non_blocking(true, error);
  if (error)
    throw std::runtime_error("cannot send from " + text(options.local) + ": " + error.message() +
                             ": choose an address of this machine and a free port");
}

Endpoint ControllerLink::local() const {
  return from_asio(socket_.local_endpoint());
}

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
  if (stop_) return end(End::stopped);
  if (program_over_) return end(End::done);

  if (program_(next_cycle_, values_)) {
    telegram_.clear();
    if (!controller_.next_telegram(values_, telegram_)) return end(End::timed_out);
    const auto& datagrams = wire_.pass(telegram_);
    controller_.sent(Clock::now().time_since_epoch());
    for (const auto datagram : datagrams) send(datagram);
    ++next_cycle_;
  } else {
    // The last telegram had a whole cycle, unless it was held back.
    program_over_ = true;
    const auto& held_back = wire_.flush();
    if (held_back.empty()) return end(End::done);
    for (const auto datagram : held_back) send(datagram);
  }

  const auto a_second = std::max<Clock::duration::rep>(1, std::chrono::seconds(1) / cycle_);
  if (progress_ && next_cycle_ % static_cast<std::uint64_t>(a_second) == 0) progress_(controller_);

  due_ += cycle_;
  if (const auto overslept = Clock::now() - (due_ - cycle_); overslept > cycle_ / 2) {
    const auto cycles = (overslept + cycle_ - Clock::duration(1)) / cycle_;
    due_ += cycles * cycle_;
    report_.skipped += static_cast<std::uint64_t>(cycles);
  }
  if (!waiting_for_replies_) wait_for_replies();
  wait_for_cycle();
}

void ControllerLink::send(std::string_view datagram) {
  error_code error;
  socket_.send_to(asio::buffer(datagram.data(), datagram.size()), server_, 0, error);
  if (error && report_.send_failures++ == 0) report_.first_send_failure = error.message();
}

void ControllerLink::wait_for_replies() {
  waiting_for_replies_ = true;
  socket_.async_wait(udp::socket::wait_read, [this](const error_code& error) {
    // After an error the next cycle waits again: a lasting one must not spin.
    waiting_for_replies_ = false;
    if (error) return;
    receive();
    wait_for_replies();
  });
}

void ControllerLink::receive() {
  // Bounded, so that a flood of datagrams cannot hold up the cycle.
  for (int i = 0; i < 64; ++i) {
    udp::endpoint source;
    error_code error;
    const auto size = socket_.receive_from(asio::buffer(received_), source, 0, error);
    if (error == asio::error::would_block) return;
    if (error) continue;  // such as a refusal by ICMP: reading it clears it
    controller_.on_reply({received_.data(), size}, from_asio(source),
                         Clock::now().time_since_epoch());
  }
}

void ControllerLink::end(End end) {
  controller_.finish();
  report_.end = end;
  error_code ignored;
  socket_.close(ignored);
  context_.stop();
}

}  // namespace rsi
