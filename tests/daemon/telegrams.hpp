#pragma once

// Telegrams, put together here and not by the code under test, and captures that hold them.

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/text/numbers.hpp"
#include "rsi/capture/capture_writer.hpp"
#include "rsi/datagram.hpp"
#include "tests/rsi/addresses.hpp"

namespace sweepd::test {

using rsi::test::kController;
using rsi::test::kServer;

inline std::string telegram(std::uint64_t ipoc, std::string_view elements) {
  return "<Rob Type=\"KUKA\">" + std::string(elements) + "<IPOC>" + std::to_string(ipoc) +
         "</IPOC></Rob>\n";
}

/// <RIst> of a point, and <AIPos> of six angles.
inline std::string pose(const std::array<double, 3>& xyz, const std::array<double, 6>& angles,
                        int decimals = 4) {
  std::string text = "<RIst";
  for (std::size_t k = 0; k < 3; ++k)
    text += std::string(" ") + "XYZ"[k] + "=\"" + fixed(xyz[k], decimals) + '"';
  text += " A=\"0.0\" B=\"90.0\" C=\"0.0\"/><AIPos";
  for (std::size_t k = 0; k < 6; ++k)
    text += " A" + std::to_string(k + 1) + "=\"" + fixed(angles[k], decimals) + '"';
  return text + "/>";
}

/// Joint 1 stands at `angle_deg`, the target 500 mm off its axis, and the rest at home.
inline std::string joint_1_at(double angle_deg, int decimals = 4) {
  const double angle = -angle_deg * 3.14159265358979323846 / 180;
  return pose({500 * std::cos(angle), 500 * std::sin(angle), 900}, {angle_deg, -90, 90, 0, 90, 0},
              decimals);
}

/// Where joint 1 is in each cycle of 4 ms: at rest, from `from_deg` to `to_deg` in a soft move, at
/// rest.
inline std::vector<double> stroke_deg(double from_deg, double to_deg) {
  constexpr int kRest = 75;   // 0.3 s
  constexpr int kMove = 250;  // 1 s
  std::vector<double> angles(kRest, from_deg);
  for (int k = 1; k <= kMove; ++k)
    angles.push_back(from_deg + (to_deg - from_deg) *
                                    (0.5 - 0.5 * std::cos(3.14159265358979323846 * k / kMove)));
  angles.insert(angles.end(), kRest, to_deg);
  return angles;
}

inline rsi::Datagram from_controller(std::string_view payload, rsi::Timestamp time = {}) {
  return {time, kController, kServer, payload, false};
}

/// A capture of what a controller sends every 4 ms, from the year 2025 on.
class Capture {
 public:
  explicit Capture(const std::filesystem::path& file) : writer_(file) {}

  Capture& add(std::string_view payload, const rsi::Endpoint& from = kController,
               const rsi::Endpoint& to = kServer) {
    if (!writer_.write({time_, from, to, payload, false}))
      throw std::runtime_error(writer_.error());
    time_ += std::chrono::milliseconds(4);
    return *this;
  }
  /// Joint 1 moves; IPOC goes on from `ipoc`, which is left at the next one.
  Capture& add_stroke(std::uint64_t& ipoc, double from_deg, double to_deg) {
    for (const double angle : stroke_deg(from_deg, to_deg)) {
      add(telegram(ipoc, joint_1_at(angle)));
      ipoc += 4;
    }
    return *this;
  }

 private:
  rsi::CaptureWriter writer_;
  rsi::Timestamp time_ = std::chrono::seconds(1'735'689'600);
};

}  // namespace sweepd::test
