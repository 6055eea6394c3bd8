#include "rsi/telegram/telegram_writer.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "rsi/telegram/wire_layout.hpp"

namespace rsi {
namespace {

using Type = EthernetConfig::Element::Type;

constexpr int kMostDecimals = 15;

void append_number(std::string& out, double value, int decimals) {
  // Sign, digits of the largest double, point, decimals.
  char digits[std::numeric_limits<double>::max_exponent10 + 4 + kMostDecimals];
  const char* end =
      std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, decimals).ptr;
  const char* begin = digits;
  const auto is_zero = [](char c) { return c == '0' || c == '.'; };
  if (*begin == '-' && std::all_of(begin + 1, end, is_zero)) ++begin;
  out.append(begin, end);
}

}  // namespace

TelegramWriter::TelegramWriter(const EthernetConfig& config, int precision) {
  if (precision < 0 || precision > kMostDecimals)
    throw std::invalid_argument("decimals of a telegram: expected 0 to 15, found " +
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
  const auto put_value = [&](const WireElement::Field& field) {
    const auto& element = config.send[field.tag];
    if (element.type == Type::STRING) return;
    const int decimals = element.type == Type::DOUBLE ? precision : 0;
    const auto* known = std::find_if(std::begin(kSignals), std::end(kSignals),
                                     [&](const auto& signal) { return signal.tag == element.tag; });
    if (known == std::end(kSignals)) {
      append_number(text, 0, decimals);
    } else {
      slots_.push_back({text, known->signal, field.component, decimals});
      text.clear();
    }
  };

  for (const auto& element : wire_layout(config.send)) {
    text += "<" + element.name;
    for (const auto& field : element.fields) {
      if (field.attribute.empty()) continue;
      text += element.name == "Tech" && field.component == 6 ? "  " : " ";
      text += field.attribute + "=\"";
      put_value(field);
      text += '"';
    }
    if (!element.has_text()) {
      text += "/>";
      continue;
    }
    text += '>';
    for (const auto& field : element.fields)
      if (field.attribute.empty()) put_value(field);
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
