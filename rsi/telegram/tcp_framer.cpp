#include "rsi/telegram/tcp_framer.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

constexpr std::array kForms{LengthPrefix::decimal, LengthPrefix::binary32_be,
                            LengthPrefix::binary32_le, LengthPrefix::binary16_be,
                            LengthPrefix::binary16_le};

LengthBytes binary(std::uint32_t length, std::size_t size, bool high_first) noexcept {
  LengthBytes bytes;
  bytes.size = size;
  for (std::size_t i = 0; i < size; ++i)
    bytes.bytes[high_first ? size - 1 - i : i] = static_cast<char>(length >> 8 * i & 0xff);
  return bytes;
}

/// How many bytes of this form at the end of `before` say `length`; 0 if they do not.
std::size_t match(std::string_view before, LengthPrefix form, std::uint32_t length) noexcept {
  const auto bytes = length_bytes(form, length);
  if (!before.ends_with(bytes.view())) return 0;
  if (form != LengthPrefix::decimal) return bytes.size;
  auto rest = before.substr(0, before.size() - bytes.size);
  while (rest.ends_with('0')) rest.remove_suffix(1);
  return rest.empty() || !is_digit(rest.back()) ? before.size() - rest.size() : 0;
}

std::size_t match_any(std::string_view before, LengthPrefix form, std::uint32_t length) noexcept {
  if (form == LengthPrefix::none) return 0;
  constexpr std::uint32_t kMostBehind = 2;
  for (std::uint32_t behind = 0; behind <= kMostBehind; ++behind)
    if (const auto size = match(before, form, length + behind); size > 0) return size;
  return 0;
}

/// Whether these may be just the bytes that controllers put between telegrams.
bool says_nothing(std::string_view bytes) noexcept {
  return std::all_of(bytes.begin(), bytes.end(), [](char c) { return is_blank(c) || c == '\0'; });
}

}  // namespace

std::string_view text(LengthPrefix form) noexcept {
  switch (form) {
    case LengthPrefix::none:
      return "none";
    case LengthPrefix::decimal:
      return "decimal digits";
    case LengthPrefix::binary16_be:
      return "two bytes, high byte first";
    case LengthPrefix::binary16_le:
      return "two bytes, low byte first";
    case LengthPrefix::binary32_be:
      return "four bytes, high byte first";
    case LengthPrefix::binary32_le:
      return "four bytes, low byte first";
  }
  return "";
}

LengthBytes length_bytes(LengthPrefix form, std::uint32_t length) noexcept {
  LengthBytes bytes;
  switch (form) {
    case LengthPrefix::none:
      break;
    case LengthPrefix::decimal: {
      char* const begin = bytes.bytes.data();
      const auto end = std::to_chars(begin, begin + bytes.bytes.size(), length).ptr;
      bytes.size = static_cast<std::size_t>(end - begin);
      break;
    }
    case LengthPrefix::binary16_be:
      return binary(length, 2, true);
    case LengthPrefix::binary16_le:
      return binary(length, 2, false);
    case LengthPrefix::binary32_be:
      return binary(length, 4, true);
    case LengthPrefix::binary32_le:
      return binary(length, 4, false);
  }
  return bytes;
}

FoundLength find_length(std::string_view before, std::uint32_t length,
                        LengthPrefix likely) noexcept {
  if (before.empty()) return {};
  if (const auto size = match_any(before, likely, length); size > 0) return {likely, size};
  for (const auto form : kForms) {
    const auto size = match_any(before, form, length);
    if (size > 0 && !says_nothing(before.substr(before.size() - size))) return {form, size};
  }
  return {};
}

namespace {

constexpr std::size_t kCapacity = 128 << 10;
/// So many bytes before a telegram are kept to look for a length in.
constexpr std::size_t kLongestLength = 10;
/// More blanks make no end tag: it must be known at some point what a '<' begins.
constexpr std::size_t kLongestTag = 64;

}  // namespace

/// What a '<' begins.
struct TcpFramer::Tag {
  enum Kind : std::uint8_t { incomplete, other, root_start, root_end, ipoc_start, ipoc_end };

  Kind kind = incomplete;
  /// Behind the last byte that had to be seen to know; the end of an end tag.
  std::size_t end = 0;
};

