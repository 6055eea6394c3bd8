#include "rsi/udp_server.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <time.h>
#include <unistd.h>

#include "rsi/port_owner.hpp"

namespace rsi {
namespace {

constexpr std::size_t kLargestDatagram = 65536;
/// Half a minute of telegrams at a cycle of 4 ms, should this machine stop that long.
constexpr int kReceiveBuffer = 8 << 20;

/// Takes what the kernel says beside a datagram: when it came, and how many were dropped so far.
void read_control(msghdr& message, Timestamp& time, std::uint32_t& dropped) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp;
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      time = std::chrono::seconds(stamp.tv_sec) + std::chrono::nanoseconds(stamp.tv_nsec);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped, CMSG_DATA(part), sizeof dropped);
    }
  }
}

}  // namespace

/// What the system fills in for each datagram. Pages that are never needed are never touched.
struct UdpServer::Buffers {
  struct alignas(cmsghdr) Control {
    std::array<char, CMSG_SPACE(sizeof(timespec)) + CMSG_SPACE(sizeof(std::uint32_t))> bytes;
  };

  std::unique_ptr<char[]> payloads{new char[kMostAtOnce * kLargestDatagram]};
  std::array<iovec, kMostAtOnce> places;
  std::array<sockaddr_in, kMostAtOnce> sources;
  std::array<Control, kMostAtOnce> controls;
  std::array<mmsghdr, kMostAtOnce> messages{};
  std::array<Datagram, kMostAtOnce> datagrams;
  std::uint32_t dropped = 0;

  Buffers() {
    for (std::size_t i = 0; i < kMostAtOnce; ++i) {
      places[i] = {payloads.get() + i * kLargestDatagram, kLargestDatagram};
      auto& message = messages[i].msg_hdr;
      message.msg_name = &sources[i];
      message.msg_iov = &places[i];
      message.msg_iovlen = 1;
      message.msg_control = controls[i].bytes.data();
      reset(i);
    }
  }

  /// What the system overwrites.
  void reset(std::size_t i) noexcept {
    messages[i].msg_hdr.msg_namelen = sizeof(sockaddr_in);
    messages[i].msg_hdr.msg_controllen = controls[i].bytes.size();
    messages[i].msg_hdr.msg_flags = 0;
  }
};

UdpServer::UdpServer(Options options)
    : Server(std::move(options)),
      socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)),
      buffers_(std::make_unique<Buffers>()) {
  const Endpoint listen = this->options().listen;
  auto address = to_system(listen);
  socklen_t size = sizeof address;
  // Neither SO_REUSEADDR nor SO_REUSEPORT: the port is this program's alone.
  if (!socket_.open() ||
      bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    throw std::runtime_error(cannot_listen(Transport::udp, listen, errno));
  set_local(from_system(address));
  set_receive_buffer(socket_.enlarge_receive_buffer(kReceiveBuffer));
  // Where these are missing, times are taken later and drops are not counted: both still serve.
  socket_.set(SOL_SOCKET, SO_TIMESTAMPNS, 1);
  socket_.set(SOL_SOCKET, SO_RXQ_OVFL, 1);
  const timeval longest_look{0, std::chrono::microseconds(this->longest_look()).count()};
  if (!socket_.set(SOL_SOCKET, SO_RCVTIMEO, longest_look))
    throw std::system_error(errno, std::generic_category(), "SO_RCVTIMEO");
}

UdpServer::~UdpServer() = default;

void UdpServer::warm() noexcept {
  Server::warm();
  constexpr std::size_t kPage = 4096;
  for (const auto& place : buffers_->places) std::memset(place.iov_base, 0, kPage);
  static_cast<void>(receive(MSG_DONTWAIT | MSG_PEEK));
}

void UdpServer::run() noexcept {
  while (!stopping()) {
    const auto looking = clock();
    const auto received = receive(MSG_WAITFORONE);
    beat();
    if (!received) continue;
    if (*received > 0) serve({buffers_->datagrams.data(), *received});
    if (*received < kMostAtOnce) heard_all_until(looking);
  }
}

std::optional<std::size_t> UdpServer::receive(int flags) noexcept {
  auto& all = *buffers_;
  const int received = recvmmsg(socket_.get(), all.messages.data(), kMostAtOnce, flags, nullptr);
  if (received < 0) {
    if (errno == EAGAIN) return 0;
    // An error that lasts must not take the processor from others.
    if (errno != EINTR) usleep(1000);
    return std::nullopt;
  }
  std::uint32_t dropped = all.dropped;
  for (std::size_t i = 0; i < static_cast<std::size_t>(received); ++i) {
    auto& [message, size] = all.messages[i];
    Timestamp time{};
    read_control(message, time, dropped);
    all.datagrams[i] = {time.count() == 0 ? now() : time,
                        from_system(all.sources[i]),
                        local(),
                        {static_cast<const char*>(all.places[i].iov_base), size},
                        (message.msg_flags & MSG_TRUNC) != 0};
    all.reset(i);
  }
  if ((flags & MSG_PEEK) == 0) add_dropped(dropped - std::exchange(all.dropped, dropped));
  return static_cast<std::size_t>(received);
}

bool UdpServer::send(std::string_view reply, const Endpoint& to) noexcept {
  const auto address = to_system(to);
  return sendto(socket_.get(), reply.data(), reply.size(), MSG_DONTWAIT,
                reinterpret_cast<const sockaddr*>(&address),
                sizeof address) == static_cast<ssize_t>(reply.size());
}

}  // namespace rsi
