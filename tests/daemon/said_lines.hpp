#pragma once

#include <memory>
#include <sstream>
#include <string>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "daemon/system/log.hpp"

namespace sweepd::test {

/// Keeps what is said to the log while this lives.
class SaidLines {
 public:
  SaidLines() {
    log_all_repeats();  // what tests before have said is no repeat
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "said", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines_)));
  }
  ~SaidLines() { spdlog::set_default_logger(before_); }
  SaidLines(const SaidLines&) = delete;
  SaidLines& operator=(const SaidLines&) = delete;

  /// Once nobody says any more.
  [[nodiscard]] std::string text() const { return lines_.str(); }

 private:
  std::ostringstream lines_;
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

}  // namespace sweepd::test
