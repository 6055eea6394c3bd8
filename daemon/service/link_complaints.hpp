#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rsi/server/server.hpp"

namespace sweepd {

/// Turns the counts of a server into sentences for the log: each kind of trouble at once when it
/// comes up, then at most once a minute with all that has come since. One thread.
class LinkComplaints {
 public:
  /// A stream that is not answered is said however soon it follows another.
  void new_stream();
  /// What is new, for the time `now` of any steady clock: what, how many, what to do.
  [[nodiscard]] std::vector<std::string> about(const rsi::Server::Counts& counts,
                                               std::chrono::steady_clock::time_point now);
  /// The end: also what waits for its minute.
  [[nodiscard]] std::vector<std::string> rest(const rsi::Server::Counts& counts);

 private:
  struct Said {
    std::uint64_t count = 0;
    std::chrono::steady_clock::time_point again{};  ///< not before
  };
  static constexpr std::size_t kKinds = 9;

  std::array<Said, kKinds> said_{};
};

}  // namespace sweepd
