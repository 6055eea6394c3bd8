#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <optional>

#include "daemon/plan/simulated_robot.hpp"
#include "rsi/controller/simulated_controller.hpp"
#include "rsi/endpoint.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

/// What `sweepd simulate` is asked for. Exactly one of `to` and `write` is set.
struct SimulateOptions {
  std::filesystem::path robot;                 ///< see robot_description.hpp
  std::filesystem::path plan;                  ///< see sweep_plan.hpp
  std::optional<rsi::Endpoint> to;             ///< the RSI server to be tested, in real time
  std::optional<std::filesystem::path> write;  ///< a capture instead, as fast as it goes
  /// The controller's own file; absent: the one that sweepd ships, built in.
  std::optional<std::filesystem::path> ethernet_config;
  std::uint64_t seed = 1;  ///< of the wobble and of the faults
  double wobble_deg = kUsualWobble_deg;
  int precision = rsi::kUsualPrecision;                       ///< decimals
  int cycle_ms = static_cast<int>(rsi::kUsualCycle.count());  ///< 1 to 1000
  /// Unanswered in a row until the controller stops.
  std::uint64_t timeout_cycles = rsi::SimulatedController::Options().timeout;
  std::uint64_t first_ipoc = 1'525'084;          ///< IPOC starts anywhere
  double lose_percent = 0;                       ///< of the telegrams, on purpose; so the next two
  double duplicate_percent = 0;                  ///< the three together at most 100
  double swap_percent = 0;                       ///< with the next telegram
  std::optional<std::array<double, 3>> tool_mm;  ///< in place of the description's
  bool quiet = false;                            ///< no progress, no report
  bool force = false;                            ///< over any capture
  rsi::ReplyRule check = rsi::ReplyRule::controller;
};

/// Stands in for a controller whose robot runs the plan: sends its telegrams and checks each reply,
/// or writes them to a capture. The same options write the same bytes. SIGINT and SIGTERM end it in
/// order, without a capture; a second one kills as usual.
///
/// Returns the exit code: 0 if the plan was played to its end and every telegram that was not
/// spoilt on purpose had a right reply in time; 3 if only the time was wrong; else 1. `errors` says
/// what to do. The report goes to `report`.
///
/// Throws ConfigError and rsi::EthernetConfigError for files that are wrong, std::invalid_argument
/// for wrong options and as Outputs where the capture may not be written, std::runtime_error if the
/// socket or the capture cannot be opened.
[[nodiscard]] int simulate(const SimulateOptions& options, std::ostream& report = std::cout,
                           std::ostream& errors = std::cerr);

CLI::App* add_simulate(CLI::App& app, SimulateOptions& options);

}  // namespace sweepd
