#include "daemon/plan/krl_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "daemon/settings/toml_table.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kMostJoints = 6;
constexpr std::size_t kLongestName = 24;
constexpr double kMostInKrl_deg = 10'000;

/// Words that cannot be the program's name: of KRL, and those that the program declares.
constexpr std::array kTaken = {
    "and",         "bas",          "b_and",      "break",  "case",      "char",    "circ",
    "continue",    "decl",         "def",        "defdat", "deffct",    "default", "do",
    "dwell_s",     "else",         "end",        "enddat", "endfct",    "endfor",  "endif",
    "endloop",     "endwhile",     "endswitch",  "enum",   "exit",      "ext",     "false",
    "for",         "global",       "goto",       "halt",   "home_pose", "if",      "import",
    "int",         "interrupt",    "is",         "lin",    "loop",      "not",     "or",
    "ptp",         "pulse",        "real",       "repeat", "rest_s",    "resume",  "return",
    "swd_context", "swd_ethernet", "swd_result", "signal", "struc",     "switch",  "then",
    "to",          "trigger",      "true",       "until",  "wait",      "when",    "while",
    "xor"};

void check_name(const std::string& name, std::vector<std::string>& findings) {
  const bool valid = !name.empty() && name.size() <= kLongestName && rsi::is_letter(name.front()) &&
                     std::all_of(name.begin(), name.end(), [](char c) {
                       return rsi::is_letter(c) || rsi::is_digit(c) || c == '_';
                     });
  if (!valid)
    findings.push_back(
        "--name: expected a letter, then letters, digits and underscores, 24 characters at most, "
        "found '" +
        rsi::in_short(name) + "': choose another name for the KRL program");
  else if (std::any_of(kTaken.begin(), kTaken.end(),
                       [&](const char* word) { return rsi::equal_ignoring_case(name, word); }))
    findings.push_back("--name: expected a name of its own, found '" + name +
                       "', which KRL or the program uses: choose another name");
}

void check_speed(const std::string& key, std::size_t joint, double speed_deg_s,
                 const KrlOptions& options, std::vector<std::string>& findings) {
  const auto max = krl_max_speed(options, joint);
  if (max && speed_deg_s < *max / 100)
    findings.push_back(fmt::format(
        "{}: expected {} {} or more, which is 1 % of what joint {} can do and the least that "
        "KRL takes, found {}: choose a higher speed",
        key, number_text(*max / 100), krl_speed_unit(options, joint), joint,
        number_text(speed_deg_s)));
}

void check_angle(const std::string& key, double angle_deg, std::vector<std::string>& findings) {
  if (!(std::abs(angle_deg) <= kMostInKrl_deg))
    findings.push_back(key + ": expected an angle from -10000 to 10000 degrees: correct it");
}

}  // namespace

std::string krl_rsi_file(const KrlOptions& options) {
  if (!options.rsi_file.empty()) return options.rsi_file;
  switch (options.dialect) {
    case KrlDialect::krc2:
      return "sweepd_udp.xml";
    case KrlDialect::krc4:
      return "sweepd.rsi";
    case KrlDialect::iiqka:
      break;
  }
  return "sweepd";
}

std::optional<double> krl_max_speed(const KrlOptions& options, std::size_t joint) {
  if (joint > options.limits.size()) return std::nullopt;
  const double speed_deg_s = options.limits[joint - 1].max_speed_deg_s;
  if (!(std::isfinite(speed_deg_s) && speed_deg_s > 0)) return std::nullopt;
  return speed_deg_s;
}

std::string_view krl_speed_unit(const KrlOptions& options, std::size_t joint) {
  return joint <= options.limits.size() && options.limits[joint - 1].linear ? "mm/s" : "deg/s";
}

std::vector<std::string> krl_findings(const KrlOptions& options) {
  std::vector<std::string> findings;
  check_name(options.name, findings);
  if (options.tool < 1 || options.tool > kMostKrlTools)
    findings.push_back(fmt::format(
        "--krl-tool: expected 1 to 128, found {}: give the number of the tool whose point "
        "is off the last axis",
        options.tool));
  const std::string file = krl_rsi_file(options);
  if (file.size() > 60 || !std::all_of(file.begin(), file.end(), [](char c) {
        return rsi::is_letter(c) || rsi::is_digit(c) || c == '_' || c == '.' || c == '-';
      }))
    findings.push_back(
        "--rsi-file: expected a file name of letters, digits, _ . and -, 60 at most, found '" +
        rsi::in_short(file) + "': rename it on the controller");
  return findings;
}

std::vector<std::string> krl_findings(const SweepPlan& plan, const KrlOptions& options) {
  std::vector<std::string> findings = krl_findings(options);
  const std::size_t joints = plan.home_deg.size();
  if (joints < 1 || joints > kMostJoints) {
    findings.push_back(
        fmt::format("home_deg: expected 1 to 6 angles, as KRL's AXIS has, found {}: this robot's "
                    "program has to be written by hand",
                    joints));
    return findings;
  }
  for (const double angle_deg : plan.home_deg) check_angle("home_deg", angle_deg, findings);
  for (std::size_t joint = 1; joint <= joints; ++joint)
    check_speed("positioning_speed_deg_s", joint, plan.positioning_speed_deg_s, options, findings);
  for (const PlannedSweep& sweep : plan.sweeps) {
    if (sweep.joint < 1 || sweep.joint > joints) {
      findings.push_back(fmt::format("sweep.joint: expected 1 to {}, found {}: correct the plan",
                                     joints, sweep.joint));
      continue;
    }
    check_angle("sweep.start_deg", sweep.start_deg, findings);
    check_angle("sweep.end_deg", sweep.end_deg, findings);
    check_speed("sweep.speed_deg_s", sweep.joint, sweep.speed_deg_s, options, findings);
  }
  return findings;
}

}  // namespace sweepd
