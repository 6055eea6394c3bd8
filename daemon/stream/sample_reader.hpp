#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/settings/settings.hpp"
#include "daemon/stream/joint_currents.hpp"
#include "identify/sweeps/sample.hpp"
#include "rsi/telegram/telegram.hpp"

namespace sweepd {

/// "AIPos.A1" is an attribute, "DiL" the text of an element.
[[nodiscard]] rsi::SignalPlace place_of(const std::string& name);

/// Takes the measured values out of telegrams: where rsi ends and identify begins.
class SampleReader {
 public:
  /// The first `joints` names of the angles count. `with_currents`: samples.csv has motor currents.
  SampleReader(const SignalNames& names, std::size_t joints, bool with_currents = false);

  /// Position, orientation and angles, each only if all of its values are there and numbers; the
  /// time is left to the caller.
  [[nodiscard]] identify::Sample read(const rsi::Telegram& telegram);

  /// Motor currents of the telegram last read; nothing where it has none.
  [[nodiscard]] const std::optional<Currents>& currents() const { return read_currents_; }

  /// Appends ",x,y,z,a,b,c,a1,…" of the telegram last read, as the controller printed them; nothing
  /// between the commas for what is missing or no number that can be measured.
  void append_csv(std::string& row) const;
  [[nodiscard]] std::string csv_header() const;

  /// The last decimal that was printed so far, in the finest telegram.
  [[nodiscard]] const identify::Resolution& resolution() const { return resolution_; }

  /// Values that were there but no numbers that can be measured.
  [[nodiscard]] std::uint64_t unusable() const { return unusable_; }

  /// Samples that lack a part, of all that were read.
  struct Incomplete {
    std::uint64_t samples = 0;
    std::uint64_t without_position = 0;
    std::uint64_t without_angles = 0;  ///< of one joint or more
  };
  [[nodiscard]] const Incomplete& incomplete() const { return incomplete_; }

 private:
  /// A signal, and the number that stood there.
  struct Source {
    rsi::SignalPlace place;
    std::string_view text = {};
  };

  std::size_t take(const rsi::Telegram& telegram, std::span<Source> sources, int& decimals,
                   double* values);
  void follow_external_axes(const rsi::Telegram& telegram);

  std::vector<Source> pose_;  // X Y Z A B C
  std::vector<Source> angles_;
  std::vector<Source> currents_;
  std::optional<Currents> read_currents_;
  bool with_currents_;
  std::vector<rsi::SignalPlace> external_;  ///< the controller's external axes
  static constexpr std::size_t kExternalAxes = 6;
  using ExternalReading = std::array<double, kExternalAxes>;
  /// The last readings, 40 ms at 4 ms: where the axes stand is the median of each.
  static constexpr std::size_t kExternalReadings = 11;
  std::array<ExternalReading, kExternalReadings> external_readings_{};
  std::size_t external_read_ = 0;   ///< so many in all
  std::size_t external_there_ = 0;  ///< so many of the last at the place where the axes are
  /// Of so many samples a place is the mean: one that creeps is not followed.
  static constexpr std::size_t kSettling = 100;
  [[nodiscard]] static bool at_place(const ExternalReading& now, const ExternalReading& place);
  [[nodiscard]] ExternalReading usual_external_reading() const;
  void find_external_place(const ExternalReading& now);
  /// Where they all stood, for so many samples.
  struct ExternalPlace {
    ExternalReading at{};
    std::uint16_t number = 0;
    std::size_t samples = 0;
  };
  std::vector<ExternalPlace> external_places_;  ///< the first one is where they stand
  std::uint16_t external_numbers_ = 0;
  identify::Resolution resolution_;
  int position_decimals_ = -1;
  int angle_decimals_ = -1;
  std::uint64_t unusable_ = 0;
  Incomplete incomplete_;
};

}  // namespace sweepd
