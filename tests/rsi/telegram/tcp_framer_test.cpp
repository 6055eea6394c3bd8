#include "rsi/telegram/tcp_framer.hpp"

#include <algorithm>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/catch.hpp"
#include "tests/rsi/with_length.hpp"

using namespace std::string_literals;
using rsi::LengthPrefix;
using rsi::TcpFramer;
using rsi::test::with_length;

namespace {

constexpr std::array kForms{LengthPrefix::none,        LengthPrefix::decimal,
                            LengthPrefix::binary16_be, LengthPrefix::binary16_le,
                            LengthPrefix::binary32_be, LengthPrefix::binary32_le};

std::string moving_telegram(int ipoc) {
  return "<Rob Type=\"KUKA\"><RIst X=\"1.5\"/><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>";
}

/// What came out of a stream.
struct Framed {
  std::vector<std::string> telegrams;
  std::vector<LengthPrefix> prefixes;
  std::uint64_t skipped = 0;

  friend bool operator==(const Framed&, const Framed&) = default;
};

void feed(TcpFramer& framer, std::string_view bytes, Framed& framed) {
  while (!bytes.empty()) {
    const auto room = framer.room();
    REQUIRE_FALSE(room.empty());
    const auto size = std::min(room.size(), bytes.size());
    std::memcpy(room.data(), bytes.data(), size);
    framer.received(size);
    bytes.remove_prefix(size);
    for (auto next = framer.next(); !next.empty(); next = framer.next()) {
      framed.telegrams.emplace_back(next);
      framed.prefixes.push_back(framer.prefix());
    }
  }
  framed.skipped = framer.skipped();
}

Framed framed(const std::vector<std::string_view>& pieces) {
  TcpFramer framer;
  Framed result;
  for (const auto piece : pieces) feed(framer, piece, result);
  return result;
}

Framed framed(std::string_view stream) {
  return framed(std::vector{stream});
}

std::vector<std::string_view> bytewise(std::string_view stream) {
  std::vector<std::string_view> pieces;
  for (std::size_t i = 0; i < stream.size(); ++i) pieces.push_back(stream.substr(i, 1));
  return pieces;
}

}  // namespace

TEST_CASE("a stream gives the same telegrams wherever it is cut", "[tcp_framer]") {
  const std::string stream = moving_telegram(4) + "\n" + moving_telegram(8) + "\r\n\0"s +
                             "<ROB TYPE=\"KUKA\">\n\t<Dat>\n<IPOC>12</IPOC></Dat></rob \t>" +
                             moving_telegram(16);
  const Framed whole = framed(stream);
  CHECK(whole.telegrams ==
        std::vector{moving_telegram(4), moving_telegram(8),
                    "<ROB TYPE=\"KUKA\">\n\t<Dat>\n<IPOC>12</IPOC></Dat></rob \t>"s,
                    moving_telegram(16)});
  CHECK(whole.skipped == 0);
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    const std::string_view all = stream;
    CHECK(framed({all.substr(0, cut), all.substr(cut)}) == whole);
  }
  CHECK(framed(bytewise(stream)) == whole);
}

TEST_CASE("a telegram is there with its last byte, not with what follows", "[tcp_framer]") {
  TcpFramer framer;
  Framed got;
  const auto text = moving_telegram(4);
  feed(framer, std::string_view(text).substr(0, text.size() - 1), got);
  CHECK(got.telegrams.empty());
  feed(framer, ">", got);
  CHECK(got.telegrams == std::vector{text});
}

TEST_CASE("a length before the XML is known in every form, and is no part of the telegram",
          "[tcp_framer]") {
  for (const auto form : kForms) {
    INFO(rsi::text(form));
    const std::string stream =
        with_length(form, moving_telegram(4)) + "\n" + with_length(form, moving_telegram(1000));
    const Framed result = framed(stream);
    CHECK(result.telegrams == std::vector{moving_telegram(4), moving_telegram(1000)});
    CHECK(result.prefixes == std::vector{form, form});
    CHECK(result.skipped == 0);
    CHECK(framed(bytewise(stream)) == result);
  }
}

