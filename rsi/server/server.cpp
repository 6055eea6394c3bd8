#include "rsi/server/server.hpp"

#include <charconv>
#include <string_view>
#include <thread>
#include <utility>

#include "rsi/asio.hpp"

#include "rsi/telegram/correction_gate.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace rsi {
namespace {

void count(std::atomic<std::uint64_t>& counter) noexcept {
  counter.fetch_add(1, std::memory_order_relaxed);
}

/// In a row, up to this telegram, by its <Delay>; 0 where it has none.
std::uint64_t missed_replies(std::string_view telegram) noexcept {
  constexpr std::string_view kDelay = "<Delay D=\"";
  const auto at = telegram.find(kDelay);
  std::uint64_t missed = 0;
  if (at != telegram.npos)
    std::from_chars(telegram.data() + at + kDelay.size(), telegram.data() + telegram.size(),
                    missed);
  return missed;
}

}  // namespace

Timestamp now() noexcept {
  return std::chrono::duration_cast<Timestamp>(std::chrono::system_clock::now().time_since_epoch());
}

std::optional<std::uint32_t> local_address_towards(const Endpoint& peer) {
  boost::asio::io_context context;
  using boost::asio::ip::udp;
  udp::socket socket(context);
  boost::system::error_code error;
  // Connecting a UDP socket sends nothing: it only asks for the way.
  socket.connect(to_asio<udp>(peer), error);
  if (error) return std::nullopt;
  return from_asio(socket.local_endpoint()).address;
}

Server::Server(Options options) : options_(std::move(options)), queue_(options_.queue_bytes) {}

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
    if (!options_.reply) continue;
    for (const auto form : {Form::flat, form_of("<Rob><Dat TaskType=\"b\">")})
      static_cast<void>(moves_nothing(options_.reply->with_ipoc("18446744073709551615", form)));
  }
}

void Server::settle() const {
  while (serving_) std::this_thread::yield();
}

Server::Counts Server::counts() const noexcept {
  const auto read = [](const auto& counter) { return counter.load(std::memory_order_relaxed); };
  return {read(answered_),  read(superseded_), read(unanswerable_),  read(foreign_),
          read(not_begun_), read(refused_),    read(send_failures_), read(cut_),
          read(dropped_),   read(skipped_),    queue_.overflows(),   read(missed_),
          read(copies_)};
}

void Server::hand_over_reply(const Datagram& reply) noexcept {
  serving_ = true;
  const auto controller = reply.destination.address;
  if (const auto rank = callers_.rank(controller); rank && may_serve(controller))
    queue_.push(reply, {true, *rank == Callers::kSteps});
  serving_ = false;
}

void Server::serve(std::span<const Datagram> received) noexcept {
  serving_ = true;
  const auto taken = clock();
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): set for each of `received`
  std::array<Fate, kMostAtOnce> fates;
  std::optional<Candidate> newest;
  for (std::size_t i = 0; i < received.size(); ++i) {
    const auto& source = received[i].source;
    std::string_view digits;
    fates[i] = judge(received[i], digits, taken);
    if (digits.empty()) continue;
    const Candidate candidate{i, digits, *ipoc_number(digits), source};
    if (fates[i] == Fate::answer && (!newest || displaces(candidate, *newest))) newest = candidate;
  }
  Datagram sent;
  if (newest) sent = answer(received[newest->at], newest->digits);

  for (std::size_t i = 0; i < received.size(); ++i) {
    if (fates[i] == Fate::drop) continue;
    const bool answered = newest && i == newest->at;
    if (fates[i] == Fate::answer && !answered) count(superseded_);
    const bool streams = callers_.rank(received[i].source.address) == Callers::kSteps;
    queue_.push(received[i], {false, streams});
    if (answered && options_.reply) queue_.push(sent, {true, streams});
  }
  serving_ = false;
}

bool Server::may_serve(std::uint32_t address) noexcept {
  if (options_.controller) return address == *options_.controller;
  if (forget_.exchange(false)) callers_.forget_controller();
  return callers_.may_be_controller(address);
}

Server::Fate Server::judge(const Datagram& received, std::string_view& digits,
                           Callers::Time taken) noexcept {
  if (received.cut) count(cut_);
  const auto address = received.source.address;
  // Strangers' bytes are not looked at.
  if (!may_serve(address)) {
    if (!options_.controller) callers_.hear(address, taken);
    count(foreign_);
    return Fate::drop;
  }
  callers_.hear(address, taken);
  digits = find_ipoc(received.payload);
  if (digits.empty()) {
    const bool known = options_.controller || callers_.rank(address);
    count(known ? unanswerable_ : foreign_);
    return known ? Fate::hand_over : Fate::drop;
  }
  const bool begins = options_.only_from_the_beginning && !callers_.began(address);
  callers_.telegram(received.source, *ipoc_number(digits), taken,
                    begins ? missed_replies(received.payload) : 0);
  if (options_.only_from_the_beginning && !callers_.began(address)) {
    count(not_begun_);
    return Fate::hand_over;
  }
  return Fate::answer;
}

bool Server::displaces(const Candidate& later, const Candidate& before) const noexcept {
  if (later.source.address != before.source.address)
    return callers_.rank(later.source.address) >= callers_.rank(before.source.address);
  // RSI that began anew sends from another port; what comes from the old one is a straggler.
  if (later.source.port != before.source.port) return later.source != answered_last_;
  return later.ipoc != before.ipoc && !was_overtaken(before.ipoc, later.ipoc);
}

Datagram Server::answer(const Datagram& telegram, std::string_view digits) noexcept {
  Datagram sent{{}, telegram.destination, telegram.source, {}, false};
  answered_last_ = telegram.source;
  if (!options_.reply) return sent;
  const auto reply = options_.reply->with_ipoc(digits, form_of(telegram.payload));
  if (!moves_nothing(reply)) {
    count(refused_);
  } else if (!send(reply, telegram)) {
    count(send_failures_);
  } else {
    sent.payload = reply;
    count(answered_);
  }
  sent.time = now();
  return sent;
}

}  // namespace rsi
