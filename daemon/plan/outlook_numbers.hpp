#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "identify/dh/dh_extraction.hpp"

namespace sweepd {

// Numbers of a DH table and the uncertainties to be expected of them, in columns for people.

inline constexpr std::size_t kJointColumn = 18;
inline constexpr std::size_t kValueColumn = 14;
inline constexpr std::size_t kSigmaColumn = 13;

struct OutlookNumber {
  const char* name;
  identify::DhNumber identify::DhEstimate::*number;
  bool angle;
  double identify::DhRow::*specified;
};
/// b, theta, a, alpha, beta.
extern const std::array<OutlookNumber, 5> kOutlookNumbers;

[[nodiscard]] bool shown(const OutlookNumber& number, const identify::DhEstimate& row);
/// In mm or degrees; half a turn back is half a turn forth.
[[nodiscard]] double specified_value(const identify::DhRow& row, const OutlookNumber& one);
/// As short as it can be, without an exponent.
[[nodiscard]] std::string plain(double value);

/// Decimals with which the smallest of some uncertainties, mm and degrees alike, shows two digits.
class OutlookDecimals {
 public:
  void see(double value);
  void see(const std::vector<identify::DhEstimate>& table);
  [[nodiscard]] int count() const;

 private:
  int needed_ = 4;
};

/// A number's standard uncertainty times `factor`, or why it has none.
[[nodiscard]] std::string sigma_text(const identify::DhNumber& found, const OutlookNumber& one,
                                     int decimals, std::size_t width, double factor = 1);
/// The joint, once, and the number's name.
[[nodiscard]] std::string line_start(std::size_t row, const OutlookNumber& number);

}  // namespace sweepd