TEST_CASE("a length may count what ends the line behind the XML", "[tcp_framer]") {
  for (const auto form : kForms) {
    if (form == LengthPrefix::none) continue;
    const Framed result = framed(with_length(form, moving_telegram(4), 1) + "\n" +
                                 with_length(form, moving_telegram(8), 2) + "\r\n");
    CHECK(result.prefixes == std::vector{form, form});
    CHECK(result.skipped == 0);
  }
}

TEST_CASE("a binary length whose bytes look like markup or digits misleads nobody",
          "[tcp_framer]") {
  // 0x3c is "<", 0x31 is "1", 0x52 is "R", 0x0a a line end.
  for (const std::size_t length : {0x013cU, 0x3c3dU, 0x3c52U, 0x3132U, 0x310aU, 0x3c2fU}) {
    const std::string start = "<Rob>", end = "<IPOC>1</IPOC></Rob>";
    const std::string text = start + std::string(length - start.size() - end.size(), ' ') + end;
    for (const auto form : kForms) {
      INFO(length << ' ' << rsi::text(form));
      const std::string stream = with_length(form, text) + with_length(form, text);
      const Framed result = framed(stream);
      CHECK(result.telegrams == std::vector{text, text});
      CHECK(result.prefixes == std::vector{form, form});
    }
  }
}

TEST_CASE("digits that are not the length are garbage", "[tcp_framer]") {
  const Framed result = framed("77" + moving_telegram(4) + "1" +
                               with_length(LengthPrefix::decimal, moving_telegram(8)));
  CHECK(result.telegrams == std::vector{moving_telegram(4), moving_telegram(8)});
  CHECK(result.prefixes == std::vector{LengthPrefix::none, LengthPrefix::none});
  CHECK(framed("000" + with_length(LengthPrefix::decimal, moving_telegram(4))).prefixes ==
        std::vector{LengthPrefix::decimal});
}

TEST_CASE("the first packet of old controllers, an IPOC alone, is a telegram by itself",
          "[tcp_framer]") {
  const auto first = GENERATE("<IPOC>123</IPOC>"s, "<ipoc> 123\n</Ipoc >"s);
  for (const auto form : kForms) {
    const std::string stream = with_length(form, first) + with_length(form, moving_telegram(4));
    const Framed result = framed(stream);
    CHECK(result.telegrams == std::vector{first, moving_telegram(4)});
    CHECK(result.prefixes == std::vector{form, form});
    CHECK(framed(bytewise(stream)) == result);
  }
}

