#include "daemon/system/log_queue.hpp"

#include <csignal>
#include <thread>
#include <utility>

#include "daemon/system/realtime.hpp"

namespace sweepd {
namespace {

/// Signals are another thread's.
void begin_thread() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  name_thread("log");
}

}  // namespace

LogQueue::LogQueue(std::shared_ptr<LogSink> sink, std::size_t most_lines)
    : sink_(std::move(sink)),
      pool_(std::make_shared<spdlog::details::thread_pool>(most_lines, 1, begin_thread)),
      logger_(std::make_shared<spdlog::async_logger>(
          "sweepd", sink_, pool_, spdlog::async_overflow_policy::overrun_oldest)) {}

void LogQueue::write(spdlog::level::level_enum level, std::string_view line) {
  ++given_;
  logger_->log(level, spdlog::string_view_t(line.data(), line.size()));
}

std::uint64_t LogQueue::lost() const {
  return pool_->overrun_counter() + sink_->failed();
}

bool LogQueue::idle() const {
  return sink_->taken() + pool_->overrun_counter() >= given_;
}

bool LogQueue::drain(std::chrono::milliseconds patience) const {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!idle()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace sweepd
