#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "identify/dh/joint_order.hpp"
#include "identify/sweeps/campaign.hpp"
#include "identify/sweeps/sweep.hpp"

namespace identify {

/// What a campaign declares, joint by joint, and how well turns that were seen agree with it.
class PlannedTurns {
 public:
  explicit PlannedTurns(const Campaign& campaign);

  [[nodiscard]] bool given() const { return given_; }
  /// Joints, counted from 0, in the order in which they come first; without a plan all of the arm.
  /// Those alone that turn: a linear joint's strokes are no turns.
  [[nodiscard]] const std::vector<std::size_t>& order() const { return order_; }
  /// Chi squared of a turn as one of `joint`. `sense`: +1 where the joint's angle rises about the
  /// turn's axis, -1 where it falls.
  [[nodiscard]] double misfit(const Turn& turn, std::size_t joint, int sense) const;
  /// Whether a turn may be what the plan has for `joint`: no stroke is foreign to it.
  [[nodiscard]] bool explains(const Turn& turn, std::size_t joint, int sense) const;
  /// The same of all turns together; those that are no joint's do not count.
  [[nodiscard]] double misfit(const std::vector<Turn>& turns, const JointOrder& order) const;
  [[nodiscard]] bool explains(const std::vector<Turn>& turns, const JointOrder& order) const;
  [[nodiscard]] bool tells_sense(std::size_t joint) const;
  /// Whether the plan, which does not explain the other sense, tells this one: by all strokes, or
  /// by those up to the longest, as where there is a way back that the plan does not have.
  [[nodiscard]] bool tells(const Turn& turn, std::size_t joint, int sense) const;
  /// Which of the turns agree best with the plan's joints, in its order: a joint for each, or
  /// kNoJoint where there are more turns than joints. At least as many turns as joints.
  [[nodiscard]] std::vector<std::size_t> joints_of(const std::vector<Turn>& turns) const;
  /// Whether the turns may be what the plan has for its joints, one after the other.
  [[nodiscard]] bool explains_in_order(const std::vector<Turn>& turns) const;

  /// One of the turns as those of two joints.
  struct Parting {
    double cost = 0;     ///< chi squared
    bool whole = false;  ///< all strokes that the plan has for these joints were seen
    std::size_t turn = 0;
    std::array<Turn, 2> parts;

    /// All turns with it, in the order of time.
    [[nodiscard]] std::vector<Turn> of(std::vector<Turn> turns) const;
  };
  /// How one of the turns may be those of two joints, since two joints may have one axis: by their
  /// strokes, in the plan's order. Where the plan has others between theirs, others came between
  /// here, too. The likeliest first.
  [[nodiscard]] std::vector<Parting> partings(const std::vector<Turn>& turns) const;

 private:
  struct Sensed {
    std::size_t joint = 0;
    int sense = 1;
  };

  [[nodiscard]] std::optional<std::array<Turn, 2>> parted(
      const std::vector<Turn>& turns, std::size_t turn, const std::array<Sensed, 2>& joints) const;
  [[nodiscard]] double misfit(const Turn& turn, std::size_t joint) const;
  [[nodiscard]] bool begins(const Turn& turn, std::size_t joint, int sense) const;

  bool given_ = false;
  std::vector<std::size_t> order_;
  std::vector<std::vector<double>> strokes_;
  std::vector<std::pair<std::size_t, double>> sequence_;  // all strokes, with their joints
  std::vector<int> first_;
};

}  // namespace identify
