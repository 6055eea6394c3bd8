#include "daemon/system/log_repeats.hpp"

namespace sweepd {
namespace {

LogLine counted(LogLine line, std::uint64_t times) {
  line.text += times == 1 ? " (once more within a minute)"
                          : fmt::format(" ({} times more within a minute)", times);
  return line;
}

}  // namespace

bool LogRepeats::is_new(const LogLine& line, Time now) {
  if (line.importance == Importance::note) return true;
  const Key key{line.subject.robot, line.text};
  const auto found = said_.find(key);
  if (found == said_.end()) {
    // So many different lines in a minute are no repeats.
    if (said_.size() < kMost) said_.emplace(key, Said{now, 0, line});
    return true;
  }
  ++found->second.held_back;
  found->second.newest = line;
  return false;
}

std::vector<LogLine> LogRepeats::due(Time now) {
  std::vector<LogLine> lines;
  for (auto at = said_.begin(); at != said_.end();) {
    Said& said = at->second;
    if (now - said.at < kWindow) {
      ++at;
    } else if (said.held_back == 0) {
      at = said_.erase(at);
    } else {
      lines.push_back(counted(said.newest, said.held_back));
      said.at = now;
      said.held_back = 0;
      ++at;
    }
  }
  return lines;
}

std::vector<LogLine> LogRepeats::all() {
  std::vector<LogLine> lines;
  for (const auto& [key, said] : said_)
    if (said.held_back > 0) lines.push_back(counted(said.newest, said.held_back));
  said_.clear();
  return lines;
}

}  // namespace sweepd
