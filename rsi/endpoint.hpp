#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rsi {

/// An IPv4 address and a UDP port, both in host byte order. RSI controllers speak IPv4 only.
struct Endpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend bool operator==(const Endpoint&, const Endpoint&) = default;
  friend auto operator<=>(const Endpoint&, const Endpoint&) = default;
};

/// "192.168.1.20"; nothing if `text` is not four decimal numbers of 0 to 255.
[[nodiscard]] std::optional<std::uint32_t> parse_address(std::string_view text);

/// "192.168.1.20:49152"; nothing if either part is wrong or missing, or the port is 0.
[[nodiscard]] std::optional<Endpoint> parse_endpoint(std::string_view text);

[[nodiscard]] std::string address_text(std::uint32_t address);
[[nodiscard]] std::string text(const Endpoint& endpoint);

}  // namespace rsi
