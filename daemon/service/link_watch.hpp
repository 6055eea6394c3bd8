#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "rsi/capture/conversation.hpp"
#include "rsi/link/link.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// What is known of a link at one moment, ready to be written in any thread.
struct LinkFiles {
  std::string verdict;  ///< a line for the log: the grade, and the worst reason if it is not good
  bool good = true;     ///< nothing to act on
  std::string bad_end;  ///< why the stream ended badly; empty if it did not
  std::string text;     ///< link.txt
  std::string json;     ///< link.json
  std::string last_cycles;  ///< last_cycles.csv; empty if the stream did not end badly
};

/// What is known of one session besides its link's datagrams.
struct LinkWatch {
  rsi::Conversation conversation;
  bool expects_replies = true;  ///< false for a controller with ONLYSEND
  /// So many telegrams of this session were not answered on purpose.
  std::uint64_t withheld = 0;
  /// So many packets a tap did not see, though they passed.
  std::uint64_t missed_by_tap = 0;
  /// So many datagrams the server's queue had no room for.
  std::uint64_t queue_full = 0;
  /// The recording tells: none of the three numbers above is known.
  bool from_recording = false;

  /// What the server has counted since this session began.
  void count(const rsi::Server::Counts& now, const rsi::Server::Counts& before);

  [[nodiscard]] rsi::LinkReport report(const rsi::Link& link) const;
  [[nodiscard]] rsi::Link::Reports reports(const rsi::Link& link) const;
  /// How the link does so far; `at_end`: and how it ended.
  [[nodiscard]] LinkFiles files(const rsi::Link& link, bool at_end) const;
};

/// Writes link.txt and link.json, and last_cycles.csv if there is one, each as a whole. Throws
/// std::runtime_error.
void write_link(const std::filesystem::path& folder, const LinkFiles& files);

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
