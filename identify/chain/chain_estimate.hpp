#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "identify/chain/chain.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace identify {

/// Standard deviations of what was measured, each sample on its own.
struct ChainNoise {
  double position_mm = 0;         ///< isotropic, each coordinate
  double orientation_rad = 0;     ///< isotropic, about each direction
  double locked_rad = 0;          ///< of the angle of each joint that stands
  std::vector<double> swept_rad;  ///< of a sweeping joint's angle, one a joint
};

/// How the figures of arcs fall with the order of their Chebyshev polynomials: with its square,
/// with its third power, or as the waves of a whole turn, a half and a third of it do over the arc.
/// Weight that bends locked joints is of the last kind: much of what circles take up, and hardly
/// more.
enum class FigureLaw { square, cube, waves };
inline constexpr std::array kFigureLaws{FigureLaw::square, FigureLaw::cube, FigureLaw::waves};

/// How long a locked joint keeps one offset from home: for one stroke, for all strokes of a stand,
/// or for those of a rest (ChainNodes).
enum class HomeLasts : unsigned char { stroke, stand, rest };
[[nodiscard]] std::string_view text(HomeLasts lasts) noexcept;

/// How far what was measured departs from the chain beyond the samples' noise: standard deviations
/// of random effects. Zero: there is none.
struct ChainEffects {
  /// Of each locked joint's place in a stroke from its home: a rotation about its axis.
  double home_rad = 0;
  HomeLasts home_lasts = HomeLasts::stroke;
  /// Of how far each locked joint goes on evenly while a stroke runs, from its middle to its end.
  double creep_rad = 0;
  /// Of the measuring device's place in a stroke, each coordinate. It walks on during a stroke.
  double drift_mm = 0;
  /// Of how far it drifts steadily from the middle of the campaign to its end, each coordinate:
  /// the first part of the chain's `drift_mm`. Of `drift_parts`, the others are of the size that
  /// they have of a random walk.
  double steady_mm = 0;
  Eigen::Index drift_parts = 1;
  /// Of the chain's `move`, each coordinate of its shifts.
  double moved_mm = 0;
  /// How many numbers of a chain's `drift_mm` there are.
  [[nodiscard]] Eigen::Index drift_columns() const { return steady_mm > 0 ? 3 * drift_parts : 0; }
  /// Of the figure that a stroke describes, radial and axial, from a circle: the standard deviation
  /// of the coefficient of its first Chebyshev polynomial, one a law by which the others fall. It
  /// is the sum of such figures. At home, which is one pose of the arm however it was reached,
  /// there is no such departure. Strokes of one joint and target from one home share their figure.
  std::array<double, kFigureLaws.size()> figures_mm{};
  [[nodiscard]] double figure_mm() const {
    return std::hypot(figures_mm[0], figures_mm[1], figures_mm[2]);
  }
  /// Of each joint's place at another home from where its angle says: what its gear and the load
  /// are off by there and were not at the first home. Strokes from one home share it.
  double offset_rad = 0;
  /// Of what a joint's angles are off by along its arc where they are believed: the standard
  /// deviation of the coefficient of each Chebyshev polynomial. An even motion printed with few
  /// decimals leaves such a pattern. Strokes of one joint from one home share it.
  double told_rad = 0;
  /// Beside `home_rad`, of each locked joint's place in a stroke, as printed angles differ: see
  /// untold_places(). A joint without an axis turns what it carries about one that may pass it as
  /// far away as any known one.
  std::vector<double> places_rad;
  /// What the joint that gives way most does so by under the weight that it carries: `sags` of the
  /// chain.
  double sag_rad = 0;
  /// How many times as large one joint's `home_rad` and `creep_rad`, as a locked one, and
  /// `figures_mm`, as the sweeping one, are as the other joints': one a joint, none where all are
  /// alike.
  std::vector<double> home_times;
  std::vector<double> figure_times;
  /// By how much minus twice the log likelihood is less where joints go on at all, and where one
  /// joint is unlike the others: one a joint, or none. What is said of a joint needs more of it
  /// than what is allowed for.
  double creep_gain = 0;
  std::vector<double> home_gains;
  std::vector<double> figure_gains;
  [[nodiscard]] double home_times_of(std::size_t joint) const {
    return home_times.empty() ? 1 : home_times[joint];
  }
  [[nodiscard]] double home_rad_of(std::size_t joint) const {
    return home_rad * home_times_of(joint);
  }
  [[nodiscard]] double figure_times_of(std::size_t joint) const {
    return figure_times.empty() ? 1 : figure_times[joint];
  }
  /// Of what single strokes have for themselves beside that, as something moved while they ran: of
  /// each coordinate's shift, of how it grows and of how it bends. One a unit, most of them 0; none
  /// where there is none.
  std::vector<double> stray_mm;
  [[nodiscard]] bool any_stray() const {
    return std::any_of(stray_mm.begin(), stray_mm.end(), [](double mm) { return mm > 0; });
  }
  /// One joint that goes on while another one sweeps, by far more than `creep_rad`. Of those that
  /// may have while one joint swept, the likeliest comes first.
  struct Along {
    std::size_t swept = 0;
    std::size_t joint = 0;
    double rad = 0;      ///< how far it goes on from the stroke's middle to its end
    double off_rad = 0;  ///< how far off home it stands in that stroke's middle
  };
  std::vector<Along> along;
  /// Homes, creep, drift and figures times `share`. Offsets, told angles, sag, and what happened
  /// once stay as they are.
  [[nodiscard]] ChainEffects times(double share) const {
    ChainEffects less = *this;
    less.home_rad *= share;
    less.creep_rad *= share;
    less.drift_mm *= share;
    less.steady_mm *= share;
    for (double& figure_mm : less.figures_mm) figure_mm *= share;
    return less;
  }
  bool sag_told = false;  ///< the description tells `sag_rad`; else sweeps from several homes do

