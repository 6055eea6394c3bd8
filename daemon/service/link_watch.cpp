#include "daemon/service/link_watch.hpp"

#include <algorithm>

#include "daemon/results/link_files.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/link/last_cycles.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {

rsi::LinkReport LinkWatch::report(const rsi::Link& link) const {
  auto report = link.report();
  report.replies.withheld = withheld;
  report.missed_by_tap = missed_by_tap;
  report.replies.unanswered -= std::min(report.replies.unanswered, withheld);
  return report;
}

LinkFiles LinkWatch::files(const rsi::Link& link, bool at_end) const {
  const auto report = this->report(link);
  const auto verdict = rsi::verdict(report);
  LinkFiles files;
  files.good = verdict.grade == rsi::Grade::good;
  files.verdict = rsi::text(verdict.grade);
  if (!files.good) files.verdict += ": " + verdict.reasons.front().message;
  files.text = link_text(conversation, report);
  files.json = link_json(conversation, report);
  if (!at_end) return files;
  const rsi::LastCycles last(link, expects_replies);
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

}  // namespace sweepd
