#include "rsi/telegram/decimal.hpp"

#include <cmath>
#include <random>
#include <string>

#include "tests/catch.hpp"

TEST_CASE("numbers are read the same in every locale, and only finite ones", "[decimal]") {
  CHECK(rsi::number("-90.0") == -90.0);
  CHECK(rsi::number(" +1.5e-3 ") == 0.0015);
  for (const auto* text : {"", "1,5", "nan", "inf", "1.5x", "--1", "+-1", "0x10", "1e999"})
    CHECK_FALSE(rsi::number(text));
  CHECK(rsi::decimals("-90.0") == 1);
  CHECK(rsi::decimals("12") == 0);
  CHECK(rsi::decimals("0.1234e-3") == 4);
}

TEST_CASE("a printed number is read to the nearest double, with its decimals", "[decimal]") {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20'000; ++round) {
    std::string text = random() % 2 == 0 ? "-" : "";
    for (auto whole = 1 + random() % 9; whole > 0; --whole)
      text += static_cast<char>('0' + random() % 10);
    const auto decimals = random() % 10;
    if (decimals > 0) text += '.';
    for (auto left = decimals; left > 0; --left) text += static_cast<char>('0' + random() % 10);
    CAPTURE(text);
    const auto read = rsi::decimal(text);
    REQUIRE(read);
    REQUIRE(read->value == *rsi::number(text));
    REQUIRE(read->decimals == static_cast<int>(decimals));
  }
  for (const char* text : {"", "-", ".", "-.", "1.2.3", "1-2", "--1", "nan", "inf", "1e999", "0x1"})
    CHECK_FALSE(rsi::decimal(text));
  CHECK(rsi::decimal("1.5e2")->value == 150);
  CHECK(rsi::decimal(" +2.50 ")->value == 2.5);
  CHECK(rsi::decimal(".5")->value == 0.5);
  CHECK(std::signbit(rsi::decimal("-0.0000")->value));
}

TEST_CASE("a number with any other byte in any place is read as number() reads it", "[decimal]") {
  for (const std::string text :
       {"0.0", "12.5", "-123.4567", "1234.56789", "9999.9999", "12345678."})
    for (std::size_t at = 0; at <= text.size(); ++at)
      for (int byte = 0; byte < 256; ++byte)
        for (const std::size_t replaced : {std::size_t{0}, std::size_t{1}}) {
          std::string other = text;
          other.replace(at, replaced, 1, static_cast<char>(byte));
          CAPTURE(other);
          const auto read = rsi::decimal(other);
          const auto expected = rsi::number(other);
          REQUIRE(read.has_value() == expected.has_value());
          if (!read) continue;
          REQUIRE(read->value == *expected);
          REQUIRE(read->decimals == rsi::decimals(other));
        }
}