  /// How far each joint may stand from where its printed angle says, one a joint: `zero_rad` of the
  /// chain is estimated where its angle is believed. None: it is not.
  std::vector<double> zero_rad;
  /// Steps of the last decimal that X, Y, Z and A, B, C are printed with, where rounding shifts
  /// whole strokes (StrokeRounding). Zero: it does not.
  double print_mm = 0;
  double print_rad = 0;
  double print_turn_rad = 0;  ///< and the sweeping joint's angle, where it is believed
  /// How much later than in step such angles may be told: a standard deviation.
  double late_s = 0;
};

/// Shares of the other effects (ChainEffects::times()) beside which something that happened once is
/// looked for.
inline constexpr std::array kLessBeside{0.0, 1.0 / 4, 1.0};

/// What makes an estimate uncertain: the samples' noise, and the effects.
enum class Cause { noise, home, drift, figure, offset, print, sag, angles, height };
[[nodiscard]] std::string_view text(Cause cause) noexcept;   ///< one word, for programs
[[nodiscard]] std::string_view words(Cause cause) noexcept;  ///< for people

/// As the noise of a sweeping joint: its angle is not used.
inline constexpr double kFreeAngle = std::numeric_limits<double>::infinity();

/// How far the angles of a sweeping joint are believed.
enum class AngleTrust {
  trusted,  ///< right to the print quantum: they come from the encoders that gave the positions
  smooth,   ///< off by a smooth curve, which is stated; not used for the geometry
  free,     ///< off without a pattern, or not known at all; not used
};
[[nodiscard]] std::string_view text(AngleTrust trust) noexcept;

/// What decided about a joint's angles. Errors are the controller's angle minus the angle at which
/// the target was seen on the circle.
struct AngleEvidence {
  AngleTrust trust = AngleTrust::free;
  std::string reason;
  std::size_t samples = 0;       ///< with an angle; zero: nothing below means anything
  double error_rms_rad = 0;      ///< of the whole error
  double remainder_rms_rad = 0;  ///< of what the curve below leaves
  double expected_rms_rad = 0;   ///< from position noise and print quantum alone
  double size = 0;       ///< tangential residuals of angles believed, in print quanta's sigma
  double coherence = 0;  ///< their variance along smooth curves, in that of white noise: 1
  double remainder_coherence = 0;  ///< as above, of what the curve leaves, along higher harmonics
  /// The transmission error: e(q) = offset + scale q + c1 (cos q - 1) + s1 sin q + c2 (cos 2q - 1)
  /// + s2 sin 2q with q from home, fitted over the range that was swept and of use only there.
  std::array<double, 6> curve{};
  double center_sigma_rad = 0;  ///< what is not known of the axis' place looks like such a curve
  double backlash_rad = 0;      ///< error of falling strokes minus that of rising ones
  double backlash_sigma_rad = 0;
  bool backlash_repeats = false;  ///< strokes that go the same way show how far they differ

