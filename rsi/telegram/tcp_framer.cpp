#include "rsi/telegram/tcp_framer.hpp"

#include <algorithm>
#include <cstring>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

constexpr std::size_t kCapacity = 2 * 65536;
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
