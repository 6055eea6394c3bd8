#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rsi {

struct Signal;

/// All of a telegram but its values. The telegrams of one controller differ in nothing else, so
/// that the next one is compared with the one before and need not be parsed.
///
/// It takes no telegram that the parser would read in another way: a value with a character of the
/// markup, an empty text or one with blanks about it are left to the parser.
///
/// Keeps its memory, and allocates only while telegrams grow. Not thread-safe.
class TelegramShape {
 public:
  /// Takes the shape of a whole telegram. `signals` are what the parser found in it, and `ipoc` the
  /// digits of its IPOC: views into it. A telegram that could be read in another way has no shape.
  void learn(std::string_view datagram, const std::vector<Signal>& signals, std::string_view ipoc);

  /// False if the datagram has another shape. Else `signals` and `ipoc` are those of the datagram;
  /// the names are views into this object. `signals` is always the same object.
  [[nodiscard]] bool read(std::string_view datagram, std::vector<Signal>& signals,
                          std::string_view& ipoc);
  /// Who else changes `signals` says so: their names are set anew.
  void signals_changed() { named_by_ = nullptr; }

 private:
  /// A value, and the gap between the value before and it.
  struct Slot {
    enum class Kind : unsigned char { attribute, text, ipoc };
    static constexpr std::size_t kAsBefore = static_cast<std::size_t>(-1);

    Kind kind = Kind::attribute;
    std::size_t gap = 0;  ///< where it begins in `learned_`
    std::size_t gap_size = 0;
    std::size_t element = kAsBefore;  ///< places in `learned_`
    std::size_t element_size = 0;
    std::size_t attribute = 0;
    std::size_t attribute_size = 0;
    /// Of the value without '-' in the telegram last read: nearly always the next one's, too.
    std::size_t unsigned_size = 0;
  };

  bool add(Slot slot, std::string_view value, std::size_t at);
  void name(std::vector<Signal>& signals);

  std::string learned_;
  std::vector<Slot> slots_;  ///< none: no shape
  std::size_t rest_ = 0;     ///< where in `learned_` the last value ends
  /// Whose bytes the names of the signals are: of no copy of this.
  const char* named_by_ = nullptr;
};

}  // namespace rsi
