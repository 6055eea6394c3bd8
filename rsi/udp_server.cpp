#include "rsi/udp_server.hpp"

#include <stdexcept>
#include <string>
#include <thread>

#include "rsi/ipoc.hpp"

namespace rsi {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;

constexpr std::size_t kLargestDatagram = 65536;
/// At most so many datagrams are taken before one is answered: a flood must not stop the replies.
constexpr int kMostAtOnce = 64;

Timestamp now() {
  return std::chrono::duration_cast<Timestamp>(std::chrono::system_clock::now().time_since_epoch());
}

udp::endpoint to_asio(const Endpoint& endpoint) {
  return {asio::ip::address_v4(endpoint.address), endpoint.port};
}

Endpoint from_asio(const udp::endpoint& endpoint) {
  return {endpoint.address().to_v4().to_uint(), endpoint.port()};
}

void count(std::atomic<std::uint64_t>& counter) {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

std::optional<std::uint32_t> local_address_towards(const Endpoint& peer) {
  asio::io_context context;
  udp::socket socket(context);
  boost::system::error_code error;
  // Connecting a UDP socket sends nothing: it only asks for the way.
  socket.connect(to_asio(peer), error);
  if (error) return std::nullopt;
  return from_asio(socket.local_endpoint()).address;
}

UdpServer::UdpServer(Options options)
    : options_(std::move(options)),
      socket_(context_),
      queue_(options_.queue_bytes),
      current_(options_.controller.value_or(0)) {
  buffers_.fill(Buffer(kLargestDatagram));
  boost::system::error_code error;
  socket_.open(udp::v4(), error);
  if (!error) socket_.bind(to_asio(options_.listen), error);
  if (!error) socket_.non_blocking(true, error);
  if (error == asio::error::address_in_use)
    throw std::runtime_error(
        "UDP " + text(options_.listen) +
        " is in use by another program: stop that one (`ss -ulpn` names it) or "
        "choose another port on both sides");
  if (error)
    throw std::runtime_error("cannot listen on UDP " + text(options_.listen) + " (" +
                             error.message() + "): use an address of this machine, or 0.0.0.0");
  local_ = from_asio(socket_.local_endpoint());
}

void UdpServer::run() {
  wait();
  context_.run();
}

void UdpServer::stop() {
  asio::post(context_, [this] { socket_.cancel(); });
}

UdpServer::Counts UdpServer::counts() const noexcept {
  const auto read = [](const auto& counter) { return counter.load(std::memory_order_relaxed); };
  return {read(answered_), read(superseded_),    read(unanswerable_),
          read(foreign_),  read(send_failures_), queue_.overflows()};
}

void UdpServer::wait() {
  socket_.async_wait(Socket::wait_read, [this](const boost::system::error_code& error) {
    if (error == asio::error::operation_aborted) return;
    serve();
    wait();
  });
}

void UdpServer::serve() {
  // Two buffers take turns: one holds the newest datagram that can be answered, the other receives.
  serving_ = true;
  std::size_t free = 0;
  std::optional<Pending> newest;
  Pending received;
  for (int taken = 0; taken < kMostAtOnce && receive(buffers_[free], received); ++taken) {
    if (!from_controller(received)) {
      count(foreign_);
    } else if (received.ipoc.empty()) {
      count(unanswerable_);
      queue_.push(received.datagram);
    } else {
      if (newest) {
        count(superseded_);
        queue_.push(newest->datagram);
      }
      newest = received;
      free = 1 - free;
    }
  }
  if (newest) answer(*newest);
  serving_ = false;
}

void UdpServer::settle() const {
  while (serving_) std::this_thread::yield();
}

bool UdpServer::receive(Buffer& buffer, Pending& received) {
  udp::endpoint source;
  boost::system::error_code error;
  // An error other than "nothing there" is the echo of an earlier reply that found no listener.
  std::size_t size = 0;
  do {
    size = socket_.receive_from(asio::buffer(buffer), source, 0, error);
  } while (error == asio::error::connection_refused || error == asio::error::interrupted);
  if (error) return false;
  const std::string_view payload(buffer.data(), size);
  received = {{now(), from_asio(source), local_, payload, false}, find_ipoc(payload)};
  return true;
}

bool UdpServer::from_controller(const Pending& received) {
  const auto address = received.datagram.source.address;
  auto current = current_.load(std::memory_order_relaxed);
  if (current == 0 && !received.ipoc.empty()) current_.store(current = address);
  return address == current;
}

void UdpServer::answer(const Pending& pending) {
  Datagram sent{{}, local_, pending.datagram.source, {}, false};
  if (options_.reply) {
    sent.payload = options_.reply->with_ipoc(pending.ipoc);
    boost::system::error_code error;
    socket_.send_to(asio::buffer(sent.payload.data(), sent.payload.size()),
                    to_asio(pending.datagram.source), 0, error);
    sent.time = now();
    count(error ? send_failures_ : answered_);
    if (error) sent.payload = {};
  }
  queue_.push(pending.datagram);
  if (!sent.payload.empty()) queue_.push(sent);
}

}  // namespace rsi
