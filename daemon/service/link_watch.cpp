#include "daemon/service/link_watch.hpp"

#include <algorithm>

#include "daemon/results/link_json.hpp"
#include "daemon/results/link_text.hpp"
#include "daemon/system/atomic_file.hpp"
#include "rsi/link/link_verdict.hpp"

namespace sweepd {

void LinkWatch::telegram(const rsi::Datagram& datagram, const rsi::Telegram& telegram,
                         rsi::Defect defect) {
  monitor_.telegram(datagram, telegram, defect);
  flight_.telegram(datagram, telegram, defect);
}

void LinkWatch::reply(const rsi::Datagram& datagram) {
  if (datagram.payload.empty()) return flight_.send_failed();
  answered_ = true;
  monitor_.reply(datagram);
  flight_.reply(datagram);
}

rsi::LinkReport LinkWatch::report() const {
  auto report = monitor_.report();
  report.replies.withheld = withheld_;
  report.replies.unanswered -= std::min(report.replies.unanswered, withheld_);
  return report;
}

LinkFiles LinkWatch::files(bool at_end) const {
  const auto report = this->report();
  const auto verdict = rsi::verdict(report);
  LinkFiles files;
  files.good = verdict.grade == rsi::Grade::good;
  files.verdict = rsi::text(verdict.grade);
  if (!files.good) files.verdict += ": " + verdict.reasons.front().message;
  files.text = link_text(conversation_, report);
  files.json = link_json(conversation_, report);
  if (!at_end) return files;
  files.bad_end = flight_.reason();
  if (withheld_ > 0 && !answered_)
    files.bad_end = "it was not answered, since it had begun before sweepd listened";
  if (!files.bad_end.empty()) files.last_cycles = flight_.csv();
  return files;
}

void write_link(const std::filesystem::path& folder, const LinkFiles& files) {
  write_atomically(folder / "link.txt", files.text);
  write_atomically(folder / "link.json", files.json);
  if (!files.last_cycles.empty()) write_atomically(folder / "last_cycles.csv", files.last_cycles);
}

}  // namespace sweepd
