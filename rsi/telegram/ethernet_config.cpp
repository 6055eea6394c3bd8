#include "rsi/telegram/ethernet_config.hpp"

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"
#include "rsi/endpoint.hpp"
#include "rsi/file_bytes.hpp"
#include "rsi/telegram/text_positions.hpp"
#include "rsi/telegram/wire_layout.hpp"

namespace rsi {
namespace {

using Element = EthernetConfig::Element;

bool is_one_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return equal_ignoring_case(text, word); });
}

std::optional<bool> flag(std::string_view text) {
  if (is_one_of(text, {"TRUE", "1", "ON"})) return true;
  if (is_one_of(text, {"FALSE", "0", "OFF"})) return false;
  return std::nullopt;
}

std::optional<int> whole_number(std::string_view text, int lowest, int highest) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value >= lowest && value <= highest ? std::optional(value) : std::nullopt;
}

constexpr std::string_view kTypes[] = {"BOOL", "STRING", "LONG", "DOUBLE"};  // in Type's order

std::optional<Element::Type> element_type(std::string_view text) {
  for (std::size_t i = 0; i < std::size(kTypes); ++i)
    if (is_one_of(text, {kTypes[i]})) return static_cast<Element::Type>(i);
  return std::nullopt;
}

std::string type_text(Element::Type type) {
  return std::string(kTypes[static_cast<std::size_t>(type)]);
}

/// Whether `tag`, cut at its first dot, gives names that XML (with numbers allowed) can hold.
bool is_name(std::string_view tag) {
  return !tag.empty() && tag.front() != '.' && tag.back() != '.' &&
         tag.find_first_of("<>&\"'/=!?") == std::string_view::npos &&
         std::all_of(tag.begin(), tag.end(),
                     [](char c) { return static_cast<unsigned char>(c) > ' ' && c != 127; });
}

class Reader {
 public:
  Reader(std::string_view xml, EthernetConfig& config) : xml_(xml), text_(xml), config_(config) {}

  void read();

 private:
  bool is_understood(const pugi::xml_node& node, const std::string& name, bool received);
  void read_config(const pugi::xml_node& section);
  std::vector<Element> read_list(const pugi::xml_node& section);
  Element read_element(const pugi::xml_node& node);
  void check_internal(const pugi::xml_node& node, const Element& element);
  void check_received(const pugi::xml_node& node, const Element& element);
  void check_sent(const pugi::xml_node& section);

  /// The text of a key of <CONFIG>, which may stand there once; nothing if it is missing or empty.
  std::optional<std::string> value(const pugi::xml_node& config, const char* key);
  bool config_flag(const pugi::xml_node& config, const char* key);

  std::string position(std::ptrdiff_t offset) const {
    return config_.name + ":" + text_.position(offset) + ": ";
  }
  void warn(const pugi::xml_node& node, const std::string& text) {
    config_.warnings.push_back(position(node.offset_debug()) + printable(text));
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& key,
                         const std::string& expected, std::string_view found) const {
    throw EthernetConfigError(
        position(node.offset_debug()) + key + ": expected " + expected + ", found " +
        (found.empty() ? "nothing: add it" : "\"" + in_short(found) + "\": correct it") +
        ", here and on the controller");
  }

  std::string_view xml_;
  TextPositions text_;
  EthernetConfig& config_;
};

void Reader::read() {
  if (xml_.find('\0') != std::string_view::npos)
    throw EthernetConfigError(config_.name +
                              ": expected ASCII or UTF-8 text, found zero bytes: save it as UTF-8");
  pugi::xml_document document;
  const auto outcome =
      document.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!outcome)
    throw EthernetConfigError(
        position(outcome.offset) + "expected an RSI Ethernet file in XML, found: " +
        outcome.description() + ": correct it, or copy the file from the controller again");

  const auto root = document.document_element();
  if (std::string_view(root.name()) != "ROOT") fail(root, "root element", "<ROOT>", root.name());
  if (const auto more = root.next_sibling()) fail(more, "root element", "one", "another");
  for (const char* section : {"CONFIG", "SEND"})
    if (!root.child(section)) fail(root, section, "a section of this name in <ROOT>", "");

  for (const auto& section : root.children()) {
    if (section.type() != pugi::node_element) continue;
    const std::string_view name = section.name();
    if (name != "CONFIG" && name != "SEND" && name != "RECEIVE")
      fail(section, "<ROOT>", "the sections CONFIG, SEND and RECEIVE alone", name);
    if (section.previous_sibling(section.name()))
      fail(section, "<ROOT>", "each section once", name);
  }
  read_config(root.child("CONFIG"));
  config_.send = read_list(root.child("SEND"));
  check_sent(root.child("SEND"));
  if (const auto receive = root.child("RECEIVE"))
    config_.receive = read_list(receive);
  else if (!config_.only_send)
    warn(root, "RECEIVE: this section is missing: replies will carry nothing but the IPOC");
}