TEST_CASE("garbage is skipped and counted, and the next telegram is found", "[tcp_framer]") {
  const auto [garbage, counted] = GENERATE(table<std::string, std::uint64_t>(
      {{"HTTP/1.1 400", 11},
       {"<html><body/></html>", 20},
       {"</Rob>", 6},
       {"<Robot><Ro", 10},
       {"<IPOC>12<x/></IPOC>", 19},
       {"<Rob Type=\"KUKA\"><RIst X=", 23},  // a telegram whose rest never came
       {"<Rob><IPOC>1</IPOC>", 19},
       {"\xff\x01<<<>", 6},
       {std::string(300'000, 'x'), 300'000},
       {std::string(300'000, '<'), 300'000}}));
  INFO(garbage.substr(0, 40));
  const Framed result = framed(garbage + moving_telegram(4) + garbage + moving_telegram(8));
  CHECK(result.telegrams == std::vector{moving_telegram(4), moving_telegram(8)});
  CHECK(result.skipped == 2 * counted);
}

TEST_CASE("blanks without end, between telegrams or in an end tag, jam nothing", "[tcp_framer]") {
  const std::string blanks(300'000, ' ');
  const Framed result =
      framed(moving_telegram(4) + blanks + "<Rob></Rob" + blanks + ">" + moving_telegram(8));
  CHECK(result.telegrams == std::vector{moving_telegram(4), moving_telegram(8)});
}

TEST_CASE("the largest telegram passes, of a larger one only the IPOC is left", "[tcp_framer]") {
  const auto sized = [](std::size_t size) {
    const std::string end = "<IPOC>5</IPOC></Rob>";
    return "<Rob>" + std::string(size - end.size() - 5, ' ') + end;
  };
  const auto largest = sized(TcpFramer::kLargestTelegram);
  const auto larger = sized(TcpFramer::kLargestTelegram + 1);
  const auto huge = sized(500'000);
  CHECK(framed(largest + moving_telegram(4)).telegrams == std::vector{largest, moving_telegram(4)});
  // Its first 65507 bytes hold no end, but the IPOC: nothing is left.
  CHECK(framed(larger + moving_telegram(4)).telegrams == std::vector{moving_telegram(4)});
  CHECK(framed(huge + moving_telegram(4)).telegrams ==
        std::vector{"<IPOC>5</IPOC>"s, moving_telegram(4)});
  CHECK(framed(bytewise(larger)) == framed(larger));
}

TEST_CASE("a framer of replies cuts at </Sen>", "[tcp_framer]") {
  TcpFramer framer("Sen");
  Framed got;
  feed(framer, "31<Sen Type=\"x\"><IPOC>1</IPOC></Sen>", got);
  CHECK(got.telegrams == std::vector{"<Sen Type=\"x\"><IPOC>1</IPOC></Sen>"s});
}

TEST_CASE("after a reset nothing of the old stream is left but the count", "[tcp_framer]") {
  TcpFramer framer;
  Framed got;
  feed(framer, "<Rob><IPOC>1", got);
  framer.reset();
  CHECK(framer.skipped() == 12);
  feed(framer, "</IPOC></Rob>" + moving_telegram(4), got);
  CHECK(got.telegrams == std::vector{moving_telegram(4)});
}

TEST_CASE("however a stream of anything is cut, the result is the same", "[tcp_framer]") {
  const std::uint64_t seed = 20'130'704;
  INFO("seed " << seed);
  std::mt19937_64 random(seed);
  const std::vector<std::string> parts{"<Rob ",
                                       "<Rob>",
                                       "</Rob>",
                                       "</ROB  >",
                                       "</Rob" + std::string(70, ' ') + ">",
                                       "<IPOC>",
                                       "</IPOC>",
                                       "1234",
                                       "<",
                                       "</",
                                       ">",
                                       " ",
                                       "\n",
                                       "\0"s,
                                       "<R",
                                       "<RIst/>",
                                       "<IPOC",
                                       "x",
                                       std::string(30'000, 'y'),
                                       moving_telegram(4),
                                       with_length(LengthPrefix::decimal, moving_telegram(8)),
                                       with_length(LengthPrefix::binary32_be, moving_telegram(12)),
                                       with_length(LengthPrefix::binary16_le, moving_telegram(16))};
  const auto pick = [&](std::size_t below) { return random() % below; };
  for (int round = 0; round < 3000; ++round) {
    std::string stream;
    for (std::size_t n = 1 + pick(20); n > 0; --n) stream += parts[pick(parts.size())];
    std::vector<std::string_view> pieces;
    for (std::string_view rest = stream; !rest.empty();) {
      const auto size = std::min(rest.size(), 1 + pick(pick(4) == 0 ? 40'000 : 12));
      pieces.push_back(rest.substr(0, size));
      rest.remove_prefix(size);
    }
    const Framed whole = framed(stream);
    REQUIRE(framed(pieces) == whole);
    std::size_t bytes = whole.skipped;
    for (const auto& text : whole.telegrams) {
      REQUIRE(text.size() <= TcpFramer::kLargestTelegram);
      bytes += text.size();
    }
    REQUIRE(bytes <= stream.size());
  }
}

TEST_CASE("blanks between telegrams are no length, whatever the telegram's size", "[tcp_framer]") {
  const std::string empty = "<Rob><A></A><IPOC>1</IPOC></Rob>";
  for (const auto& [size, between] : {std::pair(2572, "\r\n"s),
                                      {2573, "\r\n"s},
                                      {3336, "\r\n"s},
                                      {2570, "\n\n"s},
                                      {2558, "\n\0"s},
                                      {2560, "\n\0"s}}) {
    std::string telegram = empty;
    telegram.insert(8, std::string(static_cast<std::size_t>(size) - empty.size(), 'x'));
    const auto found = framed(telegram + between + telegram + between + telegram);
    CHECK(found.telegrams.size() == 3);
    for (const auto prefix : found.prefixes) CHECK(prefix == LengthPrefix::none);
    CHECK(found.skipped == 0);
  }
}
