#include "rsi/server/tcp_read.hpp"

#include <string>

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using rsi::TcpRead;
using rsi::Timestamp;

namespace {

constexpr Timestamp kLastLook = 1'735'689'600s;
constexpr std::size_t kSize = 100;
/// Four telegrams, of each the line end behind it too.
const std::string kFour(4 * (kSize + 1), 'x');

Timestamp came(const TcpRead& read, std::size_t k) {
  return read.came(std::string_view(kFour).substr(k * (kSize + 1), kSize));
}

}  // namespace

TEST_CASE("what was read late came when the kernel says, and not when the thread woke",
          "[tcp_read]") {
  const TcpRead read{kLastLook + 4ms, kLastLook, kLastLook + 29ms, {kFour.data(), kSize + 1}};
  CHECK(came(read, 0) == kLastLook + 4ms);
}

TEST_CASE("of several that are read late the last one came last, and the others evenly before",
          "[tcp_read]") {
  const TcpRead read{kLastLook + 16ms, kLastLook, kLastLook + 18ms, kFour};
  for (int k = 0; k < 4; ++k)
    // One line end of 404 bytes: 40 µs of these 16 ms.
    CHECK(std::chrono::abs(came(read, static_cast<std::size_t>(k)) - (kLastLook + (k + 1) * 4ms)) <
          41us);
  CHECK(came(read, 3) == kLastLook + 16ms);
}

TEST_CASE("those that are read as soon as they are there came together", "[tcp_read]") {
  const TcpRead read{kLastLook + 16ms, kLastLook, kLastLook + 16ms + 50us, kFour};
  for (std::size_t k = 0; k < 4; ++k) CHECK(came(read, k) == kLastLook + 16ms);
}

TEST_CASE("a clock that was set back makes no telegram come after the last one", "[tcp_read]") {
  const TcpRead read{kLastLook + 16ms, kLastLook + 1h, kLastLook + 18ms, kFour};
  for (std::size_t k = 0; k < 4; ++k) CHECK(came(read, k) == kLastLook + 16ms);
}
