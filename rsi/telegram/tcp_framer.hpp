#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

namespace rsi {

/// How the byte length before an XML text is written (PROTCOLLENGTH On). KUKA's form is not known:
/// all that are likely are understood, and a reply has the form of the telegram that it answers.
enum class LengthPrefix : std::uint8_t {
  none,
  decimal,      ///< ASCII digits, no more than are needed
  binary16_be,  ///< two bytes, the high one first
  binary16_le,
  binary32_be,
  binary32_le,
};

[[nodiscard]] std::string_view text(LengthPrefix form) noexcept;

/// The bytes of a length.
struct LengthBytes {
  std::array<char, 10> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::string_view view() const noexcept { return {bytes.data(), size}; }
};

/// The length as it stands on the wire; nothing for `none`. Does not allocate.
[[nodiscard]] LengthBytes length_bytes(LengthPrefix form, std::uint32_t length) noexcept;

/// A length that was found: its form, and how many bytes it takes.
struct FoundLength {
  LengthPrefix form = LengthPrefix::none;
  std::size_t size = 0;
};

/// The length at the end of `before`, which is what stands before an XML text of `length` bytes. A
/// line end, CR LF or NUL behind the XML may be counted in: up to two bytes more. Digits may have
/// leading zeros. Where two forms fit, `likely` is taken, and only `likely` where the bytes may as
/// well be blanks and NULs between telegrams. `none` if none fits.
[[nodiscard]] FoundLength find_length(std::string_view before, std::uint32_t length,
                                      LengthPrefix likely) noexcept;

/// Cuts the byte stream of a TCP connection into telegrams:
///
///     framer.received(recv(framer.room()));
///     while (!(telegram = framer.next()).empty()) …
///
/// A telegram runs from a start tag <Rob …> to the next end tag </Rob>, names in any case, blanks
/// before the '>' of the end tag. Outside of one, an <IPOC>…</IPOC> is a telegram by itself: old
/// controllers begin with one. A start tag inside of a telegram begins it anew: the first was cut
/// off. What stands between telegrams is a length (see LengthPrefix), blanks, NULs, or
/// garbage.
///
/// Whatever bytes come:
/// - the telegrams, their prefix() and skipped() depend on the bytes alone, not on where they were
///   cut, if next() is called after each received() until it returns nothing;
/// - a telegram begins with <Rob or <IPOC, ends with '>', has at most kLargestTelegram bytes, and
///   no byte is part of two;
/// - telegrams and skipped() together have no more bytes than were received;
/// - room() is never empty, once next() returned nothing.
///
/// All memory is taken at construction. One thread.
class TcpFramer {
 public:
  /// What a UDP datagram holds, as which a telegram is recorded. Larger ones are skipped, but for
  /// the IPOC at their end, which is a telegram by itself then.
  static constexpr std::size_t kLargestTelegram = 65507;

  /// `root` is the name of the outer element; "Sen" cuts replies. It must outlive the framer.
  explicit TcpFramer(std::string_view root = "Rob");

  /// Where the next bytes of the stream belong. Ends the validity of telegrams.
  [[nodiscard]] std::span<char> room() noexcept;
  /// So many bytes were put into room().
  void received(std::size_t bytes) noexcept { end_ += bytes; }

  /// The next whole telegram; empty if none is whole yet. Valid until room() or reset().
  [[nodiscard]] std::string_view next() noexcept;

  /// How the length before the last telegram was written.
  [[nodiscard]] LengthPrefix prefix() const noexcept { return prefix_; }

  /// Bytes in no telegram that are neither blank, NUL nor a length. The last ones of a stream count
  /// once more follow, or with reset().
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }

  /// A new stream begins.
  void reset() noexcept;

 private:
  enum class Inside : std::uint8_t { nothing, root, ipoc };
  struct Tag;

  /// The tag at `at`, which holds '<'.
  [[nodiscard]] Tag tag_at(std::size_t at) const noexcept;
  [[nodiscard]] std::string_view finish(std::size_t end) noexcept;
  void abandon() noexcept { inside_ = Inside::nothing; }
  /// Lets go of all before `end` but the few bytes that may hold a length.
  void forget_before(std::size_t end) noexcept;
  void count_skipped(std::size_t begin, std::size_t end) noexcept;

  std::string_view root_;
  std::unique_ptr<char[]> buffer_;
  Inside inside_ = Inside::nothing;
  // Positions in the buffer, in this order.
  std::size_t begin_ = 0;  // of what is still needed: a possible length, then the telegram
  std::size_t start_ = 0;  // of the telegram, if inside of one
  std::size_t scan_ = 0;   // what comes before was looked at
  std::size_t end_ = 0;
  LengthPrefix prefix_ = LengthPrefix::none;
  std::uint64_t skipped_ = 0;
};

}  // namespace rsi
