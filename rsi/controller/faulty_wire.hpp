#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace rsi {

/// A datagram on a faulty wire.
struct Sent {
  enum class What : std::uint8_t {
    telegram,  ///< whole
    cut,       ///< the first part of one: at least its last '>' is missing, at most all of it
    garbage,   ///< random bytes, or none
    foreign,   ///< a whole one that is to come from another address than the controller's
  };
  What what = What::telegram;
  std::string_view payload;
};

/// A network that loses, duplicates, swaps and cuts telegrams on purpose, with garbage and
/// strangers besides. One telegram suffers at most one of these, and the first of a run none, so
/// that the counts say exactly what a receiver can find. The same seed does the same again.
class FaultyWire {
 public:
  /// Probabilities for each telegram.
  struct Rates {
    double lose = 0;
    double duplicate = 0;
    double swap = 0;  ///< with the next one
    double cut = 0;
    double garbage = 0;  ///< comes before it
    double foreign = 0;  ///< a copy that comes before it
  };

  struct Counts {
    std::uint64_t lost = 0;
    std::uint64_t duplicated = 0;
    std::uint64_t swapped = 0;  ///< pairs
    std::uint64_t cut = 0;
    std::uint64_t garbage = 0;
    std::uint64_t foreign = 0;
  };

  /// Throws std::invalid_argument unless the rates are probabilities whose sum is at most 1.
  FaultyWire(const Rates& rates, std::uint64_t seed);

  /// Takes the next telegram and returns what goes on the wire now, in order: none, one or two
  /// datagrams. A telegram to be swapped is held back until the next one. Valid until the next
  /// call, and as long as `telegram`.
  [[nodiscard]] const std::vector<Sent>& pass(std::string_view telegram);
  /// At the end of a run, where the controller stops or starts anew: a telegram that is still held
  /// back.
  [[nodiscard]] const std::vector<Sent>& flush();

  [[nodiscard]] const Counts& counts() const { return counts_; }

 private:
  const std::string& random_bytes();

  Rates rates_;
  std::mt19937_64 random_;
  Counts counts_;
  std::string held_;
  bool holding_ = false;
  bool first_ = true;
  std::string garbage_;
  std::vector<Sent> out_;
};

}  // namespace rsi
