#include "daemon/system/log_queue.hpp"

#include <cerrno>
#include <csignal>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <poll.h>
#include <spdlog/pattern_formatter.h>
#include <sys/uio.h>
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>
#include <unistd.h>

#include "daemon/system/realtime.hpp"

namespace sweepd {
namespace {

const char* colour(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return "\033[31m\033[1m";
  return level == spdlog::level::warn ? "\033[33m\033[1m" : "\033[32m";
}

bool send_to_journal(std::string_view fields) {
  std::vector<iovec> parts;
  while (!fields.empty()) {
    const auto size = fields.find('\0');
    if (size == fields.npos) break;
    // The other side only reads.
    parts.push_back({const_cast<char*>(fields.data()), size});
    fields.remove_prefix(size + 1);
  }
  return sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0;
}

bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const auto written = ::write(descriptor, text.data(), text.size());
    if (written > 0) {
      text.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {  // another program made it so that nobody waits
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

/// Signals are another thread's.
void begin_thread() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  name_thread("log");
}

}  // namespace

LogSink::LogSink() : descriptor_(kJournal), in_colour_(false) {}

LogSink::LogSink(int descriptor)
    : base_sink(std::make_unique<spdlog::pattern_formatter>("%H:%M:%S.%e %^%l%$ %v")),
      descriptor_(descriptor),
      in_colour_(::isatty(descriptor) == 1) {}

void LogSink::sink_it_(const spdlog::details::log_msg& line) {
  well_ = write(line);
  if (!well_) ++failed_;
  ++taken_;
}

bool LogSink::write(const spdlog::details::log_msg& line) {
  if (descriptor_ == kJournal) return send_to_journal({line.payload.data(), line.payload.size()});
  spdlog::memory_buf_t formatted;
  formatter_->format(line, formatted);
  std::string text(formatted.data(), formatted.size());
  if (in_colour_) {
    text.insert(line.color_range_end, "\033[m");
    text.insert(line.color_range_start, colour(line.level));
  }
  return write_all(descriptor_, text);
}

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