/// What is received and not understood may be a tag that moves the robot.
bool Reader::is_understood(const pugi::xml_node& node, const std::string& name, bool received) {
  if (node.name() == name) return true;
  const std::string found = *node.name() ? node.name() : node.value();
  if (received) fail(node, "<" + std::string(node.parent().name()) + ">", name + " alone", found);
  if (node.type() == pugi::node_element)
    warn(node, in_short(found) + ": expected " + name + ": not used");
  return false;
}

std::optional<std::string> Reader::value(const pugi::xml_node& config, const char* key) {
  const auto node = config.child(key);
  if (const auto second = node.next_sibling(key)) fail(second, key, "this key once", "it again");
  std::string text;
  for (const auto& part : node.children()) {  // a comment parts the text
    if (part.type() == pugi::node_element) fail(part, key, "text alone", in_short(part.name()));
    text += part.value();
  }
  text = trimmed(text);
  return text.empty() ? std::nullopt : std::optional<std::string>(text);
}

bool Reader::config_flag(const pugi::xml_node& config, const char* key) {
  const auto text = value(config, key);
  const auto on = flag(text.value_or("FALSE"));
  if (!on) fail(config.child(key), key, "TRUE or FALSE", *text);
  return *on;
}

void Reader::read_config(const pugi::xml_node& config) {
  config_.only_send = config_flag(config, "ONLYSEND");
  if (!value(config, "ONLYSEND"))
    warn(config, "ONLYSEND: expected TRUE or FALSE, found nothing: taken as FALSE");

  config_.ip_number = value(config, "IP_NUMBER").value_or("");
  if (!parse_address(config_.ip_number)) {
    const auto key = config.child("IP_NUMBER");
    warn(key ? key : config,
         "IP_NUMBER: expected the address of the machine that sweepd runs on, such as "
         "192.168.1.10, found \"" +
             config_.ip_number + "\": the controller cannot send there");
  }

  const auto port = value(config, "PORT");
  const auto port_number = whole_number(port.value_or(""), 1, 65535);
  if (!port_number)
    fail(config.child("PORT") ? config.child("PORT") : config, "PORT", "a number from 1 to 65535",
         port.value_or(""));
  config_.port = static_cast<std::uint16_t>(*port_number);

  config_.sentype = value(config, "SENTYPE").value_or("");
  if (config_.sentype.empty() && !config_.only_send)
    fail(config.child("SENTYPE") ? config.child("SENTYPE") : config, "SENTYPE",
         "the name that replies must carry, such as ImFree", "");

  const auto protocol = value(config, "PROTOCOL").value_or("UDP");
  if (!is_one_of(protocol, {"UDP", "TCP"}))
    fail(config.child("PROTOCOL"), "PROTOCOL", "UDP or TCP", protocol);
  if (is_one_of(protocol, {"TCP"})) config_.protocol = EthernetConfig::Protocol::TCP;
  config_.length_first = config_flag(config, "PROTCOLLENGTH");
  if (config_.length_first)
    warn(
        config.child("PROTCOLLENGTH"),
        config_.protocol == EthernetConfig::Protocol::TCP
            ? "PROTCOLLENGTH: On: how KUKA writes this length is not known for certain: if replies "
              "are not accepted, write Off here"
            : "PROTCOLLENGTH: On puts a length before each telegram: write Off here");

  constexpr std::string_view known[] = {"IP_NUMBER", "PORT",     "SENTYPE",
                                        "ONLYSEND",  "PROTOCOL", "PROTCOLLENGTH"};
  for (const auto& node : config.children())
    if (node.type() == pugi::node_element &&
        std::find(std::begin(known), std::end(known), node.name()) == std::end(known))
      warn(node, in_short(node.name()) + ": unknown key: not used");
}

std::vector<Element> Reader::read_list(const pugi::xml_node& section) {
  const bool received = std::string_view(section.name()) == "RECEIVE";
  std::vector<Element> list;
  std::unordered_map<std::string, int> line_of_tag;
  std::unordered_map<int, std::string> tag_of_channel;
  for (const auto& elements : section.children()) {
    if (!is_understood(elements, "ELEMENTS", received)) continue;
    for (const auto& node : elements.children()) {
      if (!is_understood(node, "ELEMENT", received)) continue;
      auto element = read_element(node);
      if (received && node.first_child()) fail(node, "ELEMENT", "attributes alone", "more in it");
      if (received) check_received(node, element);
      const auto [same, is_first] = line_of_tag.try_emplace(element.tag, element.line);
      if (!is_first)
        warn(node, "TAG: \"" + in_short(element.tag) + "\" stands in line " +
                       std::to_string(same->second) + " already: only the first counts");
      else if (const auto [other, is_free] = tag_of_channel.try_emplace(element.index, element.tag);
               !is_free && element.index != 0)
        warn(node, "INDX: channel " + std::to_string(element.index) + " is that of \"" +
                       in_short(other->second) + "\" already: give each tag a channel of its own");
      list.push_back(std::move(element));
    }
  }
  return list;
}

