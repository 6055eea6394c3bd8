#include "daemon/system/process_events.hpp"

namespace sweepd {

ProcessEvents::ProcessEvents(std::initializer_list<int> signals) {
  sigemptyset(&mask_);
  for (const int signal : signals) sigaddset(&mask_, signal);
  pthread_sigmask(SIG_BLOCK, &mask_, nullptr);
  for (const int signal : signals) signals_.add(signal);
  listen();
}

void ProcessEvents::wait_until(Steady::time_point deadline) {
  pthread_sigmask(SIG_UNBLOCK, &mask_, nullptr);
  context_.run_one_until(deadline);
  context_.poll();
  pthread_sigmask(SIG_BLOCK, &mask_, nullptr);
}

void ProcessEvents::wake() {
  boost::asio::post(context_, [] {});
}

std::optional<int> ProcessEvents::next_signal() {
  if (came_.empty()) return std::nullopt;
  const int first = came_.front();
  came_.pop_front();
  return first;
}

void ProcessEvents::listen() {
  signals_.async_wait([this](const boost::system::error_code& error, int signal) {
    if (error) return;
    came_.push_back(signal);
    listen();
  });
}

}  // namespace sweepd
