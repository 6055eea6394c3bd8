#include "daemon/stream/sample_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/text/units.hpp"
#include "rsi/ascii.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/words.hpp"

namespace sweepd {

rsi::SignalPlace place_of(const std::string& name) {
  const auto dot = name.find('.');
  if (dot == std::string::npos) return rsi::SignalPlace(name);
  return rsi::SignalPlace(name.substr(0, dot), name.substr(dot + 1));
}

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

/// Sets the values of those that are there and numbers that can be measured; returns how many.
std::size_t SampleReader::take(const rsi::Telegram& telegram, std::span<Source> sources,
                               int& decimals, double* values) {
  std::size_t found = 0;
  for (Source& source : sources) {
    double& value = *values++;
    source.text = {};
    const rsi::Signal* const signal = source.place.in(telegram);
    if (signal == nullptr) continue;
    rsi::Decimal number;
    std::string_view text = signal->text;
    bool usable = rsi::read_short(text, number);  // these have no blanks
    if (!usable) {
      usable = rsi::read(text, number);
      text = rsi::trimmed(text);
    }
    if (!usable || std::abs(number.value) > kLargestMeasured) {
      ++unusable_;
      continue;
    }
    source.text = text;
    decimals = std::max(decimals, number.decimals);
    value = number.value;
    ++found;
  }
  return found;
}

identify::Sample SampleReader::read(const rsi::Telegram& telegram) {
  identify::Sample sample;
  int position_decimals = position_decimals_;
  int angle_decimals = angle_decimals_;
  const std::span pose(pose_);
  sample.has_position =
      take(telegram, pose.first(3), position_decimals, sample.position_mm.data()) == 3;
  if (!sample.has_position) sample.position_mm.setZero();
  sample.has_orientation = take(telegram, pose.last(3), angle_decimals, sample.abc_rad.data()) == 3;
  for (double& angle : sample.abc_rad) angle = sample.has_orientation ? radians(angle) : 0;
  const std::size_t found = take(telegram, angles_, angle_decimals, sample.angles_rad.data());
  for (double& angle : sample.angles_rad) angle = radians(angle);
  if (found == angles_.size()) sample.joints = static_cast<std::uint8_t>(found);
  ++incomplete_.samples;
  if (!sample.has_position) ++incomplete_.without_position;
  if (found < angles_.size()) ++incomplete_.without_angles;
  follow_external_axes(telegram);
  Currents currents;
  currents.fill(kNoCurrent);
  int ignored = 0;
  read_currents_.reset();
  if (take(telegram, currents_, ignored, currents.data()) > 0) read_currents_ = currents;
  if (!external_places_.empty()) sample.external_place = external_places_.front().number;

  if (position_decimals != position_decimals_ || angle_decimals != angle_decimals_) {
    position_decimals_ = position_decimals;
    angle_decimals_ = angle_decimals;
    if (position_decimals_ >= 0) resolution_.position_mm = std::pow(10.0, -position_decimals_);
    if (angle_decimals_ >= 0) resolution_.angle_rad = radians(std::pow(10.0, -angle_decimals_));
  }
  return sample;
}

SampleReader::ExternalReading SampleReader::usual_external_reading() const {
  const auto count = static_cast<std::ptrdiff_t>(std::min(external_read_, kExternalReadings));
  ExternalReading usual{};
  for (std::size_t k = 0; k < external_.size(); ++k) {
    std::array<double, kExternalReadings> values{};
    std::transform(external_readings_.begin(), external_readings_.begin() + count, values.begin(),
                   [k](const ExternalReading& one) { return one[k]; });
    std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
    usual[k] = values[static_cast<std::size_t>(count / 2)];
  }
  return usual;
}

void SampleReader::follow_external_axes(const rsi::Telegram& telegram) {
  if (external_.empty()) return;
  ExternalReading reading{};
  bool sent = false;  // those that are missing stand at 0 for all that is known
  for (std::size_t k = 0; k < external_.size(); ++k) {
    const rsi::Signal* const signal = external_[k].in(telegram);
    if (signal == nullptr) continue;
    const auto value = rsi::number(signal->text);
    if (!value) return;
    reading[k] = *value;
    sent = true;
  }
  if (!sent) return;
  external_readings_[external_read_++ % kExternalReadings] = reading;
  // Where all of the last readings are at one place, so is what is usual of them.
  const bool there = !external_places_.empty() && at_place(reading, external_places_.front().at);
  external_there_ = there ? external_there_ + 1 : 0;
  if (external_there_ >= kExternalReadings && external_places_.front().samples >= kSettling)
    ++external_places_.front().samples;
  else
    find_external_place(usual_external_reading());
}

bool SampleReader::at_place(const ExternalReading& now, const ExternalReading& place) {
  // In mm, or degrees where the axis turns. One that is locked shows two steps of what a controller
  // prints at most, 0.1 by default.
  constexpr double kMoved = 0.25;
  return std::equal(now.begin(), now.end(), place.begin(),
                    [](double a, double b) { return std::abs(a - b) <= kMoved; });
}

/// The readings of one telegram may be off, and readings shake: neither moves the axes.
void SampleReader::find_external_place(const ExternalReading& now) {
  /// On the way from one place to another there are many; those where the axes rested stay known.
  constexpr std::size_t kMostPlaces = 32;
  const auto here =
      std::find_if(external_places_.begin(), external_places_.end(),
                   [&](const ExternalPlace& known) { return at_place(now, known.at); });
  if (here != external_places_.end()) {
    if (++here->samples <= kSettling)
      for (std::size_t k = 0; k < now.size(); ++k)
        here->at[k] += (now[k] - here->at[k]) / static_cast<double>(here->samples);
    std::iter_swap(here, external_places_.begin());
    return;
  }
  if (external_places_.size() == kMostPlaces)
    external_places_.erase(std::min_element(
        external_places_.begin() + 1, external_places_.end(),
        [](const ExternalPlace& a, const ExternalPlace& b) { return a.samples < b.samples; }));
  external_places_.insert(external_places_.begin(), {now, external_numbers_++, 1});
}

void SampleReader::append_csv(std::string& row) const {
  const auto each = [&](const auto& see) {
    for (const auto& source : pose_) see(source.text);
    for (const auto& source : angles_) see(source.text);
    if (with_currents_)
      for (const auto& source : currents_) see(source.text);
  };
  const std::size_t before = row.size();
  std::size_t size = before;
  each([&](std::string_view text) { size += 1 + text.size(); });
  row.resize(size);
  char* at = row.data() + before;
  each([&](std::string_view text) {
    *at++ = ',';
    at = rsi::copy(at, text.data(), text.size());
  });
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
