#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string_view>

#include <spdlog/sinks/base_sink.h>

namespace sweepd {

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

}  // namespace sweepd
