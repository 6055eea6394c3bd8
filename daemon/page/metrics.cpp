#include "daemon/page/metrics.hpp"

#include <array>
#include <charconv>
#include <string_view>
#include <utility>

namespace sweepd {
namespace {

using std::chrono::nanoseconds;
using Labels = std::vector<std::pair<std::string_view, std::string>>;

template <typename Number>
std::string text(Number number) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  return {digits.data(), end};
}

double seconds(nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

std::string escaped(std::string_view value) {
  std::string escaped;
  for (const char c : value) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? "\\n" : std::string(1, c);
  }
  return escaped;
}

/// Writes family after family, and the values of each behind it.
class MetricsWriter {
 public:
  void counter(std::string_view name, std::string_view help) { family(name, "counter", help); }
  void gauge(std::string_view name, std::string_view help) { family(name, "gauge", help); }
  void histogram(std::string_view name, std::string_view help) { family(name, "histogram", help); }

  template <typename Number>
  void value(const Labels& labels, Number number) {
    line("", labels, text(number));
  }
  void value(const Labels& labels, const DurationCounts& durations) {
    Labels bucket = labels;
    bucket.emplace_back("le", "");
    for (std::size_t i = 0; i < durations.limits.size(); ++i) {
      bucket.back().second = text(seconds(durations.limits[i]));
      line("_bucket", bucket, text(durations.at_most[i]));
    }
    bucket.back().second = "+Inf";
    line("_bucket", bucket, text(durations.count));
    line("_sum", labels, text(seconds(durations.sum)));
    line("_count", labels, text(durations.count));
  }

  [[nodiscard]] std::string text_so_far() && { return std::move(text_); }

 private:
  void family(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    ((((text_ += "# HELP ") += name) += ' ') += help) += '\n';
    ((((text_ += "# TYPE ") += name) += ' ') += type) += '\n';
  }
  void line(std::string_view suffix, const Labels& labels, std::string_view value) {
    (text_ += name_) += suffix;
    char before = '{';
    for (const auto& [key, label] : labels)
      ((((text_ += std::exchange(before, ',')) += key) += "=\"") += escaped(label)) += '"';
    if (!labels.empty()) text_ += '}';
    ((text_ += ' ') += value) += '\n';
  }

