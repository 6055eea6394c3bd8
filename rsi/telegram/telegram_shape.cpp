#include "rsi/telegram/telegram_shape.hpp"

#include <array>

#include "rsi/ascii.hpp"
#include "rsi/telegram/telegram.hpp"
#include "rsi/words.hpp"

namespace rsi {
namespace {

/// With one of these in a value the parser, or find_ipoc(), may see other tags.
constexpr auto kNoValue = [] {
  std::array<bool, 256> markup{};
  for (const char c : {'<', '>', '=', '"', '\''}) markup[static_cast<unsigned char>(c)] = true;
  return markup;
}();

const char* end_of_value(const char* at, const char* end) {
  while (at != end && !kNoValue[static_cast<unsigned char>(*at)]) ++at;
  return at;
}

/// Not zero if a byte is none that numbers have, + to 9: those above are among these.
inline std::uint64_t not_numeric(std::uint64_t word) {
  constexpr std::uint64_t kHigh = 0x80 * kEachByte;
  const std::uint64_t below = ~((word | kHigh) - '+' * kEachByte);
  const std::uint64_t above = word + (0x7f - '9') * kEachByte;
  return (below | above | word) & kHigh;
}

/// Whether a value that begins here ends after so many bytes.
inline bool ends_after(std::size_t size, const char* at, const char* end) {
  if (static_cast<std::size_t>(end - at) <= size || !kNoValue[static_cast<unsigned char>(at[size])])
    return false;
  if (size >= 4 && size < 8)
    if (not_numeric(half_word_at(at) | half_word_at(at + size - 4) << 32) == 0) return true;
  if (size >= 8 && size <= 16)
    if ((not_numeric(word_at(at)) | not_numeric(word_at(at + size - 8))) == 0) return true;
  return end_of_value(at, at + size) == at + size;
}

bool plain_text(std::string_view value) {
  return !value.empty() && !is_blank(value.front()) && !is_blank(value.back());
}

}  // namespace

void TelegramShape::learn(std::string_view datagram, const std::vector<Signal>& signals,
                          std::string_view ipoc) {
  learned_ = datagram;
  signals_changed();
  slots_.clear();
  rest_ = 0;
  const auto place = [&](std::string_view part) {
    return static_cast<std::size_t>(part.data() - datagram.data());
  };
  bool with_ipoc = false;
  bool known = true;
  const auto add_ipoc = [&] {
    known = known && add({.kind = Slot::Kind::ipoc}, ipoc, place(ipoc));
    with_ipoc = true;
  };
  const Signal* before = nullptr;
  for (const Signal& signal : signals) {
    if (!with_ipoc && place(ipoc) < place(signal.text)) add_ipoc();
    Slot slot{.kind = signal.attribute.empty() ? Slot::Kind::text : Slot::Kind::attribute};
    if (place(signal.element) >= rest_) {
      slot.element = place(signal.element);
      slot.element_size = signal.element.size();
    } else if (before == nullptr || before->element.data() != signal.element.data()) {
      known = false;
    }
    if (!signal.attribute.empty()) {
      known = known && place(signal.attribute) >= rest_;
      slot.attribute = place(signal.attribute);
      slot.attribute_size = signal.attribute.size();
    }
    known = known && add(slot, signal.text, place(signal.text));
    before = &signal;
  }
  if (!with_ipoc) add_ipoc();
  if (!known) slots_.clear();
}

/// False if the value could be another one in another telegram of these tags. `at`: where it
/// begins.
bool TelegramShape::add(Slot slot, std::string_view value, std::size_t at) {
  const std::size_t end = at + value.size();
  if (at <= rest_ || end >= learned_.size()) return false;
  if (end_of_value(value.data(), value.data() + value.size()) != value.data() + value.size())
    return false;
  const char before = learned_[at - 1];
  const char after = learned_[end];
  const bool quoted = (before == '"' || before == '\'') && after == before;
  const bool between_tags = before == '>' && after == '<' && plain_text(value);
  if (slot.kind == Slot::Kind::attribute ? !quoted : !between_tags) return false;
  slot.gap = rest_;
  slot.gap_size = at - rest_;
  slot.unsigned_size = value.size() - (value.starts_with('-') ? 1 : 0);
  slots_.push_back(slot);
  rest_ = end;
  return true;
}

void TelegramShape::name(std::vector<Signal>& signals) {
  named_by_ = learned_.data();
  const std::string_view learned(learned_);
  std::string_view element;
  signals.clear();
  for (const Slot& slot : slots_) {
    if (slot.kind == Slot::Kind::ipoc) continue;
    if (slot.element != Slot::kAsBefore) element = learned.substr(slot.element, slot.element_size);
    signals.push_back({element, learned.substr(slot.attribute, slot.attribute_size), {}});
  }
}

bool TelegramShape::read(std::string_view datagram, std::vector<Signal>& signals,
                         std::string_view& ipoc) {
  if (slots_.empty()) return false;
  if (named_by_ != learned_.data()) name(signals);
  Signal* signal = signals.data();
  const char* at = datagram.data();
  const char* const end = at + datagram.size();
  const auto takes = [&](std::size_t from, std::size_t size) {
    if (static_cast<std::size_t>(end - at) < size || !equal(at, learned_.data() + from, size))
      return false;
    at += size;
    return true;
  };
  for (Slot& slot : slots_) {
    if (!takes(slot.gap, slot.gap_size)) return false;
    // A sign that comes and goes is looked at: nobody could predict it.
    const std::size_t sign = at != end && *at == '-' ? 1 : 0;
    std::size_t size = slot.unsigned_size + sign;
    if (!ends_after(size, at, end)) {
      size = static_cast<std::size_t>(end_of_value(at, end) - at);
      slot.unsigned_size = size - sign;
    }
    const std::string_view value(at, size);
    at += size;
    if (slot.kind != Slot::Kind::attribute && !plain_text(value)) return false;
    if (slot.kind == Slot::Kind::ipoc) {
      ipoc = value;
      continue;
    }
    (signal++)->text = value;
  }
  const std::size_t rest = learned_.size() - rest_;
  return static_cast<std::size_t>(end - at) == rest && takes(rest_, rest);
}

}  // namespace rsi
