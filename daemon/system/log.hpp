#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>

namespace sweepd {

enum class Importance { note, warning, error };

/// What a line of the log is about. The journal has them as fields, for `journalctl` to filter by:
/// SWEEPD_ROBOT, SWEEPD_SESSION, SWEEPD_IPOC.
struct LogSubject {
  std::string robot;         ///< empty: the program itself
  std::string session = {};  ///< when it started, as its folder is named
  std::string ipoc = {};     ///< of the newest telegram
  bool operator==(const LogSubject&) const = default;
};

struct LogLine {
  Importance importance = Importance::note;
  LogSubject subject;
  std::string text;

  /// For a person: "robot: text".
  [[nodiscard]] std::string message() const;
};

/// `KEY=value` as systemd.journal-fields(7) has them.
[[nodiscard]] std::vector<std::string> journal_fields(const LogLine& line);

/// Says a line: to systemd's journal where standard error leads there, else to standard error, with
/// the time. Any thread but a reply thread; it waits for who reads the log unless
/// log_in_background() was called.
///
/// What was said of the same robot word for word within the last minute is held back and counted.
void log(const LogLine& line);

/// Whether standard error leads to systemd's journal.
[[nodiscard]] bool leads_to_journal();

/// Once, at the start of the program: lines are written at once.
void log_at_once();
/// Once, before there is much to say: from now on a thread of its own writes the lines, and nobody
/// waits for who reads them. Lines that find no room go, the oldest first.
void log_in_background();
/// Waits until what was said is written: true. Or for `patience`: whoever reads the log stands
/// still, and so does the thread that writes it; the process can only end without it.
bool finish_log(std::chrono::milliseconds patience = std::chrono::seconds(2));
/// Lines that nobody got since the start, as who reads the log stood still or went.
[[nodiscard]] std::uint64_t log_lines_lost();

/// Says what has been held back for a minute, and that lines were lost once they can be written
/// again. To be called now and then.
void log_repeats();
/// Says all that is held back: the program ends.
void log_all_repeats();

/// Speaks for one robot, or for the program itself. A value: a copy keeps what it was about.
class Log {
 public:
  explicit Log(std::string robot = {}) : subject_{std::move(robot)} {}

  /// The newest telegram's session and IPOC, from now on. Empty: none.
  void about(std::string_view session, std::string_view ipoc) {
    subject_.session = session;
    subject_.ipoc = ipoc;
  }
  [[nodiscard]] const LogSubject& subject() const { return subject_; }

  void say(Importance importance, std::string text) const {
    log({importance, subject_, std::move(text)});
  }
  template <typename... Args>
  void note(fmt::format_string<Args...> text, Args&&... args) const {
    say(Importance::note, fmt::format(text, std::forward<Args>(args)...));
  }
  template <typename... Args>
  void warning(fmt::format_string<Args...> text, Args&&... args) const {
    say(Importance::warning, fmt::format(text, std::forward<Args>(args)...));
  }
  template <typename... Args>
  void error(fmt::format_string<Args...> text, Args&&... args) const {
    say(Importance::error, fmt::format(text, std::forward<Args>(args)...));
  }

 private:
  LogSubject subject_;
};

}  // namespace sweepd
