#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "rsi/datagram.hpp"
#include "rsi/endpoint.hpp"

/// Captures of every format, put together byte by byte from the specifications and not by the code
/// under test.
namespace rsi::test {

enum class Order { little_endian, big_endian };

inline std::string number(std::uint64_t value, std::size_t size, Order order = Order::big_endian) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) {
    const auto place = order == Order::little_endian ? i : size - 1 - i;
    bytes += static_cast<char>(value >> (8 * place) & 0xff);
  }
  return bytes;
}

// Packets, from the inside out: ethernet(ipv4_udp(…)).

struct Ipv4Fields {
  std::uint8_t protocol = 17;
  std::uint16_t flags_and_offset = 0;
  std::string options = "";  // a multiple of four bytes
};

inline std::string ipv4(std::uint32_t source, std::uint32_t destination, std::string_view content,
                        const Ipv4Fields& fields = {}) {
  const auto header = 20 + fields.options.size();
  return number(0x40 + header / 4, 1) + number(0, 1) + number(header + content.size(), 2) +
         number(0, 2) + number(fields.flags_and_offset, 2) + number(64, 1) +
         number(fields.protocol, 1) + number(0, 2) + number(source, 4) + number(destination, 4) +
         fields.options + std::string(content);
}

inline std::string udp_bytes(std::uint16_t source, std::uint16_t destination,
                             std::string_view payload) {
  return number(source, 2) + number(destination, 2) + number(8 + payload.size(), 2) + number(0, 2) +
         std::string(payload);
}

inline std::string ipv4_udp(const Endpoint& source, const Endpoint& destination,
                            std::string_view payload) {
  return ipv4(source.address, destination.address,
              udp_bytes(source.port, destination.port, payload));
}

inline constexpr std::uint16_t type_ipv4 = 0x0800;

/// `tags` are the Ethernet types of the VLAN tags, outermost first.
inline std::string ethernet(std::string_view content, const std::vector<std::uint16_t>& tags = {},
                            std::uint16_t type = type_ipv4) {
  std::string frame(12, '\x02');  // both MAC addresses
  for (const auto tag : tags) frame += number(tag, 2) + number(0x6007, 2);
  return frame + number(type, 2) + std::string(content);
}

inline std::string loopback(std::string_view content, Order order, std::uint32_t family = 2) {
  return number(family, 4, order) + std::string(content);
}

inline std::string linux_sll(std::string_view content) {
  return number(0, 2) + number(1, 2) + number(6, 2) + std::string(8, '\x02') +
         number(type_ipv4, 2) + std::string(content);
}

inline std::string linux_sll2(std::string_view content) {
  return number(type_ipv4, 2) + number(0, 2) + number(3, 4) + number(1, 2) + number(0, 1) +
         number(6, 1) + std::string(8, '\x02') + std::string(content);
}

// Link types in a file.
inline constexpr std::uint32_t link_null = 0;
inline constexpr std::uint32_t link_ethernet = 1;
inline constexpr std::uint32_t link_raw = 101;
inline constexpr std::uint32_t link_loop = 108;
inline constexpr std::uint32_t link_sll = 113;
inline constexpr std::uint32_t link_ipv4 = 228;
inline constexpr std::uint32_t link_sll2 = 276;

/// A pcap file
/// (https://www.tcpdump.org/manpages/pcap-savefile.5.txt).
class PcapBytes {
 public:
  explicit PcapBytes(std::uint32_t link_type = link_ethernet, bool with_nanoseconds = true,
                     Order order = Order::little_endian)
      : order_(order), nanoseconds_(with_nanoseconds) {
    bytes_ = n(with_nanoseconds ? 0xa1b23c4d : 0xa1b2c3d4, 4) + n(2, 2) + n(4, 2) + n(0, 8) +
             n(262144, 4) + n(link_type, 4);
  }

  /// Only the first `captured` bytes of the packet.
  PcapBytes& add(Timestamp time, std::string_view packet, std::size_t captured = SIZE_MAX) {
    const auto kept = packet.substr(0, captured);
    const auto ns = static_cast<std::uint64_t>(time.count());
    bytes_ += n(ns / 1'000'000'000, 4) + n(ns % 1'000'000'000 / (nanoseconds_ ? 1 : 1000), 4) +
              n(kept.size(), 4) + n(packet.size(), 4);
    bytes_ += kept;
    return *this;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  [[nodiscard]] std::string n(std::uint64_t value, std::size_t size) const {
    return number(value, size, order_);
  }

  Order order_;
  bool nanoseconds_;
  std::string bytes_;
};

/// A pcapng file of one section or more
/// (https://www.ietf.org/archive/id/draft-ietf-opsawg-pcapng-02.html).
class PcapngBytes {
 public:
  explicit PcapngBytes(Order order = Order::little_endian) { add_section(order); }

  PcapngBytes& add_section(Order order) {
    order_ = order;
    nanoseconds_.clear();
    return add_block(0x0a0d0d0a, n(0x1a2b3c4d, 4) + n(1, 2) + n(0, 2) + n(UINT64_MAX, 8));
  }

  PcapngBytes& add_interface(std::uint32_t link_type, bool with_nanoseconds = true,
                             std::uint32_t snapshot = 262144) {
    const auto resolution = n(9, 2) + n(1, 2) + n(9, 1) + std::string(3, '\0') + n(0, 4);
    nanoseconds_.push_back(with_nanoseconds);
    return add_block(
        1, n(link_type, 2) + n(0, 2) + n(snapshot, 4) + (with_nanoseconds ? resolution : ""));
  }

  PcapngBytes& add(Timestamp time, std::string_view packet, std::size_t captured = SIZE_MAX,
                   std::uint32_t interface = 0) {
    const auto kept = packet.substr(0, captured);
    const auto ticks =
        static_cast<std::uint64_t>(time.count()) / (nanoseconds_.at(interface) ? 1 : 1000);
    return add_block(6, n(interface, 4) + n(ticks >> 32, 4) + n(ticks & 0xffffffff, 4) +
                            n(kept.size(), 4) + n(packet.size(), 4) + std::string(kept));
  }

  PcapngBytes& add_block(std::uint32_t type, std::string body) {
    while (body.size() % 4 != 0) body += '\0';
    const auto total = n(12 + body.size(), 4);
    bytes_ += n(type, 4) + total + body + total;
    return *this;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  [[nodiscard]] std::string n(std::uint64_t value, std::size_t size) const {
    return number(value, size, order_);
  }

  Order order_{};                  // of the section
  std::vector<bool> nanoseconds_;  // of each of its interfaces
  std::string bytes_;
};

/// A file that exists as long as this object.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view content = {}) {
    auto name = (std::filesystem::temp_directory_path() / "sweepd-test-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) throw std::runtime_error("cannot create " + name);
    close(file);
    path_ = name;
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rsi::test
