// A TCP stream of any bytes. How the network cuts it changes nothing, and what comes out are
// telegrams. In one input of sixteen (those are slow) the first two bytes 0x1e stand for 33,000
// bytes each, so that small inputs make telegrams that are too large.
#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "rsi/ascii.hpp"
#include "rsi/telegram/tcp_framer.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

constexpr char kFiller = '\x1e';
constexpr std::size_t kFillerSize = 33'000;

std::string stream_of(std::string_view input) {
  std::string stream;
  int fillers = input.size() % 16 == 0 ? 0 : 2;
  for (const char c : input)
    if (c == kFiller && fillers++ < 2)
      stream.append(kFillerSize, 'a');
    else
      stream += c;
  return stream;
}

struct Framed {
  std::string telegrams;  ///< one behind the other
  std::vector<std::size_t> sizes;
  std::vector<rsi::LengthPrefix> prefixes;
  std::uint64_t skipped = 0;

  bool operator==(const Framed&) const = default;
};

/// `pieces` are the sizes in which the bytes come, again and again.
Framed framed(std::string_view stream, std::span<const std::size_t> pieces) {
  static rsi::TcpFramer framer;
  Framed result;
  const auto skipped_before = framer.skipped();
  std::size_t piece = 0;
  while (!stream.empty()) {
    const auto room = framer.room();
    expect(!room.empty(), "there is always room");
    const auto size = std::min({pieces[piece++ % pieces.size()], room.size(), stream.size()});
    std::copy_n(stream.begin(), size, room.begin());
    framer.received(size);
    stream.remove_prefix(size);
    for (auto telegram = framer.next(); !telegram.empty(); telegram = framer.next()) {
      result.telegrams += telegram;
      result.sizes.push_back(telegram.size());
      result.prefixes.push_back(framer.prefix());
    }
  }
  framer.reset();
  result.skipped = framer.skipped() - skipped_before;
  return result;
}

bool begins_with(std::string_view text, std::string_view start) {
  return rsi::equal_ignoring_case(text.substr(0, start.size()), start);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = fuzz::text(data, size);
  const std::string stream = stream_of(input);
  constexpr std::size_t kAll = SIZE_MAX;
  const auto whole = framed(stream, std::array{kAll});
  expect(whole.telegrams.size() + whole.skipped <= stream.size(), "no byte counts twice");
  std::string_view rest = whole.telegrams;
  for (const auto length : whole.sizes) {
    const auto telegram = rest.substr(0, length);
    expect(length <= rsi::TcpFramer::kLargestTelegram, "a telegram fits into a datagram");
    expect(begins_with(telegram, "<Rob") || begins_with(telegram, "<IPOC"), "it has a beginning");
    expect(telegram.ends_with('>'), "it has an end");
    rest.remove_prefix(length);
  }

  // Byte by byte, were that not too slow; and cut as the input says.
  const std::size_t least = stream.size() > input.size() ? 1000 : 1;
  expect(framed(stream, std::array{least}) == whole, "single bytes make the same telegrams");
  std::vector<std::size_t> pieces{least};
  for (const auto byte : input.substr(0, 32))
    pieces.push_back(least * (1 + static_cast<unsigned char>(byte) % 64));
  expect(framed(stream, pieces) == whole, "pieces of any size make the same telegrams");

  auto again = framed(whole.telegrams, std::array{kAll});
  expect(again.sizes == whole.sizes && again.telegrams == whole.telegrams && again.skipped == 0,
         "telegrams one behind the other are cut apart as they were");
  return 0;
}
