#include "rsi/capture/packet.hpp"

#include <algorithm>
#include <cstdint>

namespace rsi {
namespace {

constexpr std::uint32_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

constexpr std::uint16_t be16(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint16_t>(byte_at(bytes, at) << 8 | byte_at(bytes, at + 1));
}

constexpr std::uint32_t be32(std::string_view bytes, std::size_t at) {
  return std::uint32_t{be16(bytes, at)} << 16 | be16(bytes, at + 2);
}

constexpr std::uint32_t tcp_protocol = 6;
constexpr std::uint32_t udp_protocol = 17;

PacketKind decode_tcp(std::string_view ip, std::size_t at, Datagram& datagram,
                      PacketHeaders& more) {
  if (ip.size() < at + 20) return PacketKind::incomplete;
  const auto tcp = ip.substr(at);
  const std::size_t header = std::size_t{4} * (byte_at(tcp, 12) >> 4);
  if (header < 20) return PacketKind::foreign;
  if (tcp.size() < header) return PacketKind::incomplete;
  more.sequence = be32(tcp, 4);
  more.begins = (byte_at(tcp, 13) & 2) != 0;
  datagram.source = {be32(ip, 12), be16(tcp, 0)};
  datagram.destination = {be32(ip, 16), be16(tcp, 2)};
  datagram.payload = tcp.substr(header);
  return PacketKind::tcp;
}

PacketKind decode_ipv4(std::string_view ip, Datagram& datagram, PacketHeaders* more) {
  if (!ip.empty() && byte_at(ip, 0) >> 4 != 4) return PacketKind::foreign;
  if (ip.size() < 20) return PacketKind::incomplete;
  const std::size_t header = std::size_t{4} * (byte_at(ip, 0) & 0xf);
  const std::size_t total = be16(ip, 2);
  const auto protocol = byte_at(ip, 9);
  const bool tcp = more != nullptr && protocol == tcp_protocol;
  if (header < 20 || total < header || (protocol != udp_protocol && !tcp))
    return PacketKind::foreign;
  const bool whole = (be16(ip, 6) & 0x3fff) == 0;  // neither "more fragments" nor an offset
  if (!whole) return PacketKind::fragment;
  if (tcp) return decode_tcp(ip.substr(0, total), header, datagram, *more);
  if (total < header + 8) return PacketKind::foreign;
  if (ip.size() < header + 8) return PacketKind::incomplete;

  const auto udp = ip.substr(header, total - header);
  const std::size_t udp_length = be16(udp, 4);
  if (udp_length < 8) return PacketKind::foreign;
  if (more != nullptr) more->identification = be16(ip, 4);
  datagram.source = {be32(ip, 12), be16(udp, 0)};
  datagram.destination = {be32(ip, 16), be16(udp, 2)};
  datagram.payload = udp.substr(8, udp_length - 8);
  datagram.cut = datagram.payload.size() < udp_length - 8;
  return PacketKind::udp;
}

/// `rest` follows an Ethernet type.
PacketKind decode_ethernet_type(std::uint16_t type, std::string_view rest, Datagram& datagram,
                                PacketHeaders* more) {
  const auto is_vlan_tag = [](std::uint16_t t) {
    return t == 0x8100 || t == 0x88a8 || t == 0x9100 || t == 0x9200;
  };
  while (is_vlan_tag(type)) {
    if (rest.size() < 4) return PacketKind::incomplete;
    type = be16(rest, 2);
    rest.remove_prefix(4);
  }
  return type == 0x0800 ? decode_ipv4(rest, datagram, more) : PacketKind::foreign;
}

/// A link header of `size` bytes with the Ethernet type at `type_at`.
PacketKind decode_typed(std::string_view packet, std::size_t size, std::size_t type_at,
                        Datagram& datagram, PacketHeaders* more) {
  if (packet.size() < size) return PacketKind::incomplete;
  return decode_ethernet_type(be16(packet, type_at), packet.substr(size), datagram, more);
}

/// The loopback header is the address family in the byte order of the capturing machine, or in
/// network order (DLT_LOOP). AF_INET is 2 everywhere.
PacketKind decode_loopback(std::string_view packet, Datagram& datagram, PacketHeaders* more) {
  if (packet.size() < 4) return PacketKind::incomplete;
  const auto family = be32(packet, 0);
  if (family != 2 && family != 0x02000000) return PacketKind::foreign;
  return decode_ipv4(packet.substr(4), datagram, more);
}

/// Sum of 16-bit words in network order, a last odd byte padded with zero (RFC 1071).
std::uint64_t word_sum(std::string_view bytes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) sum += be16(bytes, i);
  if (bytes.size() % 2 == 1) sum += byte_at(bytes, bytes.size() - 1) << 8;
  return sum;
}

std::uint16_t checksum(std::uint64_t sum) {
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

void put16(std::string& bytes, std::size_t at, std::uint64_t value) {
  bytes[at] = static_cast<char>(value >> 8 & 0xff);
  bytes[at + 1] = static_cast<char>(value & 0xff);
}

void put32(std::string& bytes, std::size_t at, std::uint32_t value) {
  put16(bytes, at, value >> 16);
  put16(bytes, at + 2, value & 0xffff);
}

}  // namespace

std::optional<LinkLayer> link_layer(int link_type) noexcept {
  switch (link_type) {
    case 1:
      return LinkLayer::ethernet;
    case 12:   // DLT_RAW
    case 14:   // DLT_RAW on OpenBSD
    case 101:  // LINKTYPE_RAW
    case 228:  // DLT_IPV4
      return LinkLayer::raw_ip;
    case 0:    // DLT_NULL
    case 108:  // DLT_LOOP
      return LinkLayer::loopback;
    case 113:
      return LinkLayer::linux_sll;
    case 276:
      return LinkLayer::linux_sll2;
    default:
      return std::nullopt;
  }
}

PacketKind decode_packet(LinkLayer layer, std::string_view packet, Datagram& datagram,
                         PacketHeaders* more) noexcept {
  switch (layer) {
    case LinkLayer::ethernet:
      return decode_typed(packet, 14, 12, datagram, more);
    case LinkLayer::linux_sll:
      return decode_typed(packet, 16, 14, datagram, more);
    case LinkLayer::linux_sll2:
      return decode_typed(packet, 20, 0, datagram, more);
    case LinkLayer::loopback:
      return decode_loopback(packet, datagram, more);
    case LinkLayer::raw_ip:
      return decode_ipv4(packet, datagram, more);
  }
  return PacketKind::foreign;
}

std::size_t append_packet(const Datagram& datagram, std::string& out) {
  const auto& [time, source, destination, payload, cut] = datagram;
  const auto announced = std::min(payload.size() + (cut ? 1 : 0), max_udp_payload);
  const auto total = packet_header_size + announced;
  const auto udp_length = 8 + announced;

  const auto ip = out.size();
  const auto udp = ip + 20;
  out.resize(ip + packet_header_size);
  put16(out, ip, 0x4500);  // version 4, header of 5 words
  put16(out, ip + 2, total);
  put16(out, ip + 6, 0x4000);  // don't fragment, so that the identification may stay 0
  put16(out, ip + 8, 64u << 8 | udp_protocol);
  put32(out, ip + 12, source.address);
  put32(out, ip + 16, destination.address);
  put16(out, ip + 10, checksum(word_sum({out.data() + ip, 20})));
  put16(out, udp, source.port);
  put16(out, udp + 2, destination.port);
  put16(out, udp + 4, udp_length);
  if (!cut) {
    // Over the addresses, the protocol, the length and the datagram (RFC 768); 0 would mean "none".
    const auto sum = checksum(word_sum({out.data() + ip + 12, 16}) + udp_protocol + udp_length +
                              word_sum(payload));
    put16(out, udp + 6, sum == 0 ? 0xffff : sum);
  }
  out += payload;
  return total;
}

}  // namespace rsi
