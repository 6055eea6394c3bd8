#include "rsi/endpoint.hpp"

#include <charconv>

namespace rsi {
namespace {

/// A whole decimal number of at most `limit` at the start of `text`, which it consumes.
std::optional<std::uint32_t> take_number(std::string_view& text, std::uint32_t limit) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || value > limit) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

bool take(std::string_view& text, char wanted) {
  if (text.empty() || text.front() != wanted) return false;
  text.remove_prefix(1);
  return true;
}

std::optional<std::uint32_t> take_address(std::string_view& text) {
  std::uint32_t address = 0;
  for (int octet = 0; octet < 4; ++octet) {
    if (octet > 0 && !take(text, '.')) return std::nullopt;
    const auto value = take_number(text, 255);
    if (!value) return std::nullopt;
    address = address << 8 | *value;
  }
  return address;
}

}  // namespace

std::optional<std::uint32_t> parse_address(std::string_view text) {
  const auto address = take_address(text);
  return text.empty() ? address : std::nullopt;
}

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  const auto address = take_address(text);
  if (!address || !take(text, ':')) return std::nullopt;
  const auto port = take_number(text, 65535);
  if (!port || *port == 0 || !text.empty()) return std::nullopt;
  return Endpoint{*address, static_cast<std::uint16_t>(*port)};
}

std::string address_text(std::uint32_t address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    if (!text.empty()) text += '.';
    text += std::to_string(address >> shift & 0xff);
  }
  return text;
}

std::string text(const Endpoint& endpoint) {
  return address_text(endpoint.address) + ":" + std::to_string(endpoint.port);
}

}  // namespace rsi
