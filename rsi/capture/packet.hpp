#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "rsi/datagram.hpp"

namespace rsi {

/// What stands before the IP header of a captured packet.
enum class LinkLayer { ethernet, raw_ip, loopback, linux_sll, linux_sll2 };

/// For a link type as libpcap names it (DLT_…;
/// https://www.tcpdump.org/linktypes.html); nothing for
/// one that is not understood here.
[[nodiscard]] std::optional<LinkLayer> link_layer(int link_type) noexcept;

enum class PacketKind {
  udp,         ///< UDP over IPv4, decoded
  tcp,         ///< a segment of TCP over IPv4, where these are asked for
  fragment,    ///< one piece of a fragmented UDP datagram
  incomplete,  ///< ends before its headers do
  foreign,     ///< any other protocol, or headers that contradict themselves
};

/// What else the headers of a packet say.
struct PacketHeaders {
  std::uint16_t identification = 0;  ///< of IP
  std::uint32_t sequence = 0;        ///< of TCP, of the first byte
  bool begins = false;               ///< a connection (SYN)
};

/// Takes a captured packet apart. For PacketKind::udp, source, destination, payload (a view into
/// `packet`) and cut are set in `datagram`: cut if the UDP header announces more than is there.
/// VLAN tags are skipped, however many; padding behind the datagram is left out; checksums are not
/// looked at, as network cards often fill them in after the capture. Takes any bytes.
/// With `more`, segments of TCP are decoded, too: their bytes are the payload then.
PacketKind decode_packet(LinkLayer layer, std::string_view packet, Datagram& datagram,
                         PacketHeaders* more = nullptr) noexcept;

/// IPv4 and UDP header before the payload of an encoded packet.
inline constexpr std::size_t packet_header_size = 28;
inline constexpr std::size_t max_udp_payload = 65507;

/// Appends the datagram as an IPv4 packet with right lengths and checksums to `out`, and returns
/// the length that it had on the wire. Of a cut datagram that length is unknown; it is put down as
/// one byte more than there is, without a UDP checksum. The payload has at most max_udp_payload
/// bytes.
std::size_t append_packet(const Datagram& datagram, std::string& out);

}  // namespace rsi
