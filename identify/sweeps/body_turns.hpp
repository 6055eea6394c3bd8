#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "identify/sweeps/sweep.hpp"

namespace identify {

/// The turns of several targets of one body, which move at once about one axis. A target that was
/// out of sight for a while, or got another name, saw a part of them.
class BodyTurns {
 public:
  /// Of strokes without a joint, of an arm with so many joints that turn.
  BodyTurns(const std::vector<Sweep>& strokes, std::size_t joints);

  /// Lists of turns whose joints are to be told, each by itself, in the order of time: those of
  /// each target that saw as many as there are joints. Where none did, those of all together, with
  /// the best known axis and strokes of any target. Where targets do not see one body, those of
  /// each.
  [[nodiscard]] const std::vector<std::vector<Turn>>& to_tell() const { return to_tell_; }

  /// All strokes of a turn get the joint and the direction of one that has them: the one that ran
  /// when they did, or nearest to it. `strokes`: as given to the constructor.
  void spread(std::vector<Sweep>& strokes) const;

 private:
  using Members = std::vector<Turn>;  ///< of one turn, as targets saw it

  /// False, and nothing is added, where `seen_before` they have to be, and one was not.
  bool add(const std::vector<Turn>& turns, bool seen_before);
  [[nodiscard]] const Members* seen_by_others(const Turn& turn) const;
  [[nodiscard]] std::vector<Turn> together() const;
  [[nodiscard]] bool run_at_once(const Turn& first, const Turn& second) const;
  [[nodiscard]] double end_s(const Turn& turn) const;

  const std::vector<Sweep>& strokes_;
  std::vector<Members> turns_;
  std::vector<std::vector<Turn>> to_tell_;
};

/// What a person should know of strokes without a joint whose positions are on no circle: nothing
/// tells whose they are. Nothing where there are none.
[[nodiscard]] std::optional<std::string> moves_on_no_circle(const std::vector<Sweep>& strokes);

}  // namespace identify
