#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>

#include <spdlog/async_logger.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>

namespace sweepd {

// The way of the log's lines to whoever reads them.

/// Where the log's lines end: in systemd's journal, whose fields a line then holds, each ended by
/// a NUL, or as text with the time on a file descriptor. Whoever calls it waits for whoever reads.
class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// To the journal.
  LogSink();
  /// As text; the descriptor stays the caller's.
  explicit LogSink(int descriptor);

  /// Lines that came here, and those of them that could not be written. Any thread.
  [[nodiscard]] std::uint64_t taken() const noexcept { return taken_; }
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_; }
  /// Whether the newest one could be written.
  [[nodiscard]] bool well() const noexcept { return well_; }

 private:
  static constexpr int kJournal = -1;

  void sink_it_(const spdlog::details::log_msg& line) override;
  void flush_() override {}
  bool write(const spdlog::details::log_msg& line);

  const int descriptor_;
  const bool in_colour_;
  std::atomic<bool> well_{true};
  std::atomic<std::uint64_t> taken_{0}, failed_{0};
};

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