TcpFramer::TcpFramer(std::string_view root) : root_(root), buffer_(new char[kCapacity]) {}

std::span<char> TcpFramer::room() noexcept {
  if (begin_ > 0) {
    std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
    start_ -= std::min(start_, begin_);
    scan_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }
  return {buffer_.get() + end_, kCapacity - end_};
}

std::string_view TcpFramer::next() noexcept {
  while (scan_ < end_) {
    const auto* const found =
        static_cast<const char*>(std::memchr(buffer_.get() + scan_, '<', end_ - scan_));
    scan_ = found == nullptr ? end_ : static_cast<std::size_t>(found - buffer_.get());
    if (found == nullptr) break;
    const Tag tag = tag_at(scan_);
    if (tag.kind == Tag::incomplete) break;
    if (inside_ != Inside::nothing && tag.end - start_ > kLargestTelegram) abandon();

    const bool in_root = inside_ == Inside::root;
    const bool in_ipoc = inside_ == Inside::ipoc;
    if ((tag.kind == Tag::root_end && in_root) || (tag.kind == Tag::ipoc_end && in_ipoc))
      return finish(tag.end);
    if (tag.kind == Tag::root_start || (tag.kind == Tag::ipoc_start && !in_root)) {
      forget_before(scan_);
      start_ = scan_;
      inside_ = tag.kind == Tag::root_start ? Inside::root : Inside::ipoc;
    } else if (in_ipoc) {
      abandon();
    }
    ++scan_;
  }
  if (inside_ != Inside::nothing && end_ - start_ > kLargestTelegram) abandon();
  if (inside_ == Inside::nothing) forget_before(scan_);
  return {};
}

void TcpFramer::reset() noexcept {
  count_skipped(begin_, end_);
  inside_ = Inside::nothing;
  begin_ = start_ = scan_ = end_ = 0;
  prefix_ = LengthPrefix::none;
}

TcpFramer::Tag TcpFramer::tag_at(std::size_t at) const noexcept {
  constexpr std::string_view kIpoc = "IPOC";
  const std::size_t longest = std::max(root_.size(), kIpoc.size());
  const std::string_view text(buffer_.get() + at, end_ - at);
  const bool closing = text.size() > 1 && text[1] == '/';
  const std::size_t name_at = closing ? 2 : 1;

  std::size_t i = name_at;
  while (i < text.size() && i - name_at <= longest && !is_blank(text[i]) && text[i] != '>' &&
         text[i] != '/')
    ++i;
  if (i - name_at > longest) return {Tag::other, at + i};
  if (i == text.size()) return {};
  const auto name = text.substr(name_at, i - name_at);
  const bool is_root = equal_ignoring_case(name, root_);
  if (!is_root && !equal_ignoring_case(name, kIpoc)) return {Tag::other, at + i + 1};
  if (!closing) return {is_root ? Tag::root_start : Tag::ipoc_start, at + i + 1};

  while (i < text.size() && i < kLongestTag && is_blank(text[i])) ++i;
  if (i == text.size()) return {};
  if (text[i] != '>') return {Tag::other, at + i + 1};
  return {is_root ? Tag::root_end : Tag::ipoc_end, at + i + 1};
}

std::string_view TcpFramer::finish(std::size_t end) noexcept {
  const std::string_view telegram(buffer_.get() + start_, end - start_);
  const std::string_view before(buffer_.get() + begin_, start_ - begin_);
  const auto length = find_length(before, static_cast<std::uint32_t>(telegram.size()), prefix_);
  prefix_ = length.form;
  count_skipped(begin_, start_ - length.size);
  inside_ = Inside::nothing;
  begin_ = scan_ = end;
  return telegram;
}

void TcpFramer::forget_before(std::size_t end) noexcept {
  if (end < begin_ + kLongestLength) return;
  count_skipped(begin_, end - kLongestLength);
  begin_ = end - kLongestLength;
}

void TcpFramer::count_skipped(std::size_t begin, std::size_t end) noexcept {
  skipped_ +=
      static_cast<std::uint64_t>(std::count_if(buffer_.get() + begin, buffer_.get() + end,
                                               [](char c) { return !is_blank(c) && c != '\0'; }));
}

}  // namespace rsi
