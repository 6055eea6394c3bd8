#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "identify/geometry/line.hpp"
#include "identify/sweeps/sample.hpp"

namespace identify {

/// Why a stroke cannot be used as a sweep.
enum class SweepDefect {
  none,
  too_short,  ///< its arc says nothing about an axis
  too_few_samples,
  other_joint_moved,  ///< a second joint crept along
  not_an_arc,         ///< no angles, and the positions do not lie on a circle
};

struct StrokeMoments;

/// A stroke of one joint from rest (or turning point) to rest, while the others stood.
/// Copies share the samples.
struct Sweep {
  std::shared_ptr<const std::vector<Sample>> samples;  ///< in the order of time; never empty
  std::optional<std::size_t> joint;  ///< counted from 0; nothing where no angles tell it
  std::size_t target = 0;            ///< which of several target points was measured
  int direction = 0;                 ///< +1: the controller's angle rises; -1: it falls; 0: unknown
  double range_rad = 0;  ///< the angle that was turned, positive; of a linear joint mm * kDegree
  SweepDefect defect = SweepDefect::none;
  /// Where the stream was blind while it ran, it began earlier or ended later than its samples.
  bool begin_seen = true, end_seen = true;
  /// Leads to the start of a sweep, or from its end back home: known once all strokes are.
  bool positioning = false;
  /// Of strokes that went the same way and of which no sample is kept: their moments_like() this
  /// one, in one sum. Null: there are none.
  std::shared_ptr<const StrokeMoments> repeats;

  [[nodiscard]] const Sample& first() const { return samples->front(); }
  [[nodiscard]] const Sample& last() const { return samples->back(); }
};

/// The code of the warning that a joint whose sweeps are like that gets.
[[nodiscard]] std::string_view code(SweepDefect defect) noexcept;
/// What is wrong with them, and what to do. `linear`: the joint is known to be.
[[nodiscard]] std::string_view remedy(SweepDefect defect, bool linear) noexcept;

/// Strokes about one axis: those of one joint, no angle telling of which.
struct Turn {
  struct Stroke {
    std::size_t place = 0;  ///< in the list that was searched
    double begin_s = 0;
    double angle_rad = 0;  ///< positive about the axis
    bool begin_seen = true, end_seen = true;
    /// Where the stroke before may have gone on in this one: by how much while the stream was
    /// blind.
    std::optional<double> gap_rad;
    /// The stroke before rested where this one goes on the same way: both may be one that paused.
    bool goes_on = false;
  };
  std::vector<Stroke> strokes;
  double unsure = 0;  ///< the share of the angles that noise may have made up
  Axis axis;          ///< its sense of rotation is any

  [[nodiscard]] double begin_s() const { return strokes.front().begin_s; }
};

/// Groups strokes without a defect: those one after the other whose points lie on one circle are of
/// one turn. As long as that makes more turns than there are `joints`, they may miss it by more, as
/// homes do that joints come to anew; then those about one axis that others came between are one,
/// too, and no more than twice as many turns are told. (Two joints may have one axis at home: they
/// stay apart as long as there is room.) Turns in the order in which they began. Of `strokes` those
/// count whose place is in `places`.
[[nodiscard]] std::vector<Turn> turns_in(const std::vector<Sweep>& strokes,
                                         const std::vector<std::size_t>& places,
                                         std::size_t joints);

/// Where positions on an arc or a line, in the order of time, turn round: the first sample of each
/// stroke but the first. So does a stroke that begins elsewhere than the one before ended, since
/// nobody recorded the way there. Sways below two degrees or 2 mm, and what noise could feign, are
/// none. Nothing where the samples turn so often that they are in no order.
[[nodiscard]] std::vector<std::size_t> turning_points(const std::vector<Sample>& samples);

}  // namespace identify
