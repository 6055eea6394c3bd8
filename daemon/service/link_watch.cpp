#include "daemon/service/link_watch.hpp"

#include <algorithm>
#include <iterator>

#include "daemon/results/link_files.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/counted.hpp"
#include "rsi/link/last_cycles.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {
namespace {

using Counts = rsi::Server::Counts;

struct Kind {
  std::uint64_t Counts::*count = nullptr;
  const char* one = "";
  const char* many = "";
  const char* were = "";  ///< what they were, and what to do
  const char* more = "";
};

constexpr Kind kKindsOfTrouble[] = {
    {&Counts::refused, "reply", "replies",
     "not sent, because a correction was not zero: stop the robot, this is a fault of sweepd; "
     "report it with the Ethernet file"},
    {&Counts::not_begun, "telegram", "telegrams", "not answered: ", rsi::kBegunBefore},
    {&Counts::send_failures, "reply", "replies",
     "refused by the system: see `ip -s link` and the firewall of this machine"},
    {&Counts::dropped, "telegram", "telegrams",
     "dropped by the system, whose receive buffer was full: free the machine, or raise "
     "net.core.rmem_max"},
    {&Counts::missed, "packet", "packets",
     "not seen by the tap, for which this machine was too busy; the link had them: free the "
     "machine"},
    {&Counts::cut, "telegram", "telegrams",
     "larger than 64 KiB and came in part: shorten the SEND list"},
    {&Counts::foreign, "datagram or connection", "datagrams or connections",
     "not from the controller, or without an IPOC before anything with one came, and not answered: "
     "keep others off this network, see that the controller sends RSI, and name it by `controller` "
     "in the settings"},
    {&Counts::skipped, "byte", "bytes",
     "left out of a TCP stream, being in no telegram: see that `listen` is the port of RSI alone, "
     "and what the controller sends"},
    {&Counts::overflows, "datagram", "datagrams",
     "neither recorded nor used, since the queue was full: raise queue_bytes or free "
     "the machine"},
};

rsi::LinkReport completed(rsi::LinkReport report, const LinkWatch& of) {
  report.replies.withheld = of.withheld;
  report.missed_by_tap = of.missed_by_tap;
  report.queue_full = of.queue_full;
  report.from_recording = of.from_recording;
  report.replies.unanswered -= std::min(report.replies.unanswered, of.withheld);
  return report;
}

}  // namespace

void LinkWatch::count(const Counts& now, const Counts& before) {
  withheld = now.not_begun - before.not_begun;
  missed_by_tap = now.missed - before.missed;
  queue_full = now.overflows - before.overflows;
}

rsi::LinkReport LinkWatch::report(const rsi::Link& link) const {
  return completed(link.report(), *this);
}

rsi::Link::Reports LinkWatch::reports(const rsi::Link& link) const {
  const rsi::Link::Reports reports = link.reports();
  return {completed(reports.now, *this), completed(reports.settled, *this)};
}

LinkFiles LinkWatch::files(const rsi::Link& link, bool at_end) const {
  const auto report = this->report(link);
  const auto verdict = rsi::verdict(report);
  LinkFiles files;
  files.good = verdict.grade == rsi::Grade::good;
  files.verdict = rsi::text(verdict.grade);
  if (!files.good) files.verdict += ": " + std::string(verdict.worst());
  files.text = link_text(conversation, report);
  files.json = link_json(conversation, report);
  if (!at_end) return files;
  const rsi::LastCycles last(link, expects_replies, withheld);
  files.bad_end = last.reason();
  if (withheld > 0 && report.replies.sent == 0)
    files.bad_end = "it was not answered, since it had begun before sweepd listened";
  if (!files.bad_end.empty()) files.last_cycles = last.csv();
  return files;
}

void write_link(const std::filesystem::path& folder, const LinkFiles& files) {
  write_atomically(folder / file_names::kLinkText, files.text);
  write_atomically(folder / file_names::kLink, files.json);
  if (!files.last_cycles.empty())
    write_atomically(folder / file_names::kLastCycles, files.last_cycles);
}

void LinkComplaints::new_stream() {
  for (std::size_t i = 0; i < kKinds; ++i)
    if (kKindsOfTrouble[i].count == &Counts::not_begun) said_[i].again = {};
}

std::vector<std::string> LinkComplaints::about(const Counts& counts,
                                               std::chrono::steady_clock::time_point now) {
  static_assert(std::size(kKindsOfTrouble) == kKinds);
  std::vector<std::string> complaints;
  for (std::size_t i = 0; i < kKinds; ++i) {
    const Kind& kind = kKindsOfTrouble[i];
    const auto count = counts.*kind.count;
    auto& said = said_[i];
    if (count == said.count || now < said.again) continue;
    complaints.push_back(rsi::counted(count - said.count, kind.one, kind.many) +
                         (count - said.count == 1 ? " was " : " were ") + kind.were + kind.more);
    said = {count, now + std::chrono::minutes(1)};
  }
  return complaints;
}

std::vector<std::string> LinkComplaints::rest(const Counts& counts) {
  for (Said& said : said_) said.again = {};
  return about(counts, {});
}

}  // namespace sweepd
