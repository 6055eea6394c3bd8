#include "rsi/telegram/rsi_object.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

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

namespace {

std::string folded(std::string_view id) {
  std::string text(id);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace

bool SignalFlow::add(std::string_view id, bool from_outside) {
  const bool is_new = by_id_.try_emplace(std::string(id), nodes_.size()).second;
  by_id_in_any_case_.try_emplace(folded(id), nodes_.size());
  nodes_.push_back(
      {.name = id.empty() ? "(no name)" : printable(id), .from_outside = from_outside});
  return is_new;
}

std::size_t SignalFlow::of(std::string_view id) const {
  if (const auto same = by_id_.find(std::string(id)); same != by_id_.end()) return same->second;
  const auto similar = by_id_in_any_case_.find(folded(id));
  return similar == by_id_in_any_case_.end() ? none : similar->second;
}

void SignalFlow::link(std::size_t from, std::size_t to) {
  nodes_[from].feeds.push_back(to);
  nodes_[to].fed = true;
}

void SignalFlow::trace() {
  const auto all_that = [this](auto holds) {
    std::vector<std::size_t> front;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (!nodes_[i].reached && holds(nodes_[i])) front.push_back(i);
    return front;
  };
  spread(all_that([](const Node& node) { return node.from_outside; }));
  spread(all_that([](const Node& node) { return !node.fed; }));
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (!nodes_[i].reached) spread({i});
}

void SignalFlow::spread(std::vector<std::size_t> front) {
  for (const auto start : front) nodes_[start].reached = true;
  while (!front.empty()) {
    std::vector<std::size_t> next;
    for (const auto from : front)
      for (const auto to : nodes_[from].feeds) {
        if (nodes_[to].reached) continue;
        nodes_[to].reached = true;
        nodes_[to].before = from;
        next.push_back(to);
      }
    front = std::move(next);
  }
}

std::string SignalFlow::path(std::size_t object) const {
  constexpr std::size_t kMost = 8;
  std::vector<std::size_t> back;  // the way, from its end
  for (auto at = object; at != none; at = nodes_[at].before) back.push_back(at);
  std::string text;
  for (std::size_t left = back.size(); left > 0; --left) {
    if (left + 1 == back.size() && left > kMost - 1) {
      text += " -> ...";
      left = kMost - 1;
    }
    text += (text.empty() ? "" : " -> ") + nodes_[back[left - 1]].name;
  }
  return text;
}

}  // namespace rsi
