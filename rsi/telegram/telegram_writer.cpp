#include "rsi/telegram/telegram_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "rsi/telegram/wire_layout.hpp"

namespace rsi {
namespace {

using Type = EthernetConfig::Element::Type;

void append_number(std::string& out, double value, int decimals) {
  // Sign, digits of the largest double, point, decimals.
  char digits[std::numeric_limits<double>::max_exponent10 + 4 + kMostPrecision];
  const char* end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr;
  const char* begin = digits;
  const auto is_zero = [](char c) { return c == '0' || c == '.'; };
  if (*begin == '-' && std::all_of(begin + 1, end, is_zero)) ++begin;
  out.append(begin, end);
}

/// Which number of the pose the field is, where the element has all of them and is no internal tag:
/// what a program feeds with the pose, as the outputs of ST_ACTPOS.
std::optional<std::size_t> pose_component(const WireElement& element,
                                          const WireElement::Field& field) {
  constexpr std::array<std::string_view, 6> kPose{"X", "Y", "Z", "A", "B", "C"};
  const bool is_pose = std::ranges::all_of(kPose, [&](auto name) {
    return std::ranges::count(element.fields, name, &WireElement::Field::attribute) == 1;
  });
  const auto found = std::ranges::find(kPose, field.attribute);
  if (!is_pose || found == kPose.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kPose.begin());
}

}  // namespace

TelegramWriter::TelegramWriter(const EthernetConfig& config, int precision) {
  if (precision < 0 || precision > kMostPrecision)
    throw std::invalid_argument("decimals of a telegram: expected 0 to " +
                                std::to_string(kMostPrecision) + ", found " +
                                std::to_string(precision));
  static constexpr struct {
    std::string_view tag;
    Signal signal;
  } kSignals[] = {
      {"DEF_RIst", &SignalValues::RIst},
      {"DEF_RSol", &SignalValues::RSol},
      {"DEF_AIPos", &SignalValues::AIPos},
      {"DEF_ASPos", &SignalValues::ASPos},
      {"DEF_EIPos", &SignalValues::EIPos},
      {"DEF_ESPos", &SignalValues::ESPos},
      {"DEF_MACur", &SignalValues::MACur},
      {"DEF_MECur", &SignalValues::MECur},
      {"DEF_Delay", nullptr},
  };

  std::string text = "<Rob Type=\"KUKA\">";
  const auto put_slot = [&](Signal signal, std::size_t component, int decimals) {
    slots_.push_back({std::exchange(text, {}), signal, component, decimals});
  };
  const auto put_value = [&](const WireElement& on_wire, const WireElement::Field& field) {
    const auto& element = config.send[field.tag];
    if (element.type == Type::STRING) return;
    const int decimals = element.type == Type::DOUBLE ? precision : 0;
    const auto* known = std::find_if(std::begin(kSignals), std::end(kSignals),
                                     [&](const auto& signal) { return signal.tag == element.tag; });
    if (known != std::end(kSignals))
      put_slot(known->signal, field.component, decimals);
    else if (const auto pose = pose_component(on_wire, field); pose && !is_internal(element.tag))
      put_slot(&SignalValues::RIst, *pose, decimals);
    else
      append_number(text, 0, decimals);
  };

  for (const auto& element : wire_layout(config.send)) {
    text += "<" + element.name;
    for (const auto& field : element.fields) {
      if (field.attribute.empty()) continue;
      text += element.name == "Tech" && field.component == 6 ? "  " : " ";
      text += field.attribute + "=\"";
      put_value(element, field);
      text += '"';
    }
    if (!element.has_text()) {
      text += "/>";
      continue;
    }
    text += '>';
    for (const auto& field : element.fields)
      if (field.attribute.empty()) put_value(element, field);
    text += "</" + element.name + ">";
  }
  tail_ = text + "<IPOC>";
}

void TelegramWriter::append(std::string& telegrams, const SignalValues& values,
                            std::uint64_t ipoc) const {
  for (const auto& [before, signal, component, decimals] : slots_) {
    telegrams += before;
    append_number(telegrams,
                  signal ? (values.*signal)[component] : static_cast<double>(values.Delay),
                  decimals);
  }
  telegrams += tail_;
  char digits[std::numeric_limits<std::uint64_t>::digits10 + 1];
  telegrams.append(digits, std::to_chars(digits, digits + sizeof digits, ipoc).ptr);
  telegrams += "</IPOC></Rob>\n";
}

}  // namespace rsi
