#include "daemon/plan/krl_writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <spdlog/fmt/fmt.h>

namespace sweepd {
namespace {

constexpr int kUnknownSpeed_percent = 5;
constexpr int kAcceleration_percent = 30;

/// What may stand in a comment: one line of ASCII.
std::string krl_text(std::string_view text) {
  std::string result(text.substr(0, 80));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

}  // namespace

std::string krl_number(double value) {
  std::array<char, 400> text{};  // the longest that fixed notation can need
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value == 0 ? 0.0 : value,
                                 std::chars_format::fixed)
                       .ptr;
  std::string number(text.data(), end);
  if (number.find('.') == std::string::npos) number += ".0";
  return number;
}

std::string krl_pose(const std::vector<double>& angles_deg) {
  std::string text = "{";
  for (std::size_t i = 0; i < angles_deg.size(); ++i)
    text += fmt::format("{}A{} {}", i == 0 ? "" : ",", i + 1, krl_number(angles_deg[i]));
  return text + "}";
}

KrlWriter& KrlWriter::line(std::string_view text) {
  if (!text.empty()) text_.append(depth_ * 2, ' ').append(text);
  text_ += "\r\n";
  return *this;
}

void KrlWriter::header() {
  line("&ACCESS RVP").line("&REL 1");
  line(R"(&PARAM TEMPLATE = C:\KRC\Roboter\Template\vorgabe)").line("&PARAM EDITMASK = *");
}

void KrlWriter::begin_program(std::string_view from) {
  header();
  line("DEF " + options_.name + "( )");
  line("; Written by sweepd from " + krl_text(from) + ".");
}

void KrlWriter::begin_data() {
  header();
  line("DEFDAT " + options_.name);
  line(";FOLD EXTERNAL DECLARATIONS").line(";FOLD BASISTECH EXT");
  line("EXT BAS (BAS_COMMAND :IN,REAL :IN )");
  line(";ENDFOLD (BASISTECH EXT)").line(";ENDFOLD (EXTERNAL DECLARATIONS)");
}

void KrlWriter::declare_rsi() {
  line(options_.dialect == KrlDialect::krc2 ? "DECL RSIERR SWD_RESULT" : "DECL INT SWD_RESULT");
  if (options_.dialect == KrlDialect::krc2) line("DECL INT SWD_ETHERNET");
  if (options_.dialect == KrlDialect::krc4) line("DECL INT SWD_CONTEXT");
}

void KrlWriter::init() {
  line(";FOLD INI");
  in();
  line(";FOLD BASISTECH INI");
  in();
  // iiQKA.OS2's own programs begin without these two.
  if (options_.dialect != KrlDialect::iiqka) {
    line("GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )");
    line("INTERRUPT ON 3");
  }
  line("BAS (#INITMOV,0 )");
  out();
  line(";ENDFOLD (BASISTECH INI)");
  out();
  line(";ENDFOLD (INI)").line();
}

void KrlWriter::halt_unless(const std::string& condition, const std::string& reason) {
  line("IF " + condition + " THEN");
  in();
  line("HALT ; " + reason).line("RETURN");
  out();
  line("ENDIF");
}

void KrlWriter::call(const std::string& function, const std::string& reason) {
  line("SWD_RESULT = " + function);
  halt_unless(
      options_.dialect == KrlDialect::krc2 ? "(SWD_RESULT <> #RSIOK)" : "(SWD_RESULT <> RSIOK)",
      reason);
}

void KrlWriter::speed(std::size_t joint, double speed_deg_s) {
  const auto max = krl_max_speed(options_, joint);
  const std::string_view unit = krl_speed_unit(options_, joint);
  if (!max) {
    line(fmt::format(
        "$VEL_AXIS[{}] = {} ; CHECK: the plan asks for {} {}; what 100 % are was not known", joint,
        kUnknownSpeed_percent, krl_number(speed_deg_s), unit));
    return;
  }
  const auto percent = static_cast<int>(std::min(std::floor(speed_deg_s / *max * 100), 100.0));
  line(fmt::format("$VEL_AXIS[{0}] = {1} ; per cent of {2} {4}; the plan asks for {3} {4}", joint,
                   percent, krl_number(*max), krl_number(speed_deg_s), unit));
}

void KrlWriter::go_home(std::size_t joints, double speed_deg_s) {
  line("; No approximation anywhere: the robot stops at each target.");
  for (std::size_t joint = 1; joint <= joints; ++joint) {
    speed(joint, speed_deg_s);
    line(fmt::format("$ACC_AXIS[{}] = {}", joint, kAcceleration_percent));
  }
  line("PTP HOME_POSE");
  line("WAIT SEC 0.0 ; the advance run waits here, too").line();
}

void KrlWriter::rsi_on() {
  const std::string file = krl_rsi_file(options_);
  line("; The stream of positions. No correction is received and no object corrects: RSI cannot");
  line("; move the robot. It stops it when sweepd does not answer, unless ONLYSEND is TRUE.");
  switch (options_.dialect) {
    case KrlDialect::krc2:
      call("ST_ETHERNET(SWD_ETHERNET,0,\"" + file + "\")",
           "is the file in C:\\KRC\\ROBOTER\\INIT, and does sweepd listen?");
      call("ST_SETPARAM(SWD_ETHERNET,eERXprecision,4)", "decimals of what is sent");
      call("ST_SETPARAM(SWD_ETHERNET,eERXmaxLatePackages,100)", "late replies before it stops");
      call("ST_SETPARAM(SWD_ETHERNET,eERXFastCycle,0)", "a cycle of 12 ms");
      call("ST_ON()", "see the message window and RSIerrors.log");
      break;
    case KrlDialect::krc4:
      call("RSI_CREATE(\"" + file + "\",SWD_CONTEXT,TRUE)",
           "are context and Ethernet file in SensorInterface?");
      call("RSI_ON(#RELATIVE)", "see the message window");
      break;
    case KrlDialect::iiqka:
      call("RSI_LOAD(\"" + file + "\")", "was the context deployed?");
      call("RSI_ACTIVATE(\"" + file + "\")", "see the message window");
      call("RSI_PROCESS_ON(#ABSOLUTE)", "see the message window");
      break;
  }
  line("WAIT SEC 1.0").line();
}

void KrlWriter::rsi_off() {
  line("WAIT SEC 1.0");
  switch (options_.dialect) {
    case KrlDialect::krc2:
      call("ST_OFF()", "see the message window");
      break;
    case KrlDialect::krc4:
      call("RSI_OFF()", "see the message window");
      call("RSI_DELETE(SWD_CONTEXT)", "see the message window");
      break;
    case KrlDialect::iiqka:
      call("RSI_PROCESS_OFF()", "see the message window");
      break;
  }
}

}  // namespace sweepd
