// Packets of any bytes, as a tap sees them: link layer, size, bytes; and again.
#include <numeric>

#include "rsi/capture/copy_filter.hpp"
#include "rsi/capture/packet.hpp"
#include "rsi/capture/tcp_stream.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = fuzz::text(data, size);
  std::size_t datagrams = 0, passed = 0;
  rsi::CopyFilter filter([&](const rsi::Datagram& datagram) {
    ++passed;
    const auto& payload = datagram.payload;
    [[maybe_unused]] volatile int sum = std::accumulate(payload.begin(), payload.end(), 0);
  });
  rsi::TcpStream stream("Rob");
  std::size_t cut = 0, came = 0;
  while (rest.size() >= 2) {
    const auto layer = static_cast<rsi::LinkLayer>(static_cast<unsigned char>(rest[0]) % 5);
    const auto length = static_cast<unsigned char>(rest[1]);
    rest.remove_prefix(2);
    const auto packet = rest.substr(0, length);
    rest.remove_prefix(packet.size());
    rsi::Datagram datagram;
    rsi::PacketHeaders headers;
    const auto kind = rsi::decode_packet(layer, packet, datagram, &headers);
    expect(datagram.payload.size() <= packet.size(), "a payload is part of its packet");
    if (kind == rsi::PacketKind::udp) {
      ++datagrams;
      datagram.time = rsi::Timestamp(std::int64_t{headers.identification} * 1000);
      filter.take(datagram, headers.identification, datagram.source.port % 2 == 1);
    } else if (kind == rsi::PacketKind::tcp) {
      came += datagram.payload.size();
      stream.take(headers.sequence, headers.begins, datagram.payload,
                  [&](std::string_view telegram) {
                    cut += telegram.size();
                    expect(telegram.size() > 5 && telegram.front() == '<' && telegram.back() == '>',
                           "what is cut is a telegram");
                  });
    }
  }
  filter.settle();
  expect(passed + filter.copies() == datagrams, "each datagram passes or is a copy");
  expect(cut <= came, "telegrams are made of what came");
  return 0;
}
