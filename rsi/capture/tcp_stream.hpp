#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "rsi/telegram/tcp_framer.hpp"

namespace rsi {

/// One direction of a TCP connection as a tap sees it: puts the bytes in order again whether
/// segments come twice, late or never, and cuts them into telegrams.
///
/// What comes again is left out by its sequence number, so that neither a mirror nor a repetition
/// of the sender counts twice. A segment that never comes is given up once kMostWaiting others wait
/// behind it: its telegrams are missing then. Takes any bytes. One thread.
class TcpStream {
 public:
  static constexpr std::size_t kMostWaiting = 8;

  using Sink = std::function<void(std::string_view telegram)>;

  /// `root` as TcpFramer's.
  explicit TcpStream(std::string_view root) : framer_(root) {}

  /// `begins`: it is the first of the connection (SYN). A stream that began unseen is joined where
  /// it is.
  void take(std::uint32_t sequence, bool begins, std::string_view bytes, const Sink& telegram);

  /// Bytes that were given up.
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  void append(std::string_view bytes, const Sink& telegram);
  /// Of what waits: all that follows now.
  void go_on(const Sink& telegram);

  TcpFramer framer_;
  bool joined_ = false;
  std::uint32_t next_ = 0;                        // sequence number
  std::map<std::uint32_t, std::string> waiting_;  // segments, by sequence number
  std::uint64_t missed_ = 0;
};

}  // namespace rsi
