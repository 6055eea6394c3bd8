#include "rsi/server/udp_server.hpp"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <linux/filter.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "rsi/server/port_owner.hpp"
#include "rsi/server/socket_options.hpp"
#include "rsi/server/udp_control.hpp"

namespace rsi {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;

constexpr std::size_t kLargestDatagram = 65536;

/// No datagram takes more of the receive buffer, in the system's counting.
constexpr std::size_t kMostMemory = 128 << 10;

/// Lets datagrams of this address alone into the socket.
bool attach_filter(udp::socket& socket, std::uint32_t address) noexcept {
  constexpr std::uint32_t kSourceAddress = static_cast<std::uint32_t>(SKF_NET_OFF) + 12;
  std::array<sock_filter, 4> program{{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kSourceAddress),
                                      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, address, 0, 1),
                                      BPF_STMT(BPF_RET | BPF_K, 0xffffffff),
                                      BPF_STMT(BPF_RET | BPF_K, 0)}};
  using Filter = SocketOption<SOL_SOCKET, SO_ATTACH_FILTER, sock_fprog>;
  error_code error;
  socket.set_option(Filter({static_cast<unsigned short>(program.size()), program.data()}), error);
  return !error;
}

}  // namespace

/// What the system fills in for each datagram. Pages that are never needed are never touched.
struct UdpServer::Buffers {
  std::unique_ptr<char[]> payloads{new char[kMostAtOnce * kLargestDatagram]};
  std::array<iovec, kMostAtOnce> places{};
  std::array<udp::endpoint, kMostAtOnce> sources;
  std::array<UdpControl, kMostAtOnce> controls{};
  std::array<mmsghdr, kMostAtOnce> messages{};
  std::array<in_pktinfo, kMostAtOnce> came_to{};
  std::array<Datagram, kMostAtOnce> datagrams;
  std::uint32_t dropped = 0;
  std::size_t waited = 0;  // since nothing did
  bool emptied = false;

  Buffers() {
    for (std::size_t i = 0; i < kMostAtOnce; ++i) {
      places[i] = {payloads.get() + i * kLargestDatagram, kLargestDatagram};
      auto& message = messages[i].msg_hdr;
      message.msg_name = sources[i].data();
      message.msg_iov = &places[i];
      message.msg_iovlen = 1;
      message.msg_control = controls[i].bytes.data();
      reset(i);
    }
  }

  /// What the system overwrites.
  void reset(std::size_t i) noexcept {
    messages[i].msg_hdr.msg_namelen = static_cast<socklen_t>(sources[i].capacity());
    messages[i].msg_hdr.msg_controllen = controls[i].bytes.size();
    messages[i].msg_hdr.msg_flags = 0;
  }
};

