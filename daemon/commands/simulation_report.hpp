#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "rsi/controller/controller_link.hpp"

namespace sweepd {

/// How a simulation went, as `sweepd simulate` reports it.
struct SimulationReport {
  std::string target;  ///< where the telegrams went: "127.0.0.1:49152", or the name of a capture
  bool live = false;   ///< to a server, not to a capture: `link` is complete
  std::chrono::milliseconds cycle{};
  std::uint64_t planned = 0;  ///< telegrams that the whole plan takes
  bool only_send = false;     ///< the controller expects no replies
  bool interrupted = false;   ///< by a signal, before the plan was over
  /// Telegrams were to be swapped; the last one may have been held back without another to be
  /// swapped with, which the wire does not count.
  bool swaps = false;
  rsi::ControllerLink::Report link;  ///< of a capture: telegrams and wire only
};

/// For a person in a terminal: lined up, with units, several lines.
[[nodiscard]] std::string text(const SimulationReport& report);

/// What went wrong and what to do; empty if the plan was played to its end and every telegram had a
/// right reply in time. What was spoilt on purpose excuses a server: a lost telegram has no reply,
/// a duplicate two, and one that was held back for a swap is answered late, or not at all as a
/// newer one is there.
[[nodiscard]] std::string problem(const SimulationReport& report);

/// Whether that is a matter of time alone: the plan was played to its end, and no reply was wrong.
[[nodiscard]] bool only_late(const SimulationReport& report);

}  // namespace sweepd
