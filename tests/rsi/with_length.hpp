#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "rsi/telegram/tcp_framer.hpp"

namespace rsi::test {

/// A telegram with its length before it, in which `counted_in` more bytes are counted.
inline std::string with_length(LengthPrefix form, const std::string& xml,
                               std::size_t counted_in = 0) {
  const auto length = static_cast<std::uint32_t>(xml.size() + counted_in);
  return std::string(length_bytes(form, length).view()) + xml;
}

}  // namespace rsi::test