UdpServer::UdpServer(Options options)
    : Server(std::move(options)), buffers_(std::make_unique<Buffers>()) {
  const Endpoint listen = this->options().listen;
  const auto controller = this->options().controller;
  error_code error;
  socket_.open(udp::v4(), error);
  filtered_ = controller && attach_filter(socket_, *controller);
  everywhere_ = listen.address == 0;
  // Neither SO_REUSEADDR nor SO_REUSEPORT: the port is this program's alone.
  if (!error) socket_.bind(to_asio<udp>(listen), error);
  if (error) throw std::runtime_error(cannot_listen(Transport::udp, listen, error.value()));
  set_local(from_asio(socket_.local_endpoint()));
  set_receive_buffer(enlarge_receive_buffer(socket_));
  // Where these are missing, times are taken later and drops are not counted: both still serve.
  socket_.set_option(SocketOption<SOL_SOCKET, SO_TIMESTAMPNS>(1), error);
  socket_.set_option(SocketOption<SOL_SOCKET, SO_RXQ_OVFL>(1), error);
  if (everywhere_) socket_.set_option(SocketOption<IPPROTO_IP, IP_PKTINFO>(1));
  using ReceiveTimeout = SocketOption<SOL_SOCKET, SO_RCVTIMEO, timeval>;
  socket_.set_option(ReceiveTimeout({0, std::chrono::microseconds(this->longest_look()).count()}));
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
  const int received =
      recvmmsg(socket_.native_handle(), all.messages.data(), kMostAtOnce, flags, nullptr);
  if (received < 0) {
    if (errno == EAGAIN) return 0;
    // An error that lasts must not take the processor from others.
    if (errno != EINTR) usleep(1000);
    return std::nullopt;
  }
  // What has no source is no datagram: wake() ended the wait.
  if (received == 1 && all.messages[0].msg_hdr.msg_namelen == 0) return 0;
  const bool peeks = (flags & MSG_PEEK) != 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(received); ++i) {
    auto& [message, size] = all.messages[i];
    Timestamp time{};
    std::uint32_t dropped = all.dropped;
    all.came_to[i] = {};
    read_control(message, time, all.came_to[i], dropped);
    Endpoint destination = local();
    if (everywhere_) destination.address = ntohl(all.came_to[i].ipi_spec_dst.s_addr);
    all.datagrams[i] = {time.count() == 0 ? now() : time,
                        from_asio(all.sources[i]),
                        destination,
                        {static_cast<const char*>(all.places[i].iov_base), size},
                        (message.msg_flags & MSG_TRUNC) != 0};
    all.reset(i);
    if (!peeks) count_dropped(dropped);
  }
  if (!peeks) all.emptied = static_cast<std::size_t>(received) < kMostAtOnce;
  return static_cast<std::size_t>(received);
}

void UdpServer::count_dropped(std::uint32_t until_this_datagram) noexcept {
  auto& all = *buffers_;
  const auto dropped = until_this_datagram - std::exchange(all.dropped, until_this_datagram);
  // The system counts what the filter keeps away and what finds no room in one. So few as have
  // waited do not fill the buffer.
  if (dropped > 0 && filtered_ && all.waited * kMostMemory < receive_buffer())
    add_foreign(dropped);
  else
    add_dropped(dropped);
  all.waited = (std::exchange(all.emptied, false) ? 0 : all.waited) + 1;
}

void UdpServer::wake() noexcept {
  // Linux wakes who waits, though it says that the socket is not connected.
  error_code not_connected;
  socket_.shutdown(udp::socket::shutdown_receive, not_connected);
}

// NOLINTNEXTLINE(bugprone-exception-escape): any 32 bits are an IPv4 address
bool UdpServer::send(std::string_view reply, const Datagram& telegram) noexcept {
  const auto size = static_cast<ssize_t>(reply.size());
  auto to = to_asio<udp>(telegram.source);
  const auto to_size = static_cast<socklen_t>(to.size());
  // One message costs the system less without a header than with. Asio's own call would wait for
  // room.
  if (!everywhere_)
    return sendto(socket_.native_handle(), reply.data(), reply.size(), MSG_DONTWAIT, to.data(),
                  to_size) == size;
  const auto& came_to =
      buffers_->came_to[static_cast<std::size_t>(&telegram - buffers_->datagrams.data())];
  in_pktinfo from{};
  from.ipi_spec_dst = came_to.ipi_spec_dst;
  from.ipi_ifindex = came_to.ipi_ifindex;
  UdpControl control{};
  iovec text{const_cast<char*>(reply.data()), reply.size()};
  msghdr message{};
  message.msg_name = to.data();
  message.msg_namelen = to_size;
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = CMSG_SPACE(sizeof from);
  cmsghdr* const part = CMSG_FIRSTHDR(&message);
  part->cmsg_level = IPPROTO_IP;
  part->cmsg_type = IP_PKTINFO;
  part->cmsg_len = CMSG_LEN(sizeof from);
  std::memcpy(CMSG_DATA(part), &from, sizeof from);
  return sendmsg(socket_.native_handle(), &message, MSG_DONTWAIT) == size;
}

}  // namespace rsi
