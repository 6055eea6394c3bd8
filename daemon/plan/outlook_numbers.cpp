#include "daemon/plan/outlook_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

using identify::DhEstimate;
using identify::DhNumber;
using identify::Knowledge;

double scale(const OutlookNumber& number) {
  return number.angle ? degrees(1) : 1;
}

}  // namespace

const std::array<OutlookNumber, 5> kOutlookNumbers{{
    {"b      mm", &DhEstimate::b_mm, false, &identify::DhRow::b_mm},
    {"theta  deg", &DhEstimate::theta_rad, true, &identify::DhRow::theta_rad},
    {"a      mm", &DhEstimate::a_mm, false, &identify::DhRow::a_mm},
    {"alpha  deg", &DhEstimate::alpha_rad, true, &identify::DhRow::alpha_rad},
    {"beta   deg", &DhEstimate::beta_rad, true, &identify::DhRow::beta_rad},
}};

bool shown(const OutlookNumber& number, const DhEstimate& row) {
  return number.number != &DhEstimate::beta_rad || has_beta(row);
}

double specified_value(const identify::DhRow& row, const OutlookNumber& one) {
  const double value = scale(one) * row.*one.specified;
  return one.angle && value < -179.9999 ? value + 360 : value;
}

std::string plain(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), end.ptr};
}

void OutlookDecimals::see(double value) {
  if (value > 0) needed_ = std::max(needed_, 1 - static_cast<int>(std::floor(std::log10(value))));
}

void OutlookDecimals::see(const std::vector<DhEstimate>& table) {
  for (const DhEstimate& row : table)
    for (const OutlookNumber& one : kOutlookNumbers)
      if (shown(one, row)) see(scale(one) * (row.*one.number).sigma);
}

int OutlookDecimals::count() const {
  return std::min(needed_, 10);
}

std::string sigma_text(const DhNumber& found, const OutlookNumber& one, int decimals,
                       std::size_t width, double factor) {
  switch (found.knowledge) {
    case Knowledge::identified:
      return number(factor * scale(one) * found.sigma, decimals, width);
    case Knowledge::by_convention:
      return right("(set)", width);
    case Knowledge::undetermined:
      break;
  }
  return right("-", width);
}

std::string line_start(std::size_t row, const OutlookNumber& number) {
  return right(number.number == &DhEstimate::b_mm ? std::to_string(row + 1) : "", 5) + "   " +
         left(number.name, kJointColumn - 8);
}

}  // namespace sweepd
