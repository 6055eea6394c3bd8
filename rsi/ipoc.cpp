#include "rsi/ipoc.hpp"

#include <charconv>

#include "rsi/ascii.hpp"

namespace rsi {

std::string_view find_ipoc(std::string_view datagram) noexcept {
  constexpr std::string_view kTag = "<IPOC";
  constexpr std::size_t kMostDigits = 20;
  for (auto at = datagram.rfind('<'); at != std::string_view::npos;
       at = at == 0 ? std::string_view::npos : datagram.rfind('<', at - 1)) {
    if (!equal_ignoring_case(datagram.substr(at, kTag.size()), kTag)) continue;
    std::string_view rest = datagram.substr(at + kTag.size());
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (!rest.starts_with('>')) continue;
    rest.remove_prefix(1);
    const auto end = rest.find('<');
    if (end == std::string_view::npos) continue;
    const std::string_view digits = trimmed(rest.substr(0, end));
    if (!digits.empty() && digits.size() <= kMostDigits &&
        digits.find_first_not_of("0123456789") == std::string_view::npos)
      return digits;
  }
  return {};
}

std::optional<std::uint64_t> ipoc_number(std::string_view digits) noexcept {
  std::uint64_t value = 0;
  const auto* end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

}  // namespace rsi
