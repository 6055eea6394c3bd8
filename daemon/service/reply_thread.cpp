#include "daemon/service/reply_thread.hpp"

#include <utility>

namespace sweepd {

RealTimeReport ReplyThread::start(const RealTimeSettings& wish) {
  std::promise<RealTimeReport> ready;
  auto report = ready.get_future();
  thread_ = std::thread(
      [this, wish, ready = std::move(ready)]() mutable { serve(wish, std::move(ready)); });
  return report.get();
}

void ReplyThread::stop() {
  if (!runs()) return;
  server_.stop();
  thread_.join();
}

void ReplyThread::serve(const RealTimeSettings& wish, std::promise<RealTimeReport> ready) {
  name_thread("reply");
  RealTimeReport report;
  if (wish.wish != RealTime::off) lock_memory(report);
  enter_real_time(wish, report);
  server_.warm();
  ready.set_value(std::move(report));
  server_.run();
}

}  // namespace sweepd
