// The telegram parser: what holds for any bytes, and beside pugixml for well-formed telegrams.
//
// Where the two differ on purpose, as no controller writes such things:
// - Entities stay as they are written: ours gives views into the datagram.
// - A value of an element is the text between its start tag and its end tag. Text that a comment or
//   an element interrupts (mixed content) is none, in both readings here.
// - <A/> is no signal and <A></A> an empty one. A tree does not tell these apart: elements without
//   attribute and text are left out on both sides.
// - DOCTYPE is skipped to the next '>', wherever that is: such input is not compared.
// - Nested elements are flattened; but the first </Rob> ends the telegram. Input with a second
// <Rob>
//   is not compared.
// - pugixml takes text and further elements beside the root: that is not well-formed.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/telegram.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;
using rsi::Defect;
using rsi::Signal;
using rsi::Telegram;

namespace {

bool is_empty(const Signal& signal) {
  return signal.attribute.empty() && signal.text.empty();
}

bool operator==(const Signal& a, const Signal& b) {
  return a.element == b.element && a.attribute == b.attribute && a.text == b.text;
}

/// What a well-formed telegram says, according to pugixml.
struct Reference {
  explicit Reference(std::string_view bytes) : source(bytes) {
    if (bytes.find('\0') != std::string_view::npos) return;  // no XML, though pugixml reads on
    constexpr unsigned kEverythingRaw = pugi::parse_fragment | pugi::parse_ws_pcdata |
                                        pugi::parse_comments | pugi::parse_cdata | pugi::parse_pi |
                                        pugi::parse_declaration | pugi::parse_doctype;
    if (!document.load_buffer(bytes.data(), bytes.size(), kEverythingRaw, pugi::encoding_utf8))
      return;
    const auto root = document.document_element();
    if (!rsi::equal_ignoring_case(root.name(), "Rob")) return;
    comparable = true;
    for (const auto& node : document.children()) {
      look_at(node);
      if (node.type() == pugi::node_pcdata && !rsi::trimmed(node.value()).empty())
        comparable = false;
      if (node.type() == pugi::node_element && node != root) comparable = false;
    }
    for (const auto& child : root.children()) walk(child);
  }

  std::string_view source;
  pugi::xml_document document;
  bool comparable = false;
  std::vector<Signal> signals;
  std::string_view ipoc_digits;

 private:
  void look_at(const pugi::xml_node& node) {
    const auto type = node.type();
    if (type == pugi::node_doctype) comparable = false;
  }

  void walk(const pugi::xml_node& node) {
    look_at(node);
    if (node.type() != pugi::node_element) return;
    const std::string_view name = node.name();
    if (rsi::equal_ignoring_case(name, "Rob")) comparable = false;
    for (const auto& attribute : node.attributes())
      signals.push_back({name, attribute.name(), attribute.value()});
    const auto first = node.first_child();
    const bool begins_with_text = first.type() == pugi::node_pcdata;
    const bool is_leaf = !first || (begins_with_text && !first.next_sibling());
    const auto text = rsi::trimmed(begins_with_text ? first.value() : "");
    if (rsi::equal_ignoring_case(name, "IPOC")) {
      if (is_leaf && text.size() <= 20 && rsi::ipoc_number(text)) ipoc_digits = text;
    } else if (is_leaf && !text.empty()) {
      signals.push_back({name, {}, text});
    }
    for (const auto& child : node.children()) walk(child);
  }
};

void check_any(std::string_view bytes, Telegram& telegram, Defect defect) {
  for (std::size_t i = 0; i < telegram.signals().size(); ++i) {
    const auto& [element, attribute, text] = telegram.signals()[i];
    expect(fuzz::is_inside(element, bytes) && fuzz::is_inside(attribute, bytes) &&
               fuzz::is_inside(text, bytes),
           "signals are views into the datagram");
    const auto first = telegram.find(element, attribute);
    expect(first && *first <= i, "a signal is found");
    const auto number = rsi::number(text);
    const auto decimal = rsi::decimal(text);
    expect(number.has_value() == decimal.has_value(), "both readings of numbers take the same");
    expect(!number || *number == decimal->value, "both readings of numbers agree");
    expect(!decimal || decimal->decimals >= 0, "decimals are counted");
  }
  const auto digits = rsi::find_ipoc(bytes);
  expect(fuzz::is_inside(digits, bytes) && digits.size() <= 20, "the IPOC is a view");
  expect(digits.find_first_not_of("0123456789") == std::string_view::npos, "the IPOC has digits");
  expect(telegram.ipoc() == rsi::ipoc_number(digits).value_or(0), "what is echoed was parsed");

  if (defect != Defect::none && defect != Defect::no_ipoc) return;
  const auto signals = telegram.signals().size();
  const auto ipoc = telegram.ipoc();
  static std::string longer;
  longer.assign(bytes).append(" \n\0\0", 4);
  expect(telegram.parse(longer) == defect && telegram.signals().size() == signals &&
             telegram.ipoc() == ipoc,
         "blanks and NULs behind a telegram change nothing");
  expect(rsi::find_ipoc(longer) == digits, "blanks and NULs behind change no IPOC");
}

/// What came before changes nothing: telegrams that differ from `bytes` in one place.
void check_next_ones(std::string_view bytes) {
  Telegram next;
  for (const std::string_view piece : {"", "7", "<", ">", "=", "\"", "'", " ", "-5", "<IPOC>"}) {
    static std::size_t at = 0;
    at = bytes.empty() ? 0 : (at + 7919) % bytes.size();
    std::string other(bytes);
    if (!bytes.empty()) other.replace(at, 1, piece);
    next.parse(bytes);
    const auto defect = next.parse(other);
    Telegram fresh;
    expect(
        fresh.parse(other) == defect && fresh.ipoc() == next.ipoc() &&
            std::equal(fresh.signals().begin(), fresh.signals().end(), next.signals().begin(),
                       next.signals().end(), [](const auto& a, const auto& b) { return a == b; }),
        "a telegram is read as if it were the first");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzz::text(data, size);
  static Telegram telegram;  // as in the program: one for all telegrams
  const auto defect = telegram.parse(bytes);
  check_next_ones(bytes);
  const Reference reference(bytes);
  if (reference.comparable) {
    expect(defect == (reference.ipoc_digits.empty() ? Defect::no_ipoc : Defect::none),
           "well-formed is understood");
    expect(rsi::find_ipoc(bytes) == reference.ipoc_digits, "the IPOC that is echoed");
    auto expected = reference.signals.begin();
    for (const auto& signal : telegram.signals()) {
      if (is_empty(signal)) continue;
      expect(expected != reference.signals.end() && signal == *expected, "the same signals");
      ++expected;
    }
    expect(expected == reference.signals.end(), "all signals");
  }
  check_any(bytes, telegram, defect);
  return 0;
}
