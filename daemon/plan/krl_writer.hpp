#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/plan/krl_options.hpp"

namespace sweepd {

/// A KRL module: the texts of NAME.src and NAME.dat, ASCII with CR LF line ends.
struct KrlProgram {
  std::string src;
  std::string dat;
};

/// As few decimals as say the same number, one at least: KRL takes 90.0 for REAL.
[[nodiscard]] std::string krl_number(double value);
/// A value of the type AXIS, in degrees, of linear joints mm.
[[nodiscard]] std::string krl_pose(const std::vector<double>& angles_deg);

/// Writes the lines of a .src or a .dat, and the parts that all of sweepd's programs have. Only
/// axis targets, no approximation; nothing of it corrects the path.
class KrlWriter {
 public:
  explicit KrlWriter(const KrlOptions& options) : options_(options) {}

  KrlWriter& line(std::string_view text = {});
  void in() { ++depth_; }
  void out() { --depth_; }
  [[nodiscard]] std::string text() && { return std::move(text_); }

  void begin_program(std::string_view from);  ///< up to a remark on what it was made from
  void begin_data();
  void declare_rsi();  ///< what rsi_on() needs in the .dat
  void init();
  void halt_unless(const std::string& condition, const std::string& reason);
  /// The speed of one axis from here on, in whole per cent of what it can do.
  void speed(std::size_t joint, double speed_deg_s);
  /// Speeds and accelerations of all axes, then home. Accelerations are 30 per cent.
  void go_home(std::size_t joints, double speed_deg_s);
  void rsi_on();
  void rsi_off();

 private:
  void header();
  void call(const std::string& function, const std::string& reason);

  const KrlOptions& options_;
  std::string text_;
  std::size_t depth_ = 0;
};

}  // namespace sweepd
