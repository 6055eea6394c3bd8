#include "daemon/stream/sample_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/text/units.hpp"
#include "rsi/ascii.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace sweepd {
namespace {

/// "AIPos.A1" is an attribute, "DiL" the text of an element.
rsi::SignalPlace place_of(const std::string& name) {
  const auto dot = name.find('.');
  if (dot == std::string::npos) return rsi::SignalPlace(name);
  return rsi::SignalPlace(name.substr(0, dot), name.substr(dot + 1));
}

}  // namespace

SampleReader::SampleReader(const SignalNames& names, std::size_t joints, bool with_currents)
    : with_currents_(with_currents) {
  for (const auto& name : names.position) pose_.push_back({place_of(name)});
  for (const auto& name : names.orientation) pose_.push_back({place_of(name)});
  for (std::size_t j = 0; j < std::min(joints, names.angles.size()); ++j)
    angles_.push_back({place_of(names.angles[j])});
  for (std::size_t j = 0; j < std::min(joints, kMostCurrents); ++j)
    currents_.push_back({rsi::SignalPlace("MACur", "A" + std::to_string(j + 1))});
  // The seventh joint of an arm may come as an external axis.
  for (const char* axis : {"E1", "E2", "E3", "E4", "E5", "E6"})
    if (std::find(names.angles.begin(), names.angles.end(), std::string("EIPos.") + axis) ==
        names.angles.end())
      external_.push_back({rsi::SignalPlace("EIPos", axis)});
}

std::optional<double> SampleReader::value(const rsi::Telegram& telegram, Source& source,
                                          int& decimals) {
  const rsi::Signal* const signal = source.place.in(telegram);
  source.text = {};
  if (signal == nullptr) return std::nullopt;
  const auto number = rsi::decimal(signal->text);
  if (!number || std::abs(number->value) > kLargestMeasured) {
    ++unusable_;
    return std::nullopt;
  }
  source.text = rsi::trimmed(signal->text);
  decimals = std::max(decimals, number->decimals);
  return number->value;
}

identify::Sample SampleReader::read(const rsi::Telegram& telegram) {
  identify::Sample sample;
  int position_decimals = position_decimals_;
  int angle_decimals = angle_decimals_;
  std::array<std::optional<double>, 6> pose;
  for (std::size_t k = 0; k < 6; ++k)
    pose[k] = value(telegram, pose_[k], k < 3 ? position_decimals : angle_decimals);
  if (pose[0] && pose[1] && pose[2]) {
    sample.position_mm = {*pose[0], *pose[1], *pose[2]};
    sample.has_position = true;
  }
  if (pose[3] && pose[4] && pose[5]) {
    for (std::size_t k = 0; k < 3; ++k) sample.abc_rad[k] = radians(*pose[k + 3]);
    sample.has_orientation = true;
  }
  std::size_t found = 0;
  for (std::size_t j = 0; j < angles_.size(); ++j) {
    const auto angle = value(telegram, angles_[j], angle_decimals);
    if (!angle) continue;
    sample.angles_rad[j] = radians(*angle);
    ++found;
  }
  if (found == angles_.size()) sample.joints = static_cast<std::uint8_t>(found);
  follow_external_axes(telegram);
  read_currents(telegram);
  sample.external_place = external_place_;

  if (position_decimals != position_decimals_ || angle_decimals != angle_decimals_) {
    position_decimals_ = position_decimals;
    angle_decimals_ = angle_decimals;
    if (position_decimals_ >= 0) resolution_.position_mm = std::pow(10.0, -position_decimals_);
    if (angle_decimals_ >= 0) resolution_.angle_rad = radians(std::pow(10.0, -angle_decimals_));
  }
  return sample;
}

void SampleReader::follow_external_axes(const rsi::Telegram& telegram) {
  // In mm, or degrees where the axis turns. One that is locked shows two steps of what a controller
  // prints at most, 0.1 by default.
  constexpr double kMoved = 0.25;
  for (auto& [place, known] : external_) {
    const rsi::Signal* const signal = place.in(telegram);
    if (signal == nullptr) return;  // all six are sent, or none
    const auto value = rsi::number(signal->text);
    if (!value || (known && std::abs(*value - *known) <= kMoved)) continue;
    if (known) ++external_place_;
    known = value;
  }
}

void SampleReader::read_currents(const rsi::Telegram& telegram) {
  read_currents_.reset();
  for (std::size_t j = 0; j < currents_.size(); ++j) {
    int decimals = 0;
    const auto current = value(telegram, currents_[j], decimals);
    if (j == 0 && currents_[j].text.empty() && !current) break;  // all are sent, or none
    if (!read_currents_) {
      read_currents_.emplace();
      read_currents_->fill(kNoCurrent);
    }
    if (current) (*read_currents_)[j] = *current;
  }
}

void SampleReader::append_csv(std::string& row) const {
  const auto append = [&](const Source& source) {
    row += ',';
    row += source.text;
  };
  for (const auto& source : pose_) append(source);
  for (const auto& source : angles_) append(source);
  if (with_currents_)
    for (const auto& source : currents_) append(source);
}

std::string SampleReader::csv_header() const {
  std::string header = ",x_mm,y_mm,z_mm,a_deg,b_deg,c_deg";
  for (std::size_t j = 0; j < angles_.size(); ++j) header += ",a" + std::to_string(j + 1) + "_deg";
  if (with_currents_)
    for (std::size_t j = 0; j < currents_.size(); ++j)
      header += ",a" + std::to_string(j + 1) + "_current_a";
  return header;
}

}  // namespace sweepd
