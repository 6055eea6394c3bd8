#include "daemon/stream/session.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include <spdlog/fmt/ranges.h>

#include "identify/sweeps/sweep.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {
namespace {

/// Motor currents are an element of their own.
bool has_currents(std::string_view telegram) {
  return telegram.find("<MACur") != std::string_view::npos;
}

/// What may be the angle of a joint that `signals` do not name.
std::string suggested(const SignalNames& names, const rsi::Telegram& telegram) {
  constexpr const char* kUsual = "EIPos.E1";
  const bool is_there = place_of(kUsual).in(telegram) != nullptr &&
                        std::ranges::find(names.angles, kUsual) == names.angles.end();
  return is_there ? fmt::format("; the telegrams have {}, which may be the next one", kUsual) : "";
}

}  // namespace

std::string missing_signals(const SignalNames& names, std::size_t joints,
                            std::string_view telegram) {
  rsi::Telegram parsed;
  if (parsed.parse(telegram) != rsi::Defect::none) return {};
  std::vector<std::string> missing, unreadable;
  std::string_view example;
  const auto look = [&](std::span<const std::string> wanted, std::span<const std::string> usual) {
    std::vector<std::string> absent;
    for (const auto& name : wanted) {
      const rsi::Signal* const signal = place_of(name).in(parsed);
      rsi::Decimal number;
      if (signal == nullptr) {
        absent.push_back(name);
      } else if (!rsi::read(signal->text, number)) {
        if (unreadable.empty()) example = signal->text;
        unreadable.push_back(name);
      }
    }
    if (absent.size() < wanted.size() ||
        !std::ranges::equal(wanted, usual.first(std::min(wanted.size(), usual.size()))))
      missing.insert(missing.end(), absent.begin(), absent.end());
  };
  const SignalNames usual;
  look(names.position, usual.position);
  look(names.orientation, usual.orientation);
  look(std::span(names.angles).first(std::min(joints, names.angles.size())), usual.angles);
  std::string text;
  if (!unreadable.empty())
    text = fmt::format("the first telegram's {} cannot be read as numbers, as \"{}\": {}",
                       fmt::join(unreadable, ", "), rsi::in_short(example),
                       example.find(',') != std::string_view::npos
                           ? "numbers have a decimal point, no comma: correct what sends them"
                           : "see what sends them");
  const auto add = [&text](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
  if (!missing.empty())
    add(fmt::format(
        "the telegrams have no {}: correct `signals` in the settings, or SEND in the Ethernet file",
        fmt::join(missing, ", ")));
  const bool has_angles = std::ranges::any_of(
      names.angles, [&](const auto& name) { return place_of(name).in(parsed) != nullptr; });
  if (joints > names.angles.size() && has_angles)
    add(fmt::format(
        "the robot has {} joints, and `signals` names angles of {}: name all with `angles` of "
        "[robot.signals], or the others are not seen{}",
        joints, names.angles.size(), suggested(names, parsed)));
  return rsi::printable(text);
}

std::string advice_on_positions(const SignalNames& names, std::string_view telegram) {
  SignalNames positions;
  positions.position = names.position;
  const std::string named_wrongly = missing_signals(positions, 0, telegram);
  return named_wrongly.empty()
             ? "on a KUKA controller, add DEF_RIst to the SEND list of the Ethernet file"
             : named_wrongly;
}

namespace {

/// What one in a hundred telegrams lacks, and others have.
std::string lost_signals(const SampleReader::Incomplete& of) {
  std::string text;
  const auto add = [&](std::uint64_t without, const char* what) {
    if (without == of.samples || 100 * without <= of.samples) return;
    text += (text.empty() ? "" : "; ") +
            fmt::format("{} of {} have no {} that can be read, and the others have", without,
                        rsi::counted(of.samples, "telegram"), what);
  };
  add(of.without_position, "position");
  add(of.without_angles, "angles of all joints");
  if (!text.empty()) text += ": see what changes what is sent while the stream goes on";
  return text;
}

}  // namespace

Session::Session(const RobotSetup& setup, std::string source_kind, StreamSink& sink,
                 std::string_view first)
    : setup_(setup),
      source_kind_(std::move(source_kind)),
      sink_(sink),
      missing_signals_(sweepd::missing_signals(setup.signals, setup.joints, first)),
      without_positions_(advice_on_positions(setup.signals, first)),
      pipeline_(setup.joints, setup.signals, *this, has_currents(first)) {}

Snapshot Session::snapshot() const {
  auto known = campaign(setup_, pipeline_.resolution());
  known.motion_limit = pipeline_.motion_limit();
  return {setup_.name,
          source_kind_,
          pipeline_.counts(),
          std::move(known),
          kept_.sweeps(),
          kept_.left_out(),
          setup_.limits(),
          {},
          currents_.joints(),
          missing_signals_.empty() ? lost_signals(pipeline_.incomplete()) : missing_signals_,
          without_positions_};
}

bool Session::worth_identifying() const {
  return swept_joints_.size() >= setup_.joints || without_joint_ >= setup_.joints;
}

void Session::sweep(const identify::Sweep& sweep) {
  sink_.sweep(sweep);
  kept_.keep(sweep);
  if (sweep.defect == identify::SweepDefect::none) {
    if (sweep.joint)
      swept_joints_.insert(*sweep.joint);
    else
      ++without_joint_;
  }
}

std::optional<std::size_t> PlannedTurns::joint_of(const identify::Sweep& stroke) {
  if (order_.empty() || stroke.defect != identify::SweepDefect::none) return std::nullopt;
  if (last_ && identify::turns_in({*last_, stroke}, {0, 1}, 2).size() > 1) ++turn_;
  last_ = stroke;
  return order_[turn_ % order_.size()].joint;
}

}  // namespace sweepd
