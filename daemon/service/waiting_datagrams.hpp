#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "rsi/datagram.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// Datagrams of others than the session's controller. They wait for the answer to whose stream it
/// is: a server needs a few telegrams to tell. One thread.
class WaitingDatagrams {
 public:
  /// More than so many, and the oldest goes.
  static constexpr std::size_t kMost = 64;

  /// `peer`: its address.
  void add(const rsi::Datagram& datagram, rsi::Handling handling, std::uint32_t peer) {
    if (waiting_.size() == kMost) waiting_.pop_front();
    waiting_.push_back({datagram, std::string(datagram.payload), handling, peer});
  }
  void leave_only(std::uint32_t peer) {
    std::erase_if(waiting_, [&](const Waiting& other) { return other.peer != peer; });
  }
  /// Hands over all, the oldest first. What is added meanwhile waits.
  template <typename Take>
  void hand_over(const Take& take) {
    for (Waiting& waiting : std::exchange(waiting_, {})) {
      waiting.datagram.payload = waiting.payload;
      take(waiting.datagram, waiting.handling);
    }
  }

 private:
  struct Waiting {
    rsi::Datagram datagram;
    std::string payload;
    rsi::Handling handling;
    std::uint32_t peer;
  };
  std::deque<Waiting> waiting_;
};

}  // namespace sweepd
