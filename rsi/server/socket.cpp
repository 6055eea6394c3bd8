#include "rsi/server/socket.hpp"

#include <arpa/inet.h>
#include <unistd.h>

namespace rsi {

Socket& Socket::operator=(Socket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  Socket old(std::move(other));
  return *this;
}

Socket::~Socket() {
  if (open()) close(descriptor_);
}

std::size_t Socket::enlarge_receive_buffer(int bytes) const noexcept {
  // The first needs a privilege, the second is cut to net.core.rmem_max.
  if (!set(SOL_SOCKET, SO_RCVBUFFORCE, bytes)) set(SOL_SOCKET, SO_RCVBUF, bytes);
  int granted = 0;
  socklen_t size = sizeof granted;
  getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return static_cast<std::size_t>(granted);
}

sockaddr_in to_system(const Endpoint& endpoint) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(endpoint.address);
  address.sin_port = htons(endpoint.port);
  return address;
}

Endpoint from_system(const sockaddr_in& address) noexcept {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

}  // namespace rsi
