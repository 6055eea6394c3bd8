#include "daemon/log.hpp"

#include <cstdlib>
#include <mutex>

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

#include "daemon/log_repeats.hpp"

namespace sweepd {
namespace {

void write_to_journal(const LogLine& line) {
  auto fields = journal_fields(line);
  std::vector<iovec> parts;
  parts.reserve(fields.size());
  for (auto& field : fields) parts.push_back({field.data(), field.size()});
  sd_journal_sendv(parts.data(), static_cast<int>(parts.size()));
}

void write(const LogLine& line) {
  static const bool to_journal = leads_to_journal();
  if (to_journal) return write_to_journal(line);
  const auto level = line.importance == Importance::note      ? spdlog::level::info
                     : line.importance == Importance::warning ? spdlog::level::warn
                                                              : spdlog::level::err;
  spdlog::log(level, line.message());
}

/// What has been said lately, by all threads.
struct Lately {
  std::mutex mutex;
  LogRepeats repeats;
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
  if (lately().repeats.is_new(line, std::chrono::steady_clock::now())) write(line);
}

void log_repeats() {
  const std::lock_guard lock(lately().mutex);
  for (const auto& line : lately().repeats.due(std::chrono::steady_clock::now())) write(line);
}

void log_all_repeats() {
  const std::lock_guard lock(lately().mutex);
  for (const auto& line : lately().repeats.all()) write(line);
}

}  // namespace sweepd
