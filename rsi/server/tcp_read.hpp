#pragma once

#include <string_view>

#include "rsi/datagram.hpp"

namespace rsi {

/// What one read of a TCP connection brought. The kernel stamps each segment, and tells the stamp
/// of the last one it hands over: those before it are lost.
struct TcpRead {
  Timestamp last{};        ///< when the last segment came
  Timestamp after{};       ///< nothing of it came before this
  Timestamp taken{};       ///< when it was read
  std::string_view bytes;  ///< where they lie

  /// When a telegram came that ends in these bytes. The last one came with the last segment. So did
  /// those before it if the thread that reads was there at once: the network held them up. If it
  /// was not, they came evenly since `after`, as controllers send.
  [[nodiscard]] Timestamp came(std::string_view telegram) const noexcept;
};

}  // namespace rsi
