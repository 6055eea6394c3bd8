#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/settings/robot_description.hpp"

namespace sweepd::test {

/// What a program does, in its order.
struct KrlEvent {
  enum class Kind { move, wait, call };

  Kind kind = Kind::move;
  int line = 0;
  std::array<std::optional<double>, 6> axes_deg{};  ///< of a move; all absent: to where it stands
  double seconds = 0;                               ///< of a wait
  std::string function;                             ///< of a call, in capitals
  std::string text;                                 ///< of a call: what stands in the parentheses
  std::map<int, int> speed_percent{};               ///< $VEL_AXIS as it is by then
};

struct KrlReport {
  std::vector<std::string> mistakes;  ///< "src:12: text", in order
  std::string name;                   ///< of the program
  std::vector<KrlEvent> events;       ///< without what stands in IF branches: handling of errors
};

/// Reads a KRL module as far as these programs go, and finds what a controller's compiler would:
/// blocks and folds that do not close, names that nobody declared, declarations after the first
/// statement or without a use, a data list of another name, PTP targets without axes or beyond
/// `limits`, approximation, text that is not ASCII with CR LF. Without a data list `dat` is empty.
KrlReport check_krl(std::string_view src, std::string_view dat,
                    const std::vector<JointLimits>& limits = {});

}  // namespace sweepd::test
