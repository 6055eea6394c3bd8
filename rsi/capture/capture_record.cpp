#include "rsi/capture/capture_record.hpp"

#include <chrono>
#include <cstdint>
#include <cstring>

#include "rsi/capture/packet.hpp"

namespace rsi {
namespace {

constexpr std::size_t record_header_size = 16;
constexpr std::size_t captured_length_at = 8;
constexpr std::size_t wire_length_at = 12;

void append32(std::string& out, std::uint32_t value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace

std::string capture_header() {
  constexpr std::uint16_t version[] = {2, 4};
  std::string out;
  append32(out, 0xa1b23c4d);  // pcap with nanoseconds
  out.append(reinterpret_cast<const char*>(version), sizeof version);
  append32(out, 0);  // two unused words
  append32(out, 0);
  append32(out, packet_header_size + max_udp_payload);  // the largest packet
  append32(out, 101);                                   // LINKTYPE_RAW
  return out;
}

void append_capture_record(const Datagram& datagram, std::string& out) {
  using namespace std::chrono;
  const auto whole_seconds = floor<seconds>(datagram.time);
  const auto header = out.size();
  append32(out, static_cast<std::uint32_t>(whole_seconds.count()));
  append32(out, static_cast<std::uint32_t>((datagram.time - whole_seconds).count()));
  append32(out, static_cast<std::uint32_t>(packet_header_size + datagram.payload.size()));
  append32(out, 0);
  const auto wire_length = static_cast<std::uint32_t>(append_packet(datagram, out));
  std::memcpy(out.data() + header + wire_length_at, &wire_length, sizeof wire_length);
}

std::size_t capture_record_size(const Datagram& datagram) noexcept {
  return record_header_size + packet_header_size + datagram.payload.size();
}

std::size_t capture_record_size(std::string_view bytes) noexcept {
  if (bytes.size() < record_header_size) return 0;
  std::uint32_t captured = 0;
  std::memcpy(&captured, bytes.data() + captured_length_at, sizeof captured);
  return record_header_size + captured;
}

}  // namespace rsi
