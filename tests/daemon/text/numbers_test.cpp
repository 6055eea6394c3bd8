#include "daemon/text/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "tests/catch.hpp"

namespace {

std::string printed(double value) {
  std::array<char, 400> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                       std::chars_format::fixed)
                             .ptr};
}

std::string measured(double value, int decimals) {
  std::string text;
  sweepd::append_measured(text, value, decimals);
  return text;
}

}  // namespace

TEST_CASE("numbers have so many decimals, rounded half up, and no negative zero", "[numbers]") {
  CHECK(sweepd::fixed(1.5, 0) == "2");
  CHECK(sweepd::fixed(-0.0004, 3) == "0.000");
  CHECK(sweepd::fixed(-12.3456, 3) == "-12.346");
  CHECK(sweepd::fixed(0.05, 1) == "0.1");
  CHECK(sweepd::fixed(100, 2) == "100.00");
  CHECK(sweepd::fixed(1234567.125, 3) == "1234567.125");
  CHECK(sweepd::fixed(1e300, 1) == printed(1e300) + ".0");
  CHECK(sweepd::fixed(std::numeric_limits<double>::infinity(), 2) == "inf");
}

TEST_CASE("two digits of an uncertainty say how many decimals a number has", "[numbers]") {
  CHECK(sweepd::decimals_for(0.034, 0, 7) == 3);
  CHECK(sweepd::decimals_for(0.00034, 3, 7) == 5);
  CHECK(sweepd::decimals_for(12, 3, 7) == 3);
  CHECK(sweepd::decimals_for(1e-300, 3, 7) == 7);
  CHECK(sweepd::decimals_for(0, 3, 7) == 7);
}

TEST_CASE("a measured number has the decimals that it came with", "[numbers]") {
  CHECK(measured(0, 6) == "0");
  CHECK(measured(-0.0, 6) == "0");
  CHECK(measured(-90, 6) == "-90");
  CHECK(measured(100.25, 6) == "100.25");
  CHECK(measured(1e20, 6) == printed(1e20));
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> exponent(-8, 14);
  for (int round = 0; round < 20'000; ++round) {
    const double value = std::pow(10, exponent(random)) * (random() % 2 == 0 ? 1 : -1) +
                         (random() % 7 == 0 ? 500 : 0);
    const int decimals = static_cast<int>(random() % 8);
    CAPTURE(value, decimals);
    REQUIRE(measured(value, decimals) == printed(sweepd::rounded(value, decimals)));
  }
}
