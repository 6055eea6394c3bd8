#include "daemon/plan/krl_program.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <spdlog/fmt/fmt.h>

namespace sweepd {
namespace {

constexpr double kLeastToolRadius_mm = 20;
constexpr int kUnknownSpeed_percent = 5;
constexpr int kAcceleration_percent = 30;

/// As few decimals as say the same number, one at least: KRL takes 90.0 for REAL.
std::string krl_number(double value) {
  std::array<char, 400> text{};  // the longest that fixed notation can need
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value == 0 ? 0.0 : value,
                                 std::chars_format::fixed)
                       .ptr;
  std::string number(text.data(), end);
  if (number.find('.') == std::string::npos) number += ".0";
  return number;
}

/// What may stand in a comment: one line of ASCII.
std::string krl_text(std::string_view text) {
  std::string result(text.substr(0, 80));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

/// Writes the lines of one file.
class Lines {
 public:
  Lines& operator()(std::string_view line = {}) {
    if (!line.empty()) text_.append(depth_ * 2, ' ').append(line);
    text_ += "\r\n";
    return *this;
  }
  void in() { ++depth_; }
  void out() { --depth_; }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
  std::size_t depth_ = 0;
};

void header(Lines& line) {
  line("&ACCESS RVP")("&REL 1");
  line(R"(&PARAM TEMPLATE = C:\KRC\Roboter\Template\vorgabe)")("&PARAM EDITMASK = *");
}

class ProgramWriter {
 public:
  ProgramWriter(const SweepPlan& plan, const KrlOptions& options)
      : plan_(plan), options_(options), file_(krl_rsi_file(options)) {}

  [[nodiscard]] std::string src() && {
    header(line_);
    line_("DEF " + options_.name + "( )");
    line_("; Written by sweepd from the sweep plan " + krl_text(plan_.file.filename().string()) +
          ".");
    line_("; First run: T1, override 10 %, hand on the enabling switch, sweepd listening already.");
    line_("; Look through all poses first: nothing here knows what stands in the cell.");
    line_("; Deselect or reset the program after a HALT; do not start it again from there.");
    line_();
    init();
    frames();
    go_home();
    rsi_on();
    for (std::size_t i = 0; i < plan_.sweeps.size(); ++i) sweep(i);
    rsi_off();
    line_("END");
    return std::move(line_).text();
  }

  [[nodiscard]] std::string dat() && {
    header(line_);
    line_("DEFDAT " + options_.name);
    line_(";FOLD EXTERNAL DECLARATIONS")(";FOLD BASISTECH EXT");
    line_("EXT BAS (BAS_COMMAND :IN,REAL :IN )");
    line_(";ENDFOLD (BASISTECH EXT)")(";ENDFOLD (EXTERNAL DECLARATIONS)");
    line_("; The rest at both ends of a sweep, in seconds");
    line_("DECL REAL REST_S=" + krl_number(std::chrono::duration<double>(plan_.dwell).count()));
    line_(options_.dialect == KrlDialect::krc2 ? "DECL RSIERR SWD_RESULT" : "DECL INT SWD_RESULT");
    if (options_.dialect == KrlDialect::krc2) line_("DECL INT SWD_ETHERNET");
    if (options_.dialect == KrlDialect::krc4) line_("DECL INT SWD_CONTEXT");
    const bool linear = std::any_of(plan_.sweeps.begin(), plan_.sweeps.end(),
                                    [](const PlannedSweep& sweep) { return sweep.linear; });
    line_(std::string("; Where the joints stand that do not sweep, in degrees") +
          (linear ? ", linear ones in mm" : ""));
    line_("DECL AXIS HOME_POSE=" + pose(plan_.home_deg));
    for (std::size_t i = 0; i < plan_.sweeps.size(); ++i)
      for (const PlannedMove& move : moves_of(plan_, plan_.sweeps[i])) {
        if (move.place.empty()) continue;
        auto angles = plan_.home_deg;
        angles[plan_.sweeps[i].joint - 1] = move.to_deg;
        line_("DECL AXIS " + name(i, move) + "=" + pose(angles));
      }
    line_("ENDDAT");
    return std::move(line_).text();
  }

 private:
  /// Of the place where a move ends.
  static std::string name(std::size_t sweep, const PlannedMove& move) {
    return move.place.empty() ? "HOME_POSE" : fmt::format("SWEEP{}_{}", sweep + 1, move.place);
  }

  static std::string pose(const std::vector<double>& angles_deg) {
    std::string text = "{";
    for (std::size_t i = 0; i < angles_deg.size(); ++i)
      text += fmt::format("{}A{} {}", i == 0 ? "" : ",", i + 1, krl_number(angles_deg[i]));
    return text + "}";
  }

  void init() {
    line_(";FOLD INI");
    line_.in();
    line_(";FOLD BASISTECH INI");
    line_.in();
    // iiQKA.OS2's own programs begin without these two.
    if (options_.dialect != KrlDialect::iiqka) {
      line_("GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )");
      line_("INTERRUPT ON 3");
    }
    line_("BAS (#INITMOV,0 )");
    line_.out();
    line_(";ENDFOLD (BASISTECH INI)");
    line_.out();
    line_(";ENDFOLD (INI)")();
  }

  void halt_unless(const std::string& condition, const std::string& reason) {
    line_("IF " + condition + " THEN");
    line_.in();
    line_("HALT ; " + reason)("RETURN");
    line_.out();
    line_("ENDIF");
  }

  void call(const std::string& function, const std::string& reason) {
    line_("SWD_RESULT = " + function);
    halt_unless(
        options_.dialect == KrlDialect::krc2 ? "(SWD_RESULT <> #RSIOK)" : "(SWD_RESULT <> RSIOK)",
        reason);
  }

  void frames() {
    line_("; Positions are those of the tool point in the robot's own frame.");
    line_(fmt::format("BAS (#TOOL,{} )", options_.tool));
    line_("BAS (#BASE,0 )")("$BASE = $NULLFRAME");
    const std::string least = krl_number(kLeastToolRadius_mm);
    halt_unless(
        fmt::format("(($TOOL.X*$TOOL.X+$TOOL.Y*$TOOL.Y) < {0}*{0})", least),
        fmt::format("the tool point lies on axis 6: choose a tool {} mm or more off it", least));
    line_();
  }

  /// The speed of one axis from here on.
  void speed(std::size_t joint, double speed_deg_s) {
    const auto max = krl_max_speed(options_, joint);
    if (!max) {
      line_(fmt::format(
          "$VEL_AXIS[{}] = {} ; CHECK: the plan asks for {} deg/s; what 100 % are was not known",
          joint, kUnknownSpeed_percent, krl_number(speed_deg_s)));
      return;
    }
    const auto percent = static_cast<int>(std::min(std::floor(speed_deg_s / *max * 100), 100.0));
    line_(fmt::format("$VEL_AXIS[{}] = {} ; per cent of {} deg/s; the plan asks for {} deg/s",
                      joint, percent, krl_number(*max), krl_number(speed_deg_s)));
  }

  void go_home() {
    line_("; No approximation anywhere: the robot stops at each target.");
    for (std::size_t joint = 1; joint <= plan_.home_deg.size(); ++joint) {
      speed(joint, plan_.positioning_speed_deg_s);
      line_(fmt::format("$ACC_AXIS[{}] = {}", joint, kAcceleration_percent));
    }
    line_("PTP HOME_POSE");
    line_("WAIT SEC 0.0 ; the advance run waits here, too")();
  }

  void rsi_on() {
    line_(
        "; The stream of positions. No correction is received and no object corrects: RSI cannot");
    line_("; move the robot. It stops it when sweepd does not answer, unless ONLYSEND is TRUE.");
    switch (options_.dialect) {
      case KrlDialect::krc2:
        call("ST_ETHERNET(SWD_ETHERNET,0,\"" + file_ + "\")",
             "is the file in C:\\KRC\\ROBOTER\\INIT, and does sweepd listen?");
        call("ST_SETPARAM(SWD_ETHERNET,eERXprecision,4)", "decimals of what is sent");
        call("ST_SETPARAM(SWD_ETHERNET,eERXmaxLatePackages,100)", "late replies before it stops");
        call("ST_SETPARAM(SWD_ETHERNET,eERXFastCycle,0)", "a cycle of 12 ms");
        call("ST_ON()", "see the message window and RSIerrors.log");
        break;
      case KrlDialect::krc4:
        call("RSI_CREATE(\"" + file_ + "\",SWD_CONTEXT,TRUE)",
             "are context and Ethernet file in SensorInterface?");
        call("RSI_ON(#RELATIVE)", "see the message window");
        break;
      case KrlDialect::iiqka:
        call("RSI_LOAD(\"" + file_ + "\")", "was the context deployed?");
        call("RSI_ACTIVATE(\"" + file_ + "\")", "see the message window");
        call("RSI_PROCESS_ON(#ABSOLUTE)", "see the message window");
        break;
    }
    line_("WAIT SEC 1.0")();
  }

  void sweep(std::size_t index) {
    const PlannedSweep& sweep = plan_.sweeps[index];
    line_(fmt::format(";FOLD sweep {}: A{} from {} to {}", index + 1, sweep.joint,
                      krl_number(sweep.start_deg), krl_number(sweep.end_deg)));
    line_.in();
    for (const PlannedMove& move : moves_of(plan_, sweep)) {
      speed(sweep.joint, move.speed_deg_s);
      line_("PTP " + name(index, move));
      if (!move.place.empty()) line_("WAIT SEC REST_S");
    }
    line_.out();
    line_(";ENDFOLD")();
  }

  void rsi_off() {
    line_("WAIT SEC 1.0");
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

  const SweepPlan& plan_;
  const KrlOptions& options_;
  std::string file_;
  Lines line_;
};

}  // namespace

KrlProgram krl_program(const SweepPlan& plan, const KrlOptions& options) {
  if (const auto findings = krl_findings(plan, options); !findings.empty())
    throw std::invalid_argument(findings.front());
  return {ProgramWriter(plan, options).src(), ProgramWriter(plan, options).dat()};
}

}  // namespace sweepd
