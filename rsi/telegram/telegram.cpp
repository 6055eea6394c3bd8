#include "rsi/telegram/telegram.hpp"

#include <array>
#include <atomic>

#include "rsi/ascii.hpp"
#include "rsi/telegram/ipoc.hpp"

namespace rsi {
namespace {

/// Whether a name or a value without quotes ends here.
bool ends_name(char c) {
  static constexpr auto kEnds = [] {
    std::array<bool, 256> ends{};
    for (const char end : {' ', '\t', '\n', '\r', '=', '>', '/', '<', '"', '\''})
      ends[static_cast<unsigned char>(end)] = true;
    return ends;
  }();
  return kEnds[static_cast<unsigned char>(c)];
}

/// Walks through markup that need not be well-formed. Every function stops at the end of the data.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  [[nodiscard]] bool sees(std::string_view wanted) const { return rest_.starts_with(wanted); }

  bool take(char wanted) {
    if (rest_.empty() || rest_.front() != wanted) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
  }

  /// What stands before the next `end`, which is consumed too. False if there is none.
  bool take_until(std::string_view end, std::string_view& before) {
    const auto at = end.size() == 1 ? rest_.find(end.front()) : rest_.find(end);
    if (at == std::string_view::npos) {
      rest_ = {};
      return false;
    }
    before = rest_.substr(0, at);
    rest_.remove_prefix(at + end.size());
    return true;
  }

  /// The text up to the next tag, which is not consumed.
  std::string_view take_text() {
    const auto text = rest_.substr(0, rest_.find('<'));
    rest_.remove_prefix(text.size());
    return text;
  }

  /// A name of an element or attribute: all up to a blank or a character of the markup.
  std::string_view take_name() {
    std::size_t size = 0;
    while (size < rest_.size() && !ends_name(rest_[size])) ++size;
    const auto name = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return name;
  }

  /// Skips <?…?>, <!--…-->, <![CDATA[…]]> and <!…>. False if the data end inside, or if this is
  /// none of them.
  bool skip_declaration() {
    std::string_view ignored;
    if (sees("<?")) return take_until("?>", ignored);
    if (sees("<!--")) {
      rest_.remove_prefix(4);  // "<!-->" is a beginning and no end
      return take_until("-->", ignored);
    }
    if (sees("<![CDATA[")) return take_until("]]>", ignored);
    if (sees("<!")) return take_until(">", ignored);
    return false;
  }

 private:
  std::string_view rest_;
};

enum class Tag { open, closed_itself, cut };

/// The attributes of a start tag whose name was read, up to and with its end.
template <typename OnAttribute>
Tag read_attributes(Scanner& scanner, const OnAttribute& on_attribute) {
  while (!scanner.at_end()) {
    scanner.skip_blanks();
    if (scanner.take('>')) return Tag::open;
    if (scanner.take('/')) {
      if (scanner.take('>')) return Tag::closed_itself;
      continue;
    }
    if (scanner.sees("<")) return Tag::open;  // the '>' is missing: go on with the next tag
    const auto name = scanner.take_name();
    scanner.skip_blanks();
    if (!scanner.take('=')) {
      if (name.empty()) scanner.take('"') || scanner.take('\'');
      continue;
    }
    scanner.skip_blanks();
    std::string_view value;
    const std::string_view quote = scanner.sees("'") ? "'" : "\"";
    if (scanner.take(quote.front())) {
      if (!scanner.take_until(quote, value)) return Tag::cut;
    } else {
      value = scanner.take_name();
      if (scanner.at_end()) return Tag::cut;
    }
    on_attribute(name, value);
  }
  return Tag::cut;
}

bool blank(std::string_view datagram) {
  for (const char c : datagram)
    if (!is_blank(c) && c != '\0') return false;
  return true;
}

/// One number for each order of names, whichever object it was seen by.
std::uint64_t next_names() {
  static std::atomic<std::uint64_t> last = 0;
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

}  // namespace

std::string_view text(Defect defect) noexcept {
  switch (defect) {
    case Defect::none:
      return "none";
    case Defect::empty:
      return "empty";
    case Defect::not_a_telegram:
      return "not a telegram";
    case Defect::truncated:
      return "truncated";
    case Defect::no_ipoc:
      return "no IPOC";
  }
  return "";
}

Defect Telegram::parse(std::string_view datagram) {
  std::string_view digits;
  if (shape_.read(datagram, signals_, digits)) {
    ipoc_ = usable_ipoc(digits);
    names_ = shape_names_;
    if (ipoc_) return Defect::none;
  }
  shape_.signals_changed();
  digits = find_ipoc(datagram);
  ipoc_ = ipoc_number(digits);
  names_ = next_names();
  const Defect defect = scan(datagram);
  if (defect == Defect::none) {
    shape_.learn(datagram, signals_, digits);
    shape_names_ = names_;
  }
  return defect;
}

Defect Telegram::scan(std::string_view datagram) {
  signals_.clear();
  if (blank(datagram)) return Defect::empty;

  Scanner scanner(datagram);
  bool in_root = false;
  bool root_closed = false;
  while (!scanner.at_end() && !root_closed) {
    const auto between = scanner.take_text();
    if (!in_root && !blank(between) && !between.starts_with("\xef\xbb\xbf"))
      return Defect::not_a_telegram;
    if (scanner.at_end()) break;
    if (scanner.skip_declaration()) continue;
    if (!scanner.take('<')) break;
    if (scanner.take('/')) {
      std::string_view name;
      if (!scanner.take_until(">", name)) break;
      root_closed = equal_ignoring_case(trimmed(name), "Rob");
      continue;
    }
    const auto element = scanner.take_name();
    const bool is_ipoc = equal_ignoring_case(element, "IPOC");
    const bool is_root = !in_root;
    if (is_root) {
      // The first packet of old controllers may be nothing but an IPOC.
      if (!is_ipoc && !equal_ignoring_case(element, "Rob")) return Defect::not_a_telegram;
      in_root = true;
    }
    const std::size_t before = signals_.size();
    const Tag tag = read_attributes(scanner, [&](std::string_view name, std::string_view value) {
      if (!is_root) signals_.push_back({element, name, value});
    });
    if (tag == Tag::cut) break;
    if (tag == Tag::closed_itself) {
      if (is_root) root_closed = true;
      continue;
    }
    if (is_root && !is_ipoc) continue;
    // A leaf is an element whose text is followed by an end tag; that is left for the next round.
    const auto content = trimmed(scanner.take_text());
    if (!scanner.sees("</")) continue;
    if (is_ipoc) {
      if (is_root) root_closed = true;
    } else if (signals_.size() == before || !content.empty()) {
      signals_.push_back({element, {}, content});
    }
  }
  if (!in_root) return Defect::not_a_telegram;
  if (!root_closed) return Defect::truncated;
  return ipoc_ ? Defect::none : Defect::no_ipoc;
}

std::optional<std::size_t> Telegram::find(std::string_view element,
                                          std::string_view attribute) const noexcept {
  for (std::size_t i = 0; i < signals_.size(); ++i)
    if (signals_[i].attribute == attribute && signals_[i].element == element) return i;
  return std::nullopt;
}

void SignalPlace::look(const Telegram& telegram) noexcept {
  at_ = telegram.find(element_, attribute_);
  names_ = telegram.names();
}

}  // namespace rsi
