#include "daemon/service/service_status.hpp"

#include <spdlog/fmt/fmt.h>

#include "rsi/counted.hpp"

namespace sweepd {
namespace {

std::string of(const RobotStatus& status) {
  const auto state = status.state.newest();
  const auto newest = status.result.newest()->newest;
  std::string text = state->name + ": " + (state->stream ? "RSI streams" : "no RSI now") + ", " +
                     rsi::counted(state->link.telegrams, "telegram");
  if (!state->last_sweep.empty()) text += ", last " + state->last_sweep;
  if (newest)
    text += std::string(", ") + (newest->interim ? "interim result " : "result ") +
            std::string(identify::text(newest->status));
  if (state->recording_paused) text += ", recording PAUSES";
  return text;
}

}  // namespace

std::string status_line(const ServiceStatus& status) {
  std::string line;
  for (const auto& standstill : status.standstills) line += "STANDS STILL: " + standstill + "; ";
  for (const auto& [robot, reason] : status.not_served)
    line += fmt::format("NOT SERVED: {}: {}; ", robot, reason);
  for (const auto& robot : status.robots) line += of(*robot) + "; ";
  if (!line.empty()) line.resize(line.size() - 2);
  return line;
}

}  // namespace sweepd
