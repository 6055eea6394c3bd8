#include "rsi/server.hpp"

#include <thread>
#include <utility>

#include "rsi/asio.hpp"

#include "rsi/correction_gate.hpp"
#include "rsi/ipoc.hpp"

namespace rsi {
namespace {

void count(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

Timestamp now() noexcept {
  return std::chrono::duration_cast<Timestamp>(std::chrono::system_clock::now().time_since_epoch());
}

std::optional<std::uint32_t> local_address_towards(const Endpoint& peer) {
  boost::asio::io_context context;
  boost::asio::ip::udp::socket socket(context);
  boost::system::error_code error;
  // Connecting a UDP socket sends nothing: it only asks for the way.
  socket.connect({boost::asio::ip::address_v4(peer.address), peer.port}, error);
  if (error) return std::nullopt;
  return socket.local_endpoint().address().to_v4().to_uint();
}

Server::Server(Options options)
    : options_(std::move(options)),
      queue_(options_.queue_bytes),
      current_(options_.controller.value_or(0)) {}

std::chrono::milliseconds Server::longest_look() const noexcept {
  return std::chrono::milliseconds(options_.only_from_the_beginning ? 20 : 100);
}

void Server::set_local(const Endpoint& local) noexcept {
  local_ = local;
  callers_.deaf_until(clock());
}

void Server::add_dropped(std::uint32_t datagrams) noexcept {
  if (datagrams == 0) return;
  dropped_ += datagrams;
  callers_.deaf_until(clock());
}

void Server::warm() noexcept {
  for (int round = 0; round < 3; ++round) {
    static_cast<void>(find_ipoc("<Rob Type=\"KUKA\"><IPOC>18446744073709551615</IPOC></Rob>"));
    static_cast<void>(now());
    if (options_.reply)
      static_cast<void>(moves_nothing(options_.reply->with_ipoc("18446744073709551615")));
  }
}

void Server::settle() const {
  while (serving_) std::this_thread::yield();
}

Server::Counts Server::counts() const noexcept {
  const auto read = [](const auto& counter) { return counter.load(std::memory_order_relaxed); };
  return {read(answered_),  read(superseded_), read(unanswerable_),  read(foreign_),
          read(not_begun_), read(refused_),    read(send_failures_), read(cut_),
          read(dropped_),   read(skipped_),    queue_.overflows()};
}

void Server::serve(std::span<const Datagram> received) noexcept {
  serving_ = true;
  const auto taken = clock();
  std::array<Fate, kMostAtOnce> fates;
  std::size_t newest = received.size();
  std::string_view newest_ipoc;
  for (std::size_t i = 0; i < received.size(); ++i) {
    const auto ipoc = find_ipoc(received[i].payload);
    fates[i] = judge(received[i], ipoc, taken);
    if (fates[i] != Fate::answer) continue;
    newest = i;
    newest_ipoc = ipoc;
  }
  Datagram sent;
  if (newest < received.size()) sent = answer(received[newest], newest_ipoc);

  for (std::size_t i = 0; i < received.size(); ++i) {
    if (fates[i] == Fate::drop) continue;
    if (fates[i] == Fate::answer && i != newest) count(superseded_);
    queue_.push(received[i]);
    if (i == newest && options_.reply) queue_.push(sent);
  }
  serving_ = false;
}

bool Server::may_serve(std::uint32_t address) const noexcept {
  const auto current = current_.load(std::memory_order_relaxed);
  return current == 0 || current == address;
}

Server::Fate Server::judge(const Datagram& received, std::string_view ipoc,
                           Callers::Time taken) noexcept {
  if (received.cut) count(cut_);
  const auto address = received.source.address;
  if (options_.only_from_the_beginning && options_.controller.value_or(address) == address)
    callers_.hear(address, taken);
  auto current = current_.load(std::memory_order_relaxed);
  if (current == 0 && !ipoc.empty()) current_ = current = address;
  if (address != current) {
    count(foreign_);
    return Fate::drop;
  }
  if (ipoc.empty()) {
    count(unanswerable_);
    return Fate::hand_over;
  }
  if (options_.only_from_the_beginning && !callers_.began(address)) {
    count(not_begun_);
    return Fate::hand_over;
  }
  return Fate::answer;
}

Datagram Server::answer(const Datagram& telegram, std::string_view ipoc) noexcept {
  Datagram sent{{}, local_, telegram.source, {}, false};
  if (!options_.reply) return sent;
  const auto reply = options_.reply->with_ipoc(ipoc);
  if (!moves_nothing(reply)) {
    count(refused_);
  } else if (!send(reply, telegram.source)) {
    count(send_failures_);
  } else {
    sent.payload = reply;
    count(answered_);
  }
  sent.time = now();
  return sent;
}

}  // namespace rsi
