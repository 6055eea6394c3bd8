#include "daemon/session_replay.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "daemon/recording_files.hpp"
#include "daemon/run_json.hpp"
#include "daemon/utc.hpp"
#include "rsi/capture_order.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> traces_of(const fs::path& folder) {
  std::vector<fs::path> traces;
  for (unsigned part = 1;; ++part) {
    auto trace = folder / part_name("trace", ".pcap", part);
    if (!fs::is_regular_file(trace)) return traces;
    traces.push_back(std::move(trace));
  }
}

}  // namespace

SessionReplay::SessionReplay(fs::path folder, const RobotSetup& setup)
    : folder_(std::move(folder)), lock_(folder_) {
  if (!lock_.held()) throw std::runtime_error(folder_.string() + ": another sweepd writes there");
  traces_ = rsi::in_order_of_time(traces_of(folder_));
  const auto search = rsi::find_conversation(traces_);
  if (search.chosen) conversation_ = *search.chosen;
  std::reverse(traces_.begin(), traces_.end());
  session_ = std::make_unique<Session>(setup, "trace", Session::Events{});
}

bool SessionReplay::step() {
  constexpr int kDatagrams = 20'000;
  for (int i = 0; i < kDatagrams; ++i) {
    if (!trace_) {
      if (traces_.empty()) return false;
      trace_.emplace(traces_.back());
      traces_.pop_back();
    }
    const auto datagram = trace_->next();
    if (!datagram) {
      trace_.reset();
      continue;
    }
    newest_ = std::max(newest_, datagram->time);
    if (conversation_.direction(*datagram) == rsi::Direction::from_controller)
      session_->telegram(*datagram);
  }
  return true;
}

SessionEnd SessionReplay::end(Log log) {
  session_->finish();
  const auto started = folder_.filename().string();
  log.about(started, {});
  SessionEnd end{folder_.parent_path(),
                 started,
                 nullptr,
                 folder_,
                 session_->snapshot(),
                 std::nullopt,
                 [ended = utc_name(newest_)](const fs::path& folder) {
                   return run_json_of_cut_session(folder, ended);
                 },
                 std::move(log)};
  end.lock = std::move(lock_);
  return end;
}

}  // namespace sweepd
