#include "daemon/page/live_stream.hpp"

#include <algorithm>
#include <string_view>

#include "daemon/page/page_json.hpp"

namespace sweepd {
namespace {

void add(std::string& text, std::string_view event, std::string_view data) {
  text += "event: ";
  text += event;
  text += "\ndata: ";
  text += data;
  text += "\n\n";
}

/// False if it is what `known` is already.
template <typename State>
bool take(std::shared_ptr<const State>& known, std::shared_ptr<const State> newest) {
  if (known == newest) return false;
  known = std::move(newest);
  return true;
}

}  // namespace

LiveStream::LiveStream(const Published<ServiceStatus>& status,
                       std::shared_ptr<const RobotStatus> robot)
    : status_(status), robot_(std::move(robot)) {}

std::optional<std::string> LiveStream::next() {
  const auto& served = status_.newest()->robots;
  if (std::find(served.begin(), served.end(), robot_) == served.end()) return std::nullopt;
  std::string text;
  const bool first = !state_;
  const bool news = take(state_, robot_->state.newest());
  if (first) text += "retry: 1000\n\n";
  if (take(facts_, robot_->facts.newest())) add(text, "hello", hello_json(state_->name, *facts_));
  const auto result = robot_->result.newest();
  if (news) add(text, "link", link_json({state_, result}));
  add_slices(text);
  if (take(result_, result) && result_->newest)
    add(text, "result", result_event_json(*result_->newest));
  return text;
}

void LiveStream::add_slices(std::string& text) {
  const bool first = slice_ == 0;
  const auto news = robot_->live.after(slice_, sweep_, first ? LiveSlices::kSlices : kMostBehind);
  if (news.missed > 0 && !first)
    add(text, "gap", "{\"missed\":" + std::to_string(news.missed) + "}");
  for (auto begin = news.slices.begin(); begin != news.slices.end();) {
    const auto end = std::find_if(begin, news.slices.end(), [&](const LiveSlice& slice) {
      return slice.session != begin->session;
    });
    const std::vector<LiveSlice> slices(begin, end);
    add(text, "samples", samples_json(slices));
    text += "id: " + std::to_string(slices.back().number) + '\n';
    add(text, "cycles", cycles_json(slices));
    begin = end;
  }
  for (const auto& sweep : news.sweeps) {
    add(text, "sweep", sweep_json(*sweep));
    sweep_ = sweep->number;
  }
  if (!news.slices.empty()) slice_ = news.slices.back().number;
}

}  // namespace sweepd
