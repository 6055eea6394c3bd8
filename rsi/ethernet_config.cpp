#include "rsi/ethernet_config.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <sstream>
#include <system_error>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"
#include "rsi/endpoint.hpp"

namespace rsi {
namespace {

using Element = EthernetConfig::Element;

constexpr std::string_view kInternal = "DEF_";

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

std::optional<Element::Type> element_type(std::string_view text) {
  if (is_one_of(text, {"BOOL"})) return Element::Type::BOOL;
  if (is_one_of(text, {"STRING"})) return Element::Type::STRING;
  if (is_one_of(text, {"LONG"})) return Element::Type::LONG;
  if (is_one_of(text, {"DOUBLE"})) return Element::Type::DOUBLE;
  return std::nullopt;
}

std::vector<std::string> numbered(std::string_view prefix, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(std::string(prefix) + std::to_string(i));
  return names;
}

/// The attributes of an internal tag, given without its DEF_; none if it has none or is unknown.
std::vector<std::string> internal_attributes(std::string_view tag) {
  if (tag == "RIst" || tag == "RSol") return {"X", "Y", "Z", "A", "B", "C"};
  if (tag == "AIPos" || tag == "ASPos" || tag == "MACur") return numbered("A", 6);
  if (tag == "EIPos" || tag == "ESPos" || tag == "MECur") return numbered("E", 6);
  if (tag == "Delay") return {"D"};
  if (tag.size() == 7 && tag.starts_with("Tech.") && (tag[5] == 'C' || tag[5] == 'T') &&
      tag[6] >= '1' && tag[6] <= '6')
    return numbered(tag.substr(5), 10);
  return {};
}

/// What a tag is called on the wire, where the dot parts element and attribute.
std::string_view wire_name(std::string_view tag) {
  return tag.starts_with(kInternal) ? tag.substr(kInternal.size()) : tag;
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
  Reader(std::string_view xml, EthernetConfig& config) : xml_(xml), config_(config) {}

  void read();

 private:
  void read_config(const pugi::xml_node& section);
  std::vector<Element> read_list(const pugi::xml_node& section);
  Element read_element(const pugi::xml_node& node);
  void check_sent(const pugi::xml_node& section);

  /// The text of a key of <CONFIG>, which may stand there once; nothing if it is missing or empty.
  std::optional<std::string> value(const pugi::xml_node& config, const char* key);
  bool config_flag(const pugi::xml_node& config, const char* key);

  int line_of(std::ptrdiff_t offset) const {
    return 1 + static_cast<int>(std::count(xml_.begin(), xml_.begin() + offset, '\n'));
  }
  std::string position(std::ptrdiff_t offset) const {
    const auto before = xml_.substr(0, static_cast<std::size_t>(offset));
    const auto newline = before.find_last_of('\n');  // npos + 1 is 0
    return config_.name + ":" + std::to_string(line_of(offset)) + ":" +
           std::to_string(before.size() - (newline + 1)) + ": ";
  }
  void warn(const pugi::xml_node& node, const std::string& text) {
    config_.warnings.push_back(position(node.offset_debug()) + printable(text));
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& key,
                         const std::string& expected, std::string_view found) const {
    throw EthernetConfigError(position(node.offset_debug()) + key + ": expected " + expected +
                              ", found " +
                              (found.empty() ? "nothing" : "\"" + printable(found) + "\""));
  }

  std::string_view xml_;
  EthernetConfig& config_;
};

void Reader::read() {
  if (xml_.find('\0') != std::string_view::npos)
    throw EthernetConfigError(config_.name + ": expected ASCII or UTF-8 text, found zero bytes");
  pugi::xml_document document;
  const auto outcome =
      document.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!outcome)
    throw EthernetConfigError(
        position(std::min(outcome.offset, static_cast<std::ptrdiff_t>(xml_.size()))) +
        "expected an RSI Ethernet file in XML, found: " + outcome.description());

  const auto root = document.document_element();
  if (std::string_view(root.name()) != "ROOT") fail(root, "root element", "<ROOT>", root.name());
  for (const char* section : {"CONFIG", "SEND"})
    if (!root.child(section)) fail(root, section, "a section of this name in <ROOT>", "");

