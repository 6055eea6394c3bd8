#include "rsi/server/tcp_read.hpp"

#include <chrono>
#include <cstdint>

namespace rsi {
namespace {

/// A thread that was not kept from it reads sooner after the last segment.
constexpr std::chrono::microseconds kAtOnce{500};

}  // namespace

Timestamp TcpRead::came(std::string_view telegram) const noexcept {
  const auto behind = (bytes.data() + bytes.size()) - (telegram.data() + telegram.size());
  const bool is_last = behind < static_cast<std::ptrdiff_t>(telegram.size());
  if (is_last || taken - last < kAtOnce || last <= after) return last;
  const double part = static_cast<double>(behind) / static_cast<double>(bytes.size());
  const auto span = static_cast<double>((last - after).count());
  return last - Timestamp(static_cast<std::int64_t>(part * span));
}

}  // namespace rsi
