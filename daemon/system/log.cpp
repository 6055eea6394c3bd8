#include "daemon/system/log.hpp"

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <utility>

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/system/log_queue.hpp"
#include "daemon/system/log_repeats.hpp"

namespace sweepd {
namespace {

/// Of lines: a reader that stands still for a while has the newest.
constexpr std::size_t kMostWaitingLines = 2048;

/// Null while lines are written at once. Never destroyed: its thread may stand in a write for ever.
std::atomic<LogQueue*> background{nullptr};

bool to_journal() {
  static const bool leads_there = leads_to_journal();
  return leads_there;
}

std::shared_ptr<LogSink> make_sink() {
  return to_journal() ? std::make_shared<LogSink>() : std::make_shared<LogSink>(STDERR_FILENO);
}

/// As LogSink takes it.
std::string payload(const LogLine& line) {
  if (!to_journal()) return line.message();
  std::string fields;
  for (const auto& field : journal_fields(line)) (fields += field) += '\0';
  return fields;
}

void pass_on(const LogLine& line) {
  const auto level = line.importance == Importance::note      ? spdlog::level::info
                     : line.importance == Importance::warning ? spdlog::level::warn
                                                              : spdlog::level::err;
  if (LogQueue* const queue = background)
    queue->write(level, payload(line));
  else
    spdlog::log(level, payload(line));
}

/// What has been said lately, by all threads.
struct Lately {
  std::mutex mutex;
  LogRepeats repeats;
  std::uint64_t losses_told = 0;
};
Lately& lately() {
  static Lately all;
  return all;
}

}  // namespace

/// systemd tells device and inode of the stream that it reads (systemd.exec(5), JOURNAL_STREAM):
/// standard error may have been led elsewhere since.
bool leads_to_journal() {
  const char* stream =
      std::getenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  struct stat status {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &status) == 0 &&
         fmt::format("{}:{}", status.st_dev, status.st_ino) == stream;
}

std::string LogLine::message() const {
  return subject.robot.empty() ? text : subject.robot + ": " + text;
}

std::vector<std::string> journal_fields(const LogLine& line) {
  const char* priority = line.importance == Importance::note      ? "6"
                         : line.importance == Importance::warning ? "4"
                                                                  : "3";
  std::vector<std::string> fields{"MESSAGE=" + line.message(), std::string("PRIORITY=") + priority,
                                  "SYSLOG_IDENTIFIER=sweepd"};
  for (const auto& [name, value] : {std::pair{"SWEEPD_ROBOT=", &line.subject.robot},
                                    std::pair{"SWEEPD_SESSION=", &line.subject.session},
                                    std::pair{"SWEEPD_IPOC=", &line.subject.ipoc}})
    if (!value->empty()) fields.push_back(name + *value);
  return fields;
}

void log(const LogLine& line) {
  const std::lock_guard lock(lately().mutex);
  if (lately().repeats.is_new(line, std::chrono::steady_clock::now())) pass_on(line);
}

void log_at_once() {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("sweepd", make_sink()));
}

void log_in_background() {
  background = new LogQueue(make_sink(), kMostWaitingLines);
}

bool finish_log(std::chrono::milliseconds patience) {
  const LogQueue* const queue = background;
  return queue == nullptr || queue->drain(patience);
}

std::uint64_t log_lines_lost() {
  const LogQueue* const queue = background;
  return queue == nullptr ? 0 : queue->lost();
}

void log_repeats() {
  const std::lock_guard lock(lately().mutex);
  for (const auto& line : lately().repeats.due(std::chrono::steady_clock::now())) pass_on(line);
  const LogQueue* const queue = background;
  if (queue == nullptr || !queue->is_read()) return;
  const auto all = queue->lost();
  const auto lost = all - std::exchange(lately().losses_told, all);
  if (lost == 0) return;
  pass_on(
      {Importance::warning,
       {},
       fmt::format("{} of the log nobody got: whoever reads it stood still, or had no room: see "
                   "what held it up",
                   lost == 1 ? "1 line" : fmt::format("{} lines", lost))});
}

void log_all_repeats() {
  const std::lock_guard lock(lately().mutex);
  for (const auto& line : lately().repeats.all()) pass_on(line);
}

}  // namespace sweepd