  read_config(root.child("CONFIG"));
  config_.send = read_list(root.child("SEND"));
  check_sent(root.child("SEND"));
  if (const auto receive = root.child("RECEIVE"))
    config_.receive = read_list(receive);
  else if (!config_.only_send)
    warn(root, "RECEIVE: this section is missing: replies will carry nothing but the IPOC");
}

std::optional<std::string> Reader::value(const pugi::xml_node& config, const char* key) {
  const auto node = config.child(key);
  if (const auto second = node.next_sibling(key)) fail(second, key, "this key once", "it again");
  const auto text = trimmed(node.text().get());
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
      warn(node, std::string(node.name()) + ": unknown key: not used");
}

std::vector<Element> Reader::read_list(const pugi::xml_node& section) {
  std::vector<Element> list;
  for (const auto& elements : section.children("ELEMENTS"))
    for (const auto& node : elements.children()) {
      if (node.type() != pugi::node_element) continue;
      if (std::string_view(node.name()) != "ELEMENT") {
        warn(node, std::string(node.name()) + ": expected ELEMENT: not used");
        continue;
      }
      auto element = read_element(node);
      const auto first = std::find_if(
          list.begin(), list.end(), [&](const Element& other) { return other.tag == element.tag; });
      if (first != list.end())
        warn(node, "TAG: \"" + element.tag + "\" stands in line " + std::to_string(first->line) +
                       " already: only the first counts");
      list.push_back(std::move(element));
    }
  return list;
}

Element Reader::read_element(const pugi::xml_node& node) {
  const auto attribute = [&](const char* key) { return trimmed(node.attribute(key).value()); };
  Element element;
  element.line = line_of(node.offset_debug());
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

  const bool named_internal = element.tag.starts_with(kInternal);
  if (named_internal != internal)
    warn(node,
         "INDX: expected INTERNAL for a tag that starts with DEF_, and a number for another: "
         "\"" +
             element.tag + "\"");
  if (named_internal && element.tag != "DEF_EStr" && internal_attributes(name).empty())
    warn(node, "TAG: \"" + element.tag + "\" is no internal tag known to sweepd");
  return element;
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
  if (!sends("DEF_RIst"))
    warn(section,
         "SEND: no DEF_RIst: without positions there is no identification, unless other "
         "tags carry them");
  if (!sends("DEF_AIPos"))
    warn(section,
         "SEND: no DEF_AIPos: without axis angles the joints are told apart by their "
         "order alone");
  if (!sends("DEF_Delay"))
    warn(section, "SEND: no DEF_Delay: the controller cannot say when a reply was late");
}

}  // namespace

EthernetConfig EthernetConfig::parse(std::string_view xml, std::string name) {
  EthernetConfig config;
  config.name = std::move(name);
  Reader(xml, config).read();
  return config;
}

EthernetConfig EthernetConfig::load(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream xml;
  xml << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || std::filesystem::is_directory(file))
    throw EthernetConfigError(file.string() +
                              ": cannot be read: " + std::generic_category().message(errno));
  return parse(xml.str(), file.string());
}

bool WireElement::has_text() const {
  return std::any_of(fields.begin(), fields.end(),
                     [](const Field& field) { return field.attribute.empty(); });
}

std::vector<WireElement> wire_layout(const std::vector<Element>& list) {
  std::vector<WireElement> layout;
  const auto add = [&](std::string_view name, WireElement::Field field) {
    auto element = std::find_if(layout.begin(), layout.end(),
                                [&](const WireElement& other) { return other.name == name; });
    if (element == layout.end())
      element = layout.insert(layout.end(), WireElement{std::string(name), {}});
    for (const auto& other : element->fields)
      if (other.attribute == field.attribute) return;
    element->fields.push_back(std::move(field));
  };
  for (std::size_t tag = 0; tag < list.size(); ++tag) {
    const auto name = wire_name(list[tag].tag);
    std::vector<std::string> attributes;
    if (name != list[tag].tag) attributes = internal_attributes(name);
    const auto dot = name.find('.');
    if (attributes.empty())
      attributes.emplace_back(dot == std::string_view::npos ? "" : name.substr(dot + 1));
    for (std::size_t i = 0; i < attributes.size(); ++i)
      add(name.substr(0, dot), {attributes[i], tag, i});
  }
  return layout;
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

}  // namespace rsi