  std::string_view name_;
  std::string text_;
};

struct LinkRow {
  std::string_view name, help;
  std::uint64_t LinkTotals::*count;
};
constexpr LinkRow kLink[] = {
    {"sweepd_telegrams_total", "Telegrams with an IPOC that came, duplicates included.",
     &LinkTotals::telegrams},
    {"sweepd_telegrams_lost_total",
     "Cycles of which no telegram came. One whose telegram a later one overtook may stay counted "
     "in place of the next that is lost.",
     &LinkTotals::lost},
    {"sweepd_telegrams_duplicated_total", "Telegrams that came again.", &LinkTotals::duplicated},
    {"sweepd_telegrams_reordered_total", "Telegrams that a later one overtook.",
     &LinkTotals::reordered},
    {"sweepd_telegrams_malformed_total", "Datagrams that were no whole telegram.",
     &LinkTotals::malformed},
    {"sweepd_ipoc_restarts_total", "Times that the IPOC began anew while RSI streamed.",
     &LinkTotals::restarts},
    {"sweepd_clock_steps_total",
     "Times that clock and IPOC parted: the clock was set, or the sender paused.",
     &LinkTotals::clock_steps},
};

struct LabelledRow {
  std::string_view label;
  std::uint64_t LinkTotals::*count;
};
constexpr LabelledRow kAnswers[] = {{"in_time", &LinkTotals::in_time},
                                    {"late", &LinkTotals::late},
                                    {"superseded", &LinkTotals::superseded},
                                    {"unanswered", &LinkTotals::unanswered}};

using Server = rsi::Server::Counts;
struct ServerRow {
  std::string_view label;
  std::uint64_t Server::*count;
};
constexpr ServerRow kReplyFailures[] = {{"refused", &Server::refused},
                                        {"stream_not_begun", &Server::not_begun},
                                        {"send_failed", &Server::send_failures}};
constexpr ServerRow kDropped[] = {{"foreign", &Server::foreign},
                                  {"receive_buffer_full", &Server::dropped},
                                  {"queue_full", &Server::overflows},
                                  {"missed_by_tap", &Server::missed}};

void write_link(MetricsWriter& to, const std::vector<RobotMetrics>& robots) {
  for (const auto& [name, help, count] : kLink) {
    to.counter(name, help);
    for (const auto& [state, result] : robots)
      to.value({{"robot", state->name}}, state->link.*count);
  }
  to.counter("sweepd_controller_missed_replies_total",
             "Replies that the controller missed in time, by its Delay; none where it sends none.");
  for (const auto& [state, result] : robots)
    if (const auto missed = state->link.missed_by_controller)
      to.value({{"robot", state->name}}, *missed);
  to.counter("sweepd_telegrams_answered_total",
             "Telegrams by what became of their reply, once 64 more have come or the stream has "
             "ended.");
  for (const auto& [state, result] : robots)
    for (const auto& [label, count] : kAnswers)
      to.value({{"robot", state->name}, {"outcome", std::string(label)}}, state->link.*count);
  to.histogram("sweepd_reply_latency_seconds", "Time from a telegram to its reply.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->link.latency);
  to.histogram("sweepd_cycle_jitter_seconds",
               "By how much the time from telegram to telegram differs from the cycle, absolute.");
  for (const auto& [state, result] : robots) to.value({{"robot", state->name}}, state->link.jitter);

  to.counter("sweepd_replies_total", "Replies that the reply thread sent.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->server.answered);
  to.counter("sweepd_reply_failures_total",
             "Replies that did not leave: refused as no zero correction or by the system, or "
             "withheld since the beginning of the stream was not seen.");
  for (const auto& [state, result] : robots)
    for (const auto& [label, count] : kReplyFailures)
      to.value({{"robot", state->name}, {"reason", std::string(label)}}, state->server.*count);
  to.counter("sweepd_datagrams_without_ipoc_total",
             "Datagrams of the controller that have no IPOC, and so cannot be answered.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->server.unanswerable);
  to.counter("sweepd_datagrams_dropped_total",
             "Datagrams that were not processed. Foreign: not from the controller, or without an "
             "IPOC before any telegram came. The others: no room for them.");
  for (const auto& [state, result] : robots)
    for (const auto& [label, count] : kDropped)
      to.value({{"robot", state->name}, {"reason", std::string(label)}}, state->server.*count);
}

void write_stream(MetricsWriter& to, const std::vector<RobotMetrics>& robots) {
  to.gauge("sweepd_robot_info", "A robot that is served, and how.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name},
              {"listen", rsi::text(state->listen)},
              {"transport", rsi::text(state->transport)},
              {"replies", state->replies ? "true" : "false"}},
             1);
  to.gauge("sweepd_streaming", "1 while RSI streams, else 0.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->stream ? 1 : 0);
  to.gauge("sweepd_stream_start_time_seconds", "When RSI began, since the epoch.");
  for (const auto& [state, result] : robots)
    if (state->stream) to.value({{"robot", state->name}}, seconds(state->stream->since));
  to.gauge("sweepd_cycle_seconds", "The controller's cycle.");
  for (const auto& [state, result] : robots)
    if (state->stream && state->stream->cycle.count() > 0)
      to.value({{"robot", state->name}}, seconds(state->stream->cycle));
  to.counter("sweepd_sessions_total", "Times that RSI began to stream.");
  for (const auto& [state, result] : robots) to.value({{"robot", state->name}}, state->sessions);
}

void write_recording(MetricsWriter& to, const std::vector<RobotMetrics>& robots) {
  const auto missed = [&](const RobotState& state, const char* reason, std::uint64_t count) {
    to.value({{"robot", state.name}, {"reason", reason}}, count);
  };
  to.gauge("sweepd_recording_paused", "1 while the disk has no room or refuses, else 0.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording_paused ? 1 : 0);
  to.gauge("sweepd_disk_free_bytes",
           "Free on the disk of the recordings, when the recorder last looked.");
  for (const auto& [state, result] : robots)
    if (state->disk_free) to.value({{"robot", state->name}}, *state->disk_free);
  to.counter("sweepd_recording_pauses_total", "Times that the disk had no room or refused.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.pauses);
  to.counter("sweepd_recording_bytes_total", "Written to recordings.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.bytes);
  to.counter("sweepd_recording_files_total", "Files of recordings that were begun.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.files);
  to.counter("sweepd_recording_folders_deleted_total",
             "Folders that were deleted or moved, or had a file cut, while they were written.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.folders_deleted);
  to.counter("sweepd_recorded_datagrams_total", "Datagrams of both directions that are recorded.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.recorded.datagrams);
  to.counter("sweepd_recorded_samples_total", "Samples that are recorded.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->recording.recorded.samples);
  to.counter("sweepd_recording_missed_datagrams_total",
             "Datagrams that are not in the recording, by reason.");
  for (const auto& [state, result] : robots) {
    missed(*state, "memory_full", state->recording.memory_full.datagrams);
    missed(*state, "disk", state->recording.disk.datagrams);
  }
  to.counter("sweepd_recording_missed_samples_total",
             "Samples that are not in the recording, by reason.");
  for (const auto& [state, result] : robots) {
    missed(*state, "memory_full", state->recording.memory_full.samples);
    missed(*state, "disk", state->recording.disk.samples);
  }
}

void write_results(MetricsWriter& to, const std::vector<RobotMetrics>& robots) {
  to.counter("sweepd_sweeps_total", "Sweeps seen, by joint; joint 0: no angles tell which.");
  for (const auto& [state, result] : robots)
    for (const auto& [joint, counts] : state->sweeps) {
      const auto sweeps = [&to, &robot = state->name, number = text(joint)](const char* usable,
                                                                            std::uint64_t count) {
        to.value({{"robot", robot}, {"joint", number}, {"usable", usable}}, count);
      };
      sweeps("true", counts.usable);
      sweeps("false", counts.not_usable);
    }
  to.counter("sweepd_identifications_total", "Identifications by status, interim ones included.");
  for (const auto& [state, result] : robots)
    for (std::size_t i = 0; i < result->count.size(); ++i)
      to.value({{"robot", state->name},
                {"status", std::string(identify::text(static_cast<identify::Status>(i)))}},
               result->count[i]);
  to.gauge("sweepd_results_pending",
           "Last results of sessions that are under way or wait for a disk that takes them.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->results.pending);
  to.counter("sweepd_results_given_up_total",
             "Last results that were given up, as too many others waited for the disk.");
  for (const auto& [state, result] : robots)
    to.value({{"robot", state->name}}, state->results.given_up);
  const auto newest = [&](std::string_view name, std::string_view help, const auto& of) {
    to.gauge(name, help);
    for (const auto& [state, result] : robots)
      if (result->newest) to.value({{"robot", state->name}}, of(*result->newest));
  };
  using Newest = ResultState::Newest;
  newest("sweepd_result_timestamp_seconds", "When the newest result was there, since the epoch.",
         [](const Newest& result) { return seconds(result.at); });
  newest("sweepd_result_duration_seconds", "What the newest result took to identify.",
         [](const Newest& result) { return seconds(result.took); });
  newest("sweepd_result_interim", "1 while the session of the newest result goes on, else 0.",
         [](const Newest& result) { return result.interim ? 1 : 0; });
  to.gauge("sweepd_result_status", "1 for the status of the newest result, 0 for all others.");
  for (const auto& [state, result] : robots)
    for (std::size_t i = 0; result->newest && i < result->count.size(); ++i) {
      const auto status = static_cast<identify::Status>(i);
      to.value({{"robot", state->name}, {"status", std::string(identify::text(status))}},
               result->newest->status == status ? 1 : 0);
    }
  newest("sweepd_result_warnings", "Warnings of the newest result.",
         [](const Newest& result) { return result.warnings; });
}

}  // namespace

std::string metrics(const ServiceStatus& status, const std::vector<RobotMetrics>& robots,
                    const ProcessState& process) {
  MetricsWriter to;
  to.gauge("sweepd_build_info", "Which sweepd this is.");
  to.value({{"version", SWEEPD_VERSION}}, 1);
  to.gauge("sweepd_ready", "1 while all robots are served, else 0.");
  to.value({}, status.ready() ? 1 : 0);
  to.gauge("sweepd_robot_served",
           "1 while the robot is served; 0 while it cannot be, and is tried again.");
  for (const auto& [state, result] : robots) to.value({{"robot", state->name}}, 1);
  for (const auto& [robot, reason] : status.not_served) to.value({{"robot", robot}}, 0);
  to.gauge("process_start_time_seconds", "When this process started, since the epoch.");
  to.value({}, seconds(process.started));
  to.counter("process_cpu_seconds_total", "Processor time that this process took.");
  to.value({}, seconds(process.processor_time));
  to.gauge("process_resident_memory_bytes", "Memory of this process that is in memory.");
  to.value({}, process.resident_bytes);
  to.counter("sweepd_log_lines_lost_total",
             "Lines of the log that nobody got, as who reads it stood still or had no room.");
  to.value({}, process.log_lines_lost);
  write_stream(to, robots);
  write_link(to, robots);
  write_recording(to, robots);
  write_results(to, robots);
  return std::move(to).text_so_far();
}

}  // namespace sweepd
