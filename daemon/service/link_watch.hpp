#pragma once

#include <filesystem>
#include <string>

#include "daemon/service/flight_recorder.hpp"
#include "rsi/capture/conversation.hpp"
#include "rsi/link/link_monitor.hpp"

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

/// Watches the link of one session. Constant memory, some 250 kB. One thread.
class LinkWatch {
 public:
  /// `expects_replies`: false for a controller with ONLYSEND.
  LinkWatch(const rsi::Conversation& conversation, bool expects_replies)
      : conversation_(conversation), flight_(expects_replies) {}

  void telegram(const rsi::Datagram& datagram, const rsi::Telegram& telegram, rsi::Defect defect);
  /// An empty payload: the system refused to send it.
  void reply(const rsi::Datagram& datagram);

  /// So many telegrams of this session were not answered on purpose.
  void withheld(std::uint64_t telegrams) { withheld_ = telegrams; }

  /// How the link does so far; `at_end`: and how it ended.
  [[nodiscard]] LinkFiles files(bool at_end) const;
  [[nodiscard]] rsi::LinkReport report() const;

 private:
  rsi::Conversation conversation_;
  rsi::LinkMonitor monitor_;
  FlightRecorder flight_;
  std::uint64_t withheld_ = 0;
  bool answered_ = false;
};

/// Writes link.txt and link.json, and last_cycles.csv if there is one, each as a whole. Throws
/// std::runtime_error.
void write_link(const std::filesystem::path& folder, const LinkFiles& files);

}  // namespace sweepd
