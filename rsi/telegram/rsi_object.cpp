#include "rsi/telegram/rsi_object.hpp"

#include <algorithm>
#include <iterator>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

struct Known {
  std::string_view type;
  std::string_view type_id;
  RsiEffect effect;
};

constexpr Known kActing[] = {
    {"POSCORR", "27", RsiEffect::moves},
    {"AXISCORR", "33", RsiEffect::moves},
    {"AXISCORREXT", "33", RsiEffect::moves},
    {"MAP2OV_PRO", "25", RsiEffect::sets_speed},
    {"MAP2DIGOUT", "14", RsiEffect::sets_output},
    {"SETDIGOUT", "12", RsiEffect::sets_output},
    {"RESETDIGOUT", "13", RsiEffect::sets_output},
    {"MAP2ANOUT", "15", RsiEffect::sets_output},
    {"MAP2SEN_PREA", "17", RsiEffect::tells_program},
    {"MAP2SEN_PINT", "16", RsiEffect::tells_program},
};

/// STOP can only stop; the two ...MON limit what others correct.
constexpr std::string_view kHarmless[] = {
    "ETHERNET", "MONITOR", "STOP", "POSCORRMON", "AXISCORRMON",
    // What is read from the robot.
    "POSACT", "AXISACT", "AXISACTEXT", "MOTORCURRENT", "MOTORCURRENTEXT", "GEARTORQUE",
    "GEARTORQUEEXT", "STATUS", "OV_PRO", "DIGIN", "DIGOUT", "ANIN", "ANOUT", "SEN_PREA", "SEN_PINT",
    // Signals.
    "SOURCE", "SUM", "MULTI", "ABS", "POW", "EXP", "LOG", "NORM", "ROUND", "CEIL", "FLOOR", "SIN",
    "COS", "TAN", "ASIN", "ACOS", "ATAN", "ATAN2", "P", "I", "D", "PD", "PID", "PT1", "PT2",
    "IIRFILTER", "GENCTRL", "AND", "OR", "XOR", "NOT", "GREATER", "LESS", "EQUAL", "BAND", "BOR",
    "BCOMPL", "TIMER", "DELAY", "SIGNALSWITCH", "LIMIT", "MINMAX", "TRAFO_USERFRAME",
    "TRAFO_ROBFRAME"};

RsiEffect effect_of_type(std::string_view type) {
  for (const Known& known : kActing)
    if (equal_ignoring_case(known.type, type)) return known.effect;
  const bool harmless =
      std::any_of(std::begin(kHarmless), std::end(kHarmless),
                  [&](std::string_view each) { return equal_ignoring_case(each, type); });
  return harmless ? RsiEffect::none : RsiEffect::unknown;
}

}  // namespace

RsiEffect rsi_effect(std::string_view type, std::string_view type_id) {
  RsiEffect effect = effect_of_type(type);
  for (const Known& known : kActing)
    if (known.type_id == type_id) effect = std::max(effect, known.effect);
  return effect;
}

bool is_ethernet(std::string_view type, std::string_view type_id) {
  return equal_ignoring_case(type, "ETHERNET") || (type.empty() && type_id == "64");
}

std::string_view text(RsiEffect effect) noexcept {
  switch (effect) {
    case RsiEffect::none:
      return "moves nothing";
    case RsiEffect::tells_program:
      return "writes a variable that the robot's program may act on";
    case RsiEffect::unknown:
      return "is an object that sweepd does not know, so it may move the robot or set an output";
    case RsiEffect::sets_output:
      return "sets an output";
    case RsiEffect::sets_speed:
      return "sets the speed of the robot's program ($OV_PRO)";
    case RsiEffect::moves:
      break;
  }
  return "can move the robot";
}

}  // namespace rsi
