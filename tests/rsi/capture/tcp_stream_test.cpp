#include "rsi/capture/tcp_stream.hpp"

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/catch.hpp"

namespace {

std::string telegram_of(int ipoc) {
  return "<Rob Type=\"KUKA\"><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>";
}

struct Piece {
  std::uint32_t sequence;
  std::string bytes;
};

/// `count` telegrams in segments of `size` bytes, from the sequence number `first` on.
std::vector<Piece> segments_of(int count, std::size_t size, std::uint32_t first) {
  std::string all;
  for (int i = 0; i < count; ++i) all += telegram_of(1000 + i);
  std::vector<Piece> pieces;
  for (std::size_t at = 0; at < all.size(); at += size)
    pieces.push_back({first + static_cast<std::uint32_t>(at), all.substr(at, size)});
  return pieces;
}

std::vector<std::string> telegrams_of(rsi::TcpStream& stream, const std::vector<Piece>& pieces) {
  std::vector<std::string> telegrams;
  for (const auto& piece : pieces)
    stream.take(piece.sequence, false, piece.bytes,
                [&](std::string_view telegram) { telegrams.emplace_back(telegram); });
  return telegrams;
}

/// Before the numbers begin anew in the middle of it.
constexpr std::uint32_t kFirst = 0xffffff00;

rsi::TcpStream begun() {
  rsi::TcpStream stream("Rob");
  stream.take(kFirst - 1, true, {}, [](std::string_view) {});
  return stream;
}

}  // namespace

TEST_CASE("telegrams come whole out of segments that come twice, late and cut anywhere",
          "[tcp_stream]") {
  const std::size_t size = GENERATE(as<std::size_t>{}, 1, 7, 50, 1000);
  auto pieces = segments_of(40, size, kFirst);
  std::mt19937 chance(3);
  std::vector<Piece> seen;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (i + 1 < pieces.size() && chance() % 4 == 0) std::swap(pieces[i], pieces[i + 1]);
    seen.push_back(pieces[i]);
    if (chance() % 3 == 0) seen.push_back(pieces[i]);
  }
  auto stream = begun();
  const auto telegrams = telegrams_of(stream, seen);
  REQUIRE(telegrams.size() == 40);
  for (int i = 0; i < 40; ++i)
    CHECK(telegrams[static_cast<std::size_t>(i)] == telegram_of(1000 + i));
  CHECK(stream.missed() == 0);
}

TEST_CASE("a segment that never comes costs its own telegram", "[tcp_stream]") {
  auto pieces = segments_of(40, telegram_of(1000).size(), kFirst);
  pieces.erase(pieces.begin() + 10);
  auto stream = begun();
  const auto telegrams = telegrams_of(stream, pieces);
  REQUIRE(telegrams.size() == 39);
  CHECK(telegrams[9] == telegram_of(1009));
  CHECK(telegrams[10] == telegram_of(1011));
  CHECK(stream.missed() == telegram_of(1000).size());
}

TEST_CASE("a stream is joined in its middle, and a connection that begins starts anew",
          "[tcp_stream]") {
  rsi::TcpStream stream("Rob");
  const auto pieces = segments_of(10, 30, 5);
  CHECK(telegrams_of(stream, {pieces.begin() + 1, pieces.end()}).size() == 9);
  stream.take(77, true, {}, [](std::string_view) {});
  CHECK(telegrams_of(stream, segments_of(3, 20, 78)).size() == 3);
}
