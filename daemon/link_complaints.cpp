#include "daemon/link_complaints.hpp"

#include <iterator>

namespace sweepd {
namespace {

using Counts = rsi::Server::Counts;

struct Kind {
  std::uint64_t Counts::*count;
  const char* text;  ///< behind the number
};

constexpr Kind kKindsOfTrouble[] = {
    {&Counts::refused,
     "replies did not leave, since they were no zero corrections: stop the robot, this is a fault "
     "of "
     "sweepd; report it with the Ethernet file"},
    {&Counts::not_begun,
     "telegrams were not answered: their stream had begun before sweepd listened, perhaps with "
     "another server, and a zero from here might move the robot: switch RSI off, and on again "
     "after "
     "a second or more"},
    {&Counts::send_failures,
     "replies could not be sent: see `ip -s link` and the firewall of this machine"},
    {&Counts::dropped,
     "telegrams were dropped by the system, whose receive buffer was full: free the machine, or "
     "raise net.core.rmem_max"},
    {&Counts::cut, "telegrams were larger than 64 KiB and came in part: shorten the SEND list"},
    {&Counts::foreign,
     "datagrams or connections from others than the controller were not answered: set `controller` "
     "in the settings, and keep others off this network"},
    {&Counts::overflows,
     "datagrams were answered but neither recorded nor used, since the queue was full: raise "
     "queue_bytes or free the machine"},
};

}  // namespace

void LinkComplaints::new_stream() {
  for (std::size_t i = 0; i < kKinds; ++i)
    if (kKindsOfTrouble[i].count == &Counts::not_begun) said_[i].again = {};
}

std::vector<std::string> LinkComplaints::about(const Counts& counts,
                                               std::chrono::steady_clock::time_point now) {
  static_assert(std::size(kKindsOfTrouble) == kKinds);
  std::vector<std::string> complaints;
  for (std::size_t i = 0; i < kKinds; ++i) {
    const auto count = counts.*kKindsOfTrouble[i].count;
    auto& said = said_[i];
    if (count == said.count || now < said.again) continue;
    complaints.push_back(std::to_string(count - said.count) + ' ' + kKindsOfTrouble[i].text);
    said = {count, now + std::chrono::minutes(1)};
  }
  return complaints;
}

}  // namespace sweepd
