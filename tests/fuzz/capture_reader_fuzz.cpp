// pcap and pcapng files of any bytes. Every datagram's payload is touched, so that a sanitizer sees
// one that reaches beyond its packet.
#include <numeric>

#include "rsi/capture/capture_reader.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

/// A datagram that is written into a capture again comes back as it was.
void check_round_trip(const rsi::Datagram& datagram) {
  static std::string packet;
  packet.clear();
  if (datagram.payload.size() > rsi::max_udp_payload) return;
  rsi::append_packet(datagram, packet);
  rsi::Datagram back;
  expect(rsi::decode_packet(rsi::LinkLayer::raw_ip, packet, back) == rsi::PacketKind::udp,
         "an encoded datagram is one");
  expect(back.source == datagram.source && back.destination == datagram.destination &&
             back.payload == datagram.payload,
         "an encoded datagram is the same");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::File file;
  file.write(fuzz::text(data, size));
  try {
    rsi::CaptureReader capture(file.path());
    std::uint64_t datagrams = 0;
    while (const auto datagram = capture.next()) {
      ++datagrams;
      const auto& payload = datagram->payload;
      [[maybe_unused]] volatile int sum = std::accumulate(payload.begin(), payload.end(), 0);
      expect(payload.size() <= size, "a payload is part of the file");
      expect(datagram->time.count() >= 0, "nothing was captured before 1970");
      check_round_trip(*datagram);
    }
    const auto& count = capture.counters();
    expect(count.udp == datagrams, "datagrams are counted");
    expect(count.udp + count.fragments + count.foreign <= count.packets, "a packet is one kind");
    expect(count.udp + count.fragments + count.foreign + count.snapped >= count.packets,
           "every packet is of a kind");
    expect(capture.bytes_read() <= size, "no more is read than there is");
    expect(!capture.next(), "the end is the end");
    for (const auto& note : capture.notes()) expect(fuzz::is_one_line(note), "a note is one line");
  } catch (const rsi::CaptureError& error) {
    expect(std::string_view(error.what()).find(file.path().native()) != std::string_view::npos,
           "an error names the file");
    expect(fuzz::is_one_line(error.what()), "an error is one line");
  }
  return 0;
}
