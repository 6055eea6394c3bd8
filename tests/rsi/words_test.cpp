#include "rsi/words.hpp"

#include <string>
#include <vector>

#include "tests/catch.hpp"

namespace {

/// In memory of its own that ends where it ends, so that AddressSanitizer sees what goes beyond.
std::vector<char> bytes(std::size_t count, int first = 'a') {
  std::vector<char> made(count);
  for (std::size_t i = 0; i < count; ++i) made[i] = static_cast<char>(first + static_cast<int>(i));
  return made;
}

}  // namespace

TEST_CASE("a word has its first byte lowest, and zeros behind the last", "[words]") {
  CHECK(rsi::word_at("abcdefgh") == 0x6867'6665'6463'6261);
  CHECK(rsi::half_word_at("abcd") == 0x6463'6261);
  for (std::size_t size = 0; size <= 8; ++size) {
    CAPTURE(size);
    const auto text = bytes(size);
    std::uint64_t expected = 0;
    for (std::size_t i = size; i-- > 0;)
      expected = expected << 8 | static_cast<unsigned char>(text[i]);
    CHECK(rsi::word_at(text.data(), size) == expected);
  }
}

TEST_CASE("texts of any size are compared by every byte", "[words]") {
  for (std::size_t size = 0; size <= 40; ++size) {
    CAPTURE(size);
    const auto text = bytes(size);
    auto other = text;
    CHECK(rsi::equal(text.data(), other.data(), size));
    for (std::size_t i = 0; i < size; ++i) {
      other[i] = '!';
      CHECK_FALSE(rsi::equal(text.data(), other.data(), size));
      other[i] = text[i];
    }
  }
}

TEST_CASE("texts of any size are copied, and nothing beside them", "[words]") {
  CHECK(rsi::copy(nullptr, nullptr, 0) == nullptr);
  CHECK(rsi::equal(nullptr, nullptr, 0));
  for (std::size_t size = 0; size <= 40; ++size) {
    CAPTURE(size);
    const auto text = bytes(size);
    std::string room(size + 2, '.');
    CHECK(rsi::copy(room.data() + 1, text.data(), size) == room.data() + 1 + size);
    CHECK(room == "." + std::string(text.begin(), text.end()) + ".");
  }
}
