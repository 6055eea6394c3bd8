#pragma once

#include <compare>
#include <cstddef>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "identify/sweeps/stroke_moments.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {

/// The sweeps of a stream that there is memory for, spread over all of the stream.
///
/// A kind of sweep is what a program repeats: one joint, or an unknown one, goes one way while the
/// other joints stand at one place. All sweeps are kept until memory is full. Then every second
/// sweep goes of the kinds that have most sweeps, and of these kinds only every second one is kept
/// from then on; later every fourth, and so on. The first sweep of a kind stays: nothing that was
/// swept once is lost to what repeats. Of a sweep that goes, what the chain estimator needs of it
/// is added to the first one of its kind (Sweep::repeats) if it is moments_like() that one: a
/// hundredth of the memory, however many go.
///
/// Where the first sweeps of all kinds take more than half of the memory, sweeps lose every second
/// sample, down to some hundred. Then every second kind goes of the joints and directions that have
/// most kinds. Without angles the order in which sweeps came tells their joints: there the earliest
/// kinds stay, and of a joint's turn all sweeps or none.
///
/// The same sweeps give the same choice. One thread.
class KeptSweeps {
 public:
  struct LeftOut {
    std::size_t sweeps = 0;
    bool kinds = false;             ///< of some kinds nothing is kept
    std::size_t sample_stride = 1;  ///< of a sweep every n-th sample is kept
  };

  /// What a sweep takes beside its samples, also while it is worked on, as if it were samples.
  static constexpr std::size_t kOfSweep = 50;

  /// `most_samples`: that memory is set aside for.
  explicit KeptSweeps(std::size_t most_samples) : most_samples_(most_samples) {}
  KeptSweeps(const KeptSweeps&) = delete;
  KeptSweeps& operator=(const KeptSweeps&) = delete;

  void keep(const identify::Sweep& sweep);

  /// In the order of time.
  [[nodiscard]] const std::vector<identify::Sweep>& sweeps() const { return sweeps_; }
  [[nodiscard]] LeftOut left_out() const;

 private:
  struct Way {
    explicit Way(const identify::Sweep& sweep);
    [[nodiscard]] bool like(const Way& other) const;

    std::optional<std::size_t> joint;
    double range_rad;
    identify::Sample first, middle, last;
  };

  /// What kinds have in common that differ in their way alone.
  struct Group {
    std::optional<std::size_t> joint;
    std::size_t target;
    int direction;
    identify::SweepDefect defect;
    bool external_axis_moved;
    friend auto operator<=>(const Group&, const Group&) = default;
  };
  struct Kinds {
    std::size_t seen = 0;
    std::size_t kept = 0;
    std::size_t stride = 1;                                      // every n-th is kept
    std::size_t most = std::numeric_limits<std::size_t>::max();  // so many are kept
  };
  struct Kind {
    Group group;
    std::size_t number = 0;  // in its group
    Way way;
    std::size_t repeat = 0;  // in a turn, see repeats_in_turn()
    std::size_t seen = 0;
    std::size_t kept = 0;
    std::size_t stride = 1;
    std::optional<identify::StrokeMoments> reference = {};  // the first one's, once others go
  };
  struct Place {
    Kind* kind;
    std::size_t number;  // in its kind
  };

  Kind* kind_of(const identify::Sweep& sweep);
  std::size_t repeats_in_turn(const identify::Sweep& sweep, const Way& way);
  void add(const identify::Sweep& sweep, Place place);
  /// Adds what the chain needs of a sweep that goes to the first one of its kind.
  void sum_up(const identify::Sweep& sweep, Kind& kind);
  [[nodiscard]] identify::Sweep* first_of(const Kind& kind);
  /// False where none can be made.
  bool make_room();
  void halve_repeats();
  void halve_kinds(std::size_t fullest);
  bool halve_samples();
  /// Lets those go that `stays` does not tell of.
  template <typename Stays>
  void filter(const Stays& stays);

  const std::size_t most_samples_;
  std::vector<identify::Sweep> sweeps_;
  std::vector<Place> places_;  // one a sweep
  std::list<Kind> kinds_;      // those of which something is kept
  std::map<Group, Kinds> groups_;
  std::size_t memory_ = 0;  // in samples
  std::size_t sample_stride_ = 1;
  std::size_t seen_ = 0;
  bool kinds_left_out_ = false;

  // Without angles: the sweeps of the joint whose turn it is.
  std::optional<identify::Sweep> before_;
  std::vector<Way> turn_;
};

}  // namespace sweepd
