#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"

namespace sweepd {

/// How RSI is switched on. krc2: the program makes the RSI objects itself (RSI 2.x). krc4: it
/// creates an RSI context (RSI 3 to 5: KR C4, KR C5 with KSS). iiqka: it loads and activates one
/// (RSI 6: KR C5 with iiQKA.OS2).
enum class KrlDialect { krc2, krc4, iiqka };

inline constexpr int kMostKrlTools = 128;

struct KrlOptions {
  KrlDialect dialect = KrlDialect::krc4;
  /// Of the program and of its files: a letter, then letters, digits and underscores, at most 24.
  std::string name = "sweepd_sweeps";
  /// Number of the controller's tool that becomes $TOOL, 1 to 128 (controllers have 16 unless they
  /// were given more). The program halts if that tool lies on the last axis.
  int tool = 1;
  /// krc2: the Ethernet file in the controller's Init folder. krc4: the RSI context as RSI_CREATE
  /// takes it, "sweepd.rsi" for RSI 3, "sweepd" for RSI 4 and 5. iiqka: the context for RSI_LOAD.
  /// Empty: sweepd_udp.xml, sweepd.rsi, sweepd.
  std::string rsi_file = {};
  /// One a joint; empty where nothing is known. KRL takes speeds in whole per cent of what an axis
  /// can do, rounded down here; where that is not known 5 % is written, with a remark that it has
  /// to be checked.
  std::vector<JointLimits> limits = {};
};

/// `rsi_file`, or what it is when left empty.
[[nodiscard]] std::string krl_rsi_file(const KrlOptions& options);

/// What joint `joint`, from 1, can do at 100 %; nothing where that is not known.
[[nodiscard]] std::optional<double> krl_max_speed(const KrlOptions& options, std::size_t joint);
/// And in which unit.
[[nodiscard]] std::string_view krl_speed_unit(const KrlOptions& options, std::size_t joint);

/// What of the options alone KRL cannot express, one sentence each, which names the option of
/// `sweepd plan`.
[[nodiscard]] std::vector<std::string> krl_findings(const KrlOptions& options);

/// What of `plan` or `options` KRL cannot express, one sentence each; empty if krl_program can
/// write it. Whether the robot can do it is check_plan's question.
[[nodiscard]] std::vector<std::string> krl_findings(const SweepPlan& plan,
                                                    const KrlOptions& options);

}  // namespace sweepd