Element Reader::read_element(const pugi::xml_node& node) {
  const auto attribute = [&](const char* key) { return trimmed(node.attribute(key).value()); };
  for (auto one = node.first_attribute(); one; one = one.next_attribute())
    if (node.attribute(one.name()) != one)
      fail(node, one.name(), "this attribute once", "it again");
  Element element;
  element.line = text_.line(node.offset_debug());
  element.tag = attribute("TAG");
  const auto name = wire_name(element.tag);
  if (!is_name(name)) fail(node, "TAG", "a name without blanks or <>&\"'/=!?", element.tag);
  if (is_one_of(name.substr(0, name.find('.')), {"Rob", "Sen", "IPOC"}))
    fail(node, "TAG", "another name (telegrams and replies have Rob, Sen and IPOC of their own)",
         element.tag);

  const auto type = element_type(attribute("TYPE"));
  if (!type) fail(node, "TYPE", "BOOL, STRING, LONG or DOUBLE", attribute("TYPE"));
  element.type = *type;

  const bool internal = is_one_of(attribute("INDX"), {"INTERNAL"});
  const auto index = internal ? std::optional(0) : whole_number(attribute("INDX"), 1, 64);
  if (!index) fail(node, "INDX", "INTERNAL or a number from 1 to 64", attribute("INDX"));
  element.index = *index;

  const auto holdon = flag(node.attribute("HOLDON") ? attribute("HOLDON") : "0");
  if (!holdon) fail(node, "HOLDON", "0 or 1", attribute("HOLDON"));
  element.holdon = *holdon;

  check_internal(node, element);
  return element;
}

void Reader::check_internal(const pugi::xml_node& node, const Element& element) {
  const auto quoted = "\"" + in_short(element.tag) + "\"";
  if (is_internal(element.tag) != (element.index == 0))
    warn(node,
         "INDX: expected INTERNAL for a tag that starts with DEF_, and a number for another: " +
             quoted);
  const auto known = internal_tag(element.tag);
  if (!known) {
    if (is_internal(element.tag))
      warn(node, "TAG: " + quoted + " is no internal tag known to sweepd");
  } else if (known->type != element.type) {
    warn(node, "TYPE: expected " + type_text(known->type) + " for " + quoted + ", found " +
                   type_text(element.type) +
                   ": the controller may refuse it, or lose decimals; correct it");
  }
}

void Reader::check_received(const pugi::xml_node& node, const Element& element) {
  const auto known = internal_tag(element.tag);
  if (known && known->only_sent)
    warn(node, "TAG: \"" + in_short(element.tag) +
                   "\" is measured by the controller and cannot be received: take it out of "
                   "RECEIVE");
  if (element.tag == "DEF_Tech.T1" || element.tag == "DEF_Tech.C1")
    warn(node, "TAG: \"" + in_short(element.tag) +
                   "\" belongs to function generator 1, which RSI keeps for its own corrections: "
                   "the Ethernet object fails with RSIBad; take another, such as DEF_Tech.T2");
}

void Reader::check_sent(const pugi::xml_node& section) {
  const auto sends = [&](std::string_view tag) {
    return std::any_of(config_.send.begin(), config_.send.end(),
                       [&](const Element& element) { return element.tag == tag; });
  };
  if (config_.send.empty()) {
    warn(section, "SEND: the list is empty: telegrams will carry nothing but the IPOC");
    return;
  }
  const std::pair<const char*, const char*> wanted[] = {
      {"DEF_RIst", "without positions there is no identification, unless other tags carry them"},
      {"DEF_AIPos", "without axis angles the joints are told apart by their order alone"},
      {"DEF_Delay", "the controller cannot say when a reply was late"}};
  for (const auto& [tag, lack] : wanted)
    if (!sends(tag)) warn(section, std::string("SEND: no ") + tag + ": " + lack);
}

}  // namespace

EthernetConfig EthernetConfig::parse(std::string_view xml, std::string name) {
  EthernetConfig config;
  config.name = std::move(name);
  if (xml.size() > kMostBytes)
    throw EthernetConfigError(config.name +
                              ": expected an RSI Ethernet file of at most 1 MiB, found more: give "
                              "the file that lies on the controller");
  Reader(xml, config).read();
  return config;
}

EthernetConfig EthernetConfig::load(const std::filesystem::path& file) {
  return parse(file_bytes<EthernetConfigError>(file, kMostBytes), file.string());
}

std::vector<Element> EthernetConfig::commands() const {
  std::vector<Element> commands;
  std::unordered_set<std::string> seen;
  for (const Element& element : receive) {
    const auto known = internal_tag(element.tag);
    const bool is_text = element.type == Element::Type::STRING && element.index == 0 &&
                         (!known || known->type == Element::Type::STRING);
    if (!is_text && seen.insert(element.tag).second) commands.push_back(element);
  }
  return commands;
}

}  // namespace rsi
