#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>

#include "daemon/system/log_sink.hpp"

namespace sweepd {

/// The lines that wait for whoever reads the log, and the thread that writes them. Nobody waits for
/// a reader: while it stands still, the oldest lines go, and are counted. All functions are any
/// thread's. The destructor alone waits: for the lines that are left.
class LogQueue {
 public:
  LogQueue(std::shared_ptr<LogSink> sink, std::size_t most_lines);

  void write(spdlog::level::level_enum level, std::string_view line);
  /// Lines that nobody got: there was no room for them, or they could not be written.
  [[nodiscard]] std::uint64_t lost() const;
  /// All that came by now is written or lost.
  [[nodiscard]] bool idle() const;
  /// And the newest line was written.
  [[nodiscard]] bool is_read() const { return idle() && sink_->well(); }
  /// Waits until all is written or lost: true. Or for `patience`.
  bool drain(std::chrono::milliseconds patience) const;

 private:
  const std::shared_ptr<LogSink> sink_;
  const std::shared_ptr<spdlog::details::thread_pool> pool_;
  const std::shared_ptr<spdlog::async_logger> logger_;
  std::atomic<std::uint64_t> given_{0};
};

}  // namespace sweepd
