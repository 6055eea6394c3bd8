#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace rsi {

/// What an object of an RSI context does beside passing signals on; what is worse comes later.
enum class RsiEffect {
  none,
  tells_program,  ///< writes a variable that the robot's program may act on
  unknown,        ///< not an object that sweepd knows
  sets_output,
  sets_speed,  ///< of the robot's program
  moves,
};

/// By an object's ObjType, in any case, and its ObjTypeID, which controllers go by: the worse of
/// what the two say. Objects as of RSI 3 to 5 (otherworld-dev/rsi-pi, docs/rsi-objects.md).
[[nodiscard]] RsiEffect rsi_effect(std::string_view type, std::string_view type_id);

/// The object that speaks to sweepd.
[[nodiscard]] bool is_ethernet(std::string_view type, std::string_view type_id);

/// In words that follow an object's name: "can move the robot".
[[nodiscard]] std::string_view text(RsiEffect effect) noexcept;

/// Which object of an RSI context feeds which, loops included. All in linear time.
class SignalFlow {
 public:
  /// Objects are counted from 0 in this order. `from_outside`: signals that come over the network
  /// begin here. False if another has this name: links then mean that one.
  bool add(std::string_view id, bool from_outside);

  /// After all were added: the object of this name, else the one whose name differs in case only.
  /// of() is `none` if there is neither.
  static constexpr std::size_t none = SIZE_MAX;
  [[nodiscard]] std::size_t of(std::string_view id) const;
  void link(std::size_t from, std::size_t to);
  /// For messages.
  [[nodiscard]] const std::string& name(std::size_t object) const { return nodes_[object].name; }
  [[nodiscard]] bool is_fed(std::size_t object) const { return nodes_[object].fed; }

  /// After all links were made: the way that leads to each object, the shortest from outside, else
  /// from what nothing feeds, else from somewhere in its loop.
  void trace();
  /// "ETHERNET1 -> LIMIT1 -> POSCORR1", without its middle if it is long; the object's name alone
  /// if nothing feeds it.
  [[nodiscard]] std::string path(std::size_t object) const;

 private:
  struct Node {
    std::string name;  ///< for messages
    bool from_outside;
    bool fed = false;
    std::vector<std::size_t> feeds = {};
    std::size_t before = none;  ///< on the way to it
    bool reached = false;
  };

  void spread(std::vector<std::size_t> front);

  std::vector<Node> nodes_;
  std::unordered_map<std::string, std::size_t> by_id_;
  std::unordered_map<std::string, std::size_t> by_id_in_any_case_;
};

}  // namespace rsi
