#include "rsi/telegram/ipoc.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

/// What ends a name, and what matters inside of a tag.
constexpr auto kMarkup = [] {
  std::array<bool, 256> markup{};
  for (const char c : {'=', '>', '<'}) markup[static_cast<unsigned char>(c)] = true;
  return markup;
}();

/// Walks over tags, comments and values in quotation marks. An end that is missing is looked for
/// once, so that the work grows with the size alone whatever the bytes are.
class Walk {
 public:
  explicit Walk(std::string_view text) noexcept
      : at_(text.data()), end_(text.data() + text.size()) {}

  /// To the next '<'; false at the end.
  bool to_tag() noexcept {
    at_ = find(at_, '<');
    return at_ != end_;
  }

  /// The byte behind the '<'.
  [[nodiscard]] char kind() const noexcept { return end_ - at_ > 1 ? at_[1] : '\0'; }

  /// Behind the comment or the like that begins here. False if it has no end: then it is a damaged
  /// tag.
  bool skip_no_element() noexcept {
    const std::string_view rest(at_, static_cast<std::size_t>(end_ - at_));
    if (rest.starts_with("<!--")) return skip_to(Ending::comment, "-->", 4);
    if (rest.starts_with("<![CDATA[")) return skip_to(Ending::cdata, "]]>", 9);
    if (rest.starts_with("<?")) return skip_to(Ending::instruction, "?>", 2);
    return skip_to(Ending::tag, ">", 2);
  }

  /// Behind the end tag that begins here, or to the end.
  void skip_end_tag() noexcept { at_ = find(at_, '>'); }

  /// Behind the start tag that begins here. Whether it opens an element <IPOC>.
  bool opens_ipoc() noexcept {
    const char* at = at_ + 1;
    const bool is_ipoc = end_ - at > 4 && lower(*at) == 'i' &&
                         equal_ignoring_case({at, 4}, "IPOC") &&
                         std::string_view(" \t\r\n=></\"'").find(at[4]) != std::string_view::npos;
    for (; at != end_; ++at) {
      if (!kMarkup[static_cast<unsigned char>(*at)]) continue;
      if (*at == '=')
        at = behind_value(at + 1) - 1;
      else
        break;
    }
    at_ = at;
    if (at == end_) return false;
    if (*at == '<') return is_ipoc;  // the '>' is missing
    ++at_;
    return is_ipoc && at[-1] != '/';
  }

  /// The text from here to the end tag that follows it; nothing if something else follows.
  std::string_view leaf() noexcept {
    const char* const begin = at_;
    if (!to_tag() || kind() != '/') return {};
    return trimmed({begin, static_cast<std::size_t>(at_ - begin)});
  }

 private:
  enum class Ending : std::uint8_t { comment, cdata, instruction, tag, quote, apostrophe };

  /// The next `wanted`, or the end.
  [[nodiscard]] const char* find(const char* at, char wanted) const noexcept {
    const void* found = std::memchr(at, wanted, static_cast<std::size_t>(end_ - at));
    return found == nullptr ? end_ : static_cast<const char*>(found);
  }

  bool skip_to(Ending ending, std::string_view end, std::ptrdiff_t begin) noexcept {
    bool& missing = missing_[static_cast<std::size_t>(ending)];
    if (missing) return false;
    const char* const found = std::search(at_ + begin, end_, end.begin(), end.end());
    missing = found == end_;
    if (!missing) at_ = found + end.size();
    return !missing;
  }

  /// Behind the value in quotation marks; where none begins, or it has no end, where it was.
  const char* behind_value(const char* const at) noexcept {
    const char* quote = at;
    while (quote != end_ && is_blank(*quote)) ++quote;
    if (quote == end_ || (*quote != '"' && *quote != '\'')) return at;
    bool& missing =
        missing_[static_cast<std::size_t>(*quote == '"' ? Ending::quote : Ending::apostrophe)];
    if (missing) return at;
    const char* const found = find(quote + 1, *quote);
    missing = found == end_;
    return missing ? at : found + 1;
  }

  const char* at_;
  const char* end_;
  std::array<bool, 6> missing_{};  // by Ending
};

constexpr std::string_view kTag = "<IPOC";

std::string_view usable(std::string_view digits) noexcept {
  return usable_ipoc(digits) ? digits : std::string_view();
}

/// The rule itself.
std::string_view walk_to_last_ipoc(std::string_view datagram) noexcept {
  std::string_view found;
  Walk walk(datagram);
  while (walk.to_tag()) {
    const char kind = walk.kind();
    if ((kind == '!' || kind == '?') && walk.skip_no_element()) continue;
    if (kind == '/')
      walk.skip_end_tag();
    else if (walk.opens_ipoc())
      if (const auto digits = usable(walk.leaf()); !digits.empty()) found = digits;
  }
  return found;
}

/// Where "<IPOC" stands last, in any case.
std::size_t last_ipoc_tag(std::string_view datagram) noexcept {
  if (datagram.size() < kTag.size()) return std::string_view::npos;
  for (auto at = datagram.size() - kTag.size() + 1; at-- > 0;)
    if (datagram[at] == '<' && lower(datagram[at + 1]) == 'i' &&
        equal_ignoring_case(datagram.substr(at, kTag.size()), kTag))
      return at;
  return std::string_view::npos;
}

/// The digits of a plain <IPOC>…</ whose tag stands last, if nothing can hide it: it follows a tag,
/// and nothing behind it ends a comment or a value. So nearly every telegram ends, and so it costs
/// a tenth of the walk.
std::string_view plain_ipoc(std::string_view datagram, std::size_t at) noexcept {
  auto before = datagram.substr(0, at);
  while (!before.empty() && is_blank(before.back())) before.remove_suffix(1);
  if (!before.ends_with('>')) return {};
  auto rest = datagram.substr(at + kTag.size());
  if (!rest.starts_with('>')) return {};
  const auto end = rest.find('<');
  if (end == std::string_view::npos || !rest.substr(end).starts_with("</")) return {};
  for (const char c : rest.substr(end))
    if (c == '"' || c == '\'' || c == '-' || c == ']' || c == '?') return {};
  return usable(trimmed(rest.substr(1, end - 1)));
}

}  // namespace

std::string_view find_ipoc(std::string_view datagram) noexcept {
  const auto last = last_ipoc_tag(datagram);
  if (last == std::string_view::npos) return {};
  const auto plain = plain_ipoc(datagram, last);
  return plain.empty() ? walk_to_last_ipoc(datagram) : plain;
}

std::optional<std::uint64_t> usable_ipoc(std::string_view digits) noexcept {
  constexpr std::size_t kMostDigits = 20;
  return digits.size() <= kMostDigits ? ipoc_number(digits) : std::nullopt;
}

std::optional<std::uint64_t> ipoc_number(std::string_view digits) noexcept {
  std::uint64_t value = 0;
  const auto* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace rsi