  [[nodiscard]] double curve_at(double turn_rad) const;
};

/// Robots come home, and devices stay, by better than this.
inline constexpr double kHomeScatter_mm = 0.2;

/// How the least-squares problem ended.
struct Summary {
  bool converged = false;
  std::string_view ending;       ///< in words
  int iterations = 0;            ///< of Gauss-Newton, all stages
  double cost = 0;               ///< half the weighted sum of squares
  double last_step = 0;          ///< in standard uncertainties, of the parameter that moved most
  double condition = 0;          ///< of the scaled normal matrix
  std::size_t undetermined = 0;  ///< directions in parameter space without information
};

/// What sweeps showed beside the geometry.
struct SweepEvidence {
  ChainNoise noise;
  ChainEffects effects;
  std::vector<AngleEvidence> angles;  ///< one a joint
  /// How far the target stood off from home in each stroke, by the effects of home and drift.
  double home_scatter_mm = 0;
  /// How far the measuring device wandered beside steady drift: standard deviation of each
  /// coordinate.
  double wander_mm = 0;
  /// How far the measuring device drifted steadily over the whole campaign, along the measurement
  /// frame's axes, and what it took; 0 where times are only an order. It is out of everything
  /// above.
  struct SteadyDrift {
    Eigen::Vector3d mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double seconds = 0;
  };
  std::optional<SteadyDrift> steady_drift;  ///< where the data show one
  /// How far the target at home was moved in the measurement frame, once: with the device, with the
  /// robot's base, on the tool, or because a joint stayed off home; of several targets the one that
  /// went farthest. The estimate is of what was there after that. It, too, is out of everything
  /// above.
  struct MoveSeen {
    Eigen::Vector3d mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    std::size_t joint = 0;             ///< whose stroke is the first one after it
    double time_s = 0;                 ///< of that stroke's first sample
    std::optional<std::size_t> alone;  ///< the only joint that swept on one side of it
  };
  std::optional<MoveSeen> move;  ///< where the data show one
  struct SweepAt {
    std::size_t joint = 0;
    std::size_t number = 0;  ///< of the joint's sweeps, in the order of time, from 0
    std::size_t of = 0;      ///< so many of them
  };
  /// A sweep that does not go with the others, since something moved while it ran: it hardly
  /// counts.
  struct StraySweep : SweepAt {
    double mm = 0;  ///< what it has for itself at the target, about: a standard deviation
  };
  std::vector<StraySweep> strays;
  /// What may have happened just as well as what the estimate allows for, and would change it. The
  /// uncertainties have that in them.
  struct OtherExplanation : SweepAt {
    bool moved = false;  ///< something, before or during it, for good; else the sweep is a stray
    double mm = 0;       ///< a standard deviation
  };
  std::vector<OtherExplanation> others;  ///< the likeliest first
  std::size_t samples = 0;
  std::size_t outliers = 0;            ///< of them: given less than half their weight
  std::size_t summed = 0;              ///< strokes of which only sums were known
  double samples_per_independent = 1;  ///< how many correlated samples are worth one
};

/// What the chain estimator found (see chain_estimator.hpp).
struct ChainEstimate : SweepEvidence {
  /// All joints of the arm; those without an axis below are never turned.
  Chain chain;
  /// By how much each joint, where it was locked at home, had turned beyond what its angle said: of
  /// numbers with few decimals. One a joint, or none.
  std::vector<double> locked_rad;
  /// One a joint, along positive rotation. Nothing where the joint could not be used.
  std::vector<std::optional<Axis>> axes;
  /// Of all axes' (direction, point), six rows a joint, then three a target, then,
  /// with orientation, three of the tool's rotation in the measurement frame.
  Eigen::MatrixXd covariance;
  /// With linear joints: how (direction, point) of the table's axes, six rows a joint, change with
  /// the first target only because convention places theirs by it. Else empty.
  Eigen::MatrixXd by_target;
  /// What each cause has of it; together they are it.
  struct Part {
    Cause cause = Cause::noise;
    Eigen::MatrixXd covariance;
  };
  std::vector<Part> parts;
  /// Of an arm with linear joints: how far it is open how high base and target stand, of which
  /// Cause::height comes.
  double height_open_mm = 0;
  std::vector<DhEstimate> dh;
  bool with_orientation = false;  ///< A, B, C were present, consistent, and used
  Summary summary;
};

}  // namespace identify
