#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "rsi/endpoint.hpp"

namespace sweepd {

/// What a running sweepd tells of its robots.
struct DaemonState {
  std::string trouble;  ///< a sentence, where it tells nothing; else empty
  /// By the robots' names: /api/state with this robot alone, and `at`, when it was asked.
  std::map<std::string, nlohmann::ordered_json> robots;
};

/// From the body of /api/state, asked at a time in UTC.
[[nodiscard]] DaemonState parse_daemon_state(const std::string& body, const std::string& at);

/// From all that came as the answer of `where`, whoever it was that answered.
[[nodiscard]] DaemonState parse_daemon_answer(const std::string& answer, const std::string& where,
                                              const std::string& at);

/// Asks http://PAGES/api/state. Waits for a second at most. Never throws.
[[nodiscard]] DaemonState ask_daemon(const rsi::Endpoint& pages);

}  // namespace sweepd
