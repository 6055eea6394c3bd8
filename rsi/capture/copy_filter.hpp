#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "rsi/datagram.hpp"

namespace rsi {

/// Lets each datagram through once where a tap sees all of them several times: a switch that
/// mirrors both directions of two ports, an interface and the bridge that it is part of.
///
/// Copies of one packet have the same addresses, the same bytes and the same IP identification, and
/// come within kTogether. A packet that its sender sent twice, or that the network doubled, looks
/// the same: which of the two it is, only the others tell. A tap doubles all packets of a
/// direction, a link now and then one. So of a direction's last packets the most frequent number of
/// copies is the tap's own, and every so manieth copy is let through: telegrams that the link
/// doubled stay double, and one whose copy the tap has missed stays single.
///
/// The first packets wait until kDecides have told that number. Datagrams keep their order and
/// their time, the one of the first copy. Takes any bytes. One thread.
class CopyFilter {
 public:
  /// Copies come within this, though the kernel stamps one of them a time slice late. Two telegrams
  /// never do with the same IPOC, but where one was doubled.
  static constexpr std::chrono::milliseconds kTogether{20};
  /// So many packets tell how often each comes.
  static constexpr std::size_t kDecides = 32;

  using Sink = std::function<void(const Datagram&)>;

  /// `pass` takes what is let through, while take() or settle() runs.
  explicit CopyFilter(Sink pass) : pass_(std::move(pass)) {}

  /// In the order of the capture. `answers`: it is of the other direction.
  void take(const Datagram& datagram, std::uint16_t identification, bool answers);
  /// Nothing comes at the moment: what waits is decided with what there is.
  void settle();

  /// Packets that were left out.
  [[nodiscard]] std::uint64_t copies() const noexcept { return copies_; }
  /// How often each packet comes, of the direction where that is more.
  [[nodiscard]] unsigned times() const noexcept;

 private:
  /// A packet and its copies.
  struct Group {
    Timestamp first{};
    std::size_t hash = 0;
    unsigned count = 0;
  };
  class Direction {
   public:
    /// How many copies of this packet came before.
    unsigned add(Timestamp time, std::size_t hash);
    /// Groups whose copies have all come, or with `all` every group, tell how many they were.
    void close(Timestamp now, bool all);
    [[nodiscard]] unsigned times() const noexcept { return times_; }
    [[nodiscard]] std::size_t told() const noexcept { return told_.size(); }

   private:
    std::deque<Group> open_;
    std::deque<unsigned> told_;  // of the last kDecides groups
    unsigned times_ = 1;
  };
  struct Held {
    Datagram datagram;
    std::string payload;
    unsigned before;
    bool answers;
  };

  void judge(const Datagram& datagram, unsigned before, bool answers);

  Sink pass_;
  std::array<Direction, 2> directions_;
  bool decided_ = false;
  std::vector<Held> held_;
  std::uint64_t copies_ = 0;
};

}  // namespace rsi
