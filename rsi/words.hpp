#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rsi {

// Short texts, as the values of telegrams are, several bytes at a time. No byte beyond them is read
// or written. The first byte of a word is its lowest, on any machine.

inline constexpr std::uint64_t kEachByte = 0x0101'0101'0101'0101;

/// The eight bytes from here on.
[[nodiscard]] inline std::uint64_t word_at(const char* bytes) noexcept {
  std::uint64_t word;
  std::memcpy(&word, bytes, sizeof word);
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
  return word;
}

/// The four bytes from here on.
[[nodiscard]] inline std::uint64_t half_word_at(const char* bytes) noexcept {
  std::uint32_t word;
  std::memcpy(&word, bytes, sizeof word);
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap32(word);
  return word;
}

/// The `size` bytes from here on, eight at most, and zeros behind.
[[nodiscard]] inline std::uint64_t word_at(const char* bytes, std::size_t size) noexcept {
  if (size == 8) return word_at(bytes);
  if (size >= 4) return half_word_at(bytes) | half_word_at(bytes + size - 4) << (8 * (size - 4));
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < size; ++i)
    word |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return word;
}

[[nodiscard]] inline bool equal(const char* a, const char* b, std::size_t size) noexcept {
  if (size == 0) return true;  // they may be null then
  if (size < 4 || size > 16) return std::memcmp(a, b, size) == 0;
  if (size < 8)
    return half_word_at(a) == half_word_at(b) &&
           half_word_at(a + size - 4) == half_word_at(b + size - 4);
  return word_at(a) == word_at(b) && word_at(a + size - 8) == word_at(b + size - 8);
}

/// Returns where the copy ends.
inline char* copy(char* to, const char* from, std::size_t size) noexcept {
  if (size == 0) return to;  // `from` may be null then
  if (size < 4 || size > 16) {
    std::memcpy(to, from, size);
  } else if (size < 8) {
    std::memcpy(to, from, 4);
    std::memcpy(to + size - 4, from + size - 4, 4);
  } else {
    std::memcpy(to, from, 8);
    std::memcpy(to + size - 8, from + size - 8, 8);
  }
  return to + size;
}

}  // namespace rsi
