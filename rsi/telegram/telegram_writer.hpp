#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "rsi/telegram/ethernet_config.hpp"

namespace rsi {

/// How the RSI contexts that sweepd ships let a controller send: in each cycle of IPO_FAST, DOUBLEs
/// with so many decimals.
inline constexpr std::chrono::milliseconds kUsualCycle{4};
inline constexpr int kUsualPrecision = 4;
/// More decimals are noise of a double.
inline constexpr int kMostPrecision = 15;

/// What a controller knows about its robot in one cycle, under the names of the wire. Millimetres
/// and degrees; currents in ampere; all finite.
struct SignalValues {
  std::array<double, 6> RIst{};   ///< actual pose X Y Z A B C
  std::array<double, 6> RSol{};   ///< commanded pose
  std::array<double, 6> AIPos{};  ///< actual axis angles
  std::array<double, 6> ASPos{};
  std::array<double, 6> EIPos{};  ///< external axes
  std::array<double, 6> ESPos{};
  std::array<double, 6> MACur{};  ///< motor currents
  std::array<double, 6> MECur{};
  std::int64_t Delay = 0;  ///< late replies in a row
};

/// Writes telegrams byte for byte as they were recorded on a KR C4: elements in the order of the
/// SEND list, then IPOC, then one LF; no blank before "/>"; two blanks before the seventh
/// attribute of a technology parameter. An element of one's own with X, Y, Z, A, B and C, as Pos.X
/// that outputs of ST_ACTPOS feed, is the actual pose. Other tags that SignalValues does not have
/// are zero.
class TelegramWriter {
 public:
  /// `precision`: decimals of a DOUBLE, as at the ETHERNET object (whose default is 1). Throws
  /// std::invalid_argument if it is not 0 to kMostPrecision.
  TelegramWriter(const EthernetConfig& config, int precision);

  /// Appends to `telegrams`, and allocates nothing else.
  void append(std::string& telegrams, const SignalValues& values, std::uint64_t ipoc) const;

 private:
  using Signal = std::array<double, 6> SignalValues::*;

  /// A value that changes, and the text between the one before and it.
  struct Slot {
    std::string before;
    Signal signal = nullptr;  ///< nullptr: Delay
    std::size_t component = 0;
    int decimals = 0;
  };

  std::vector<Slot> slots_;
  std::string tail_;
};

}  // namespace rsi
