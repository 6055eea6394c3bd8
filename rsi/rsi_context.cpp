#include "rsi/rsi_context.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <sstream>
#include <system_error>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"

namespace rsi {
namespace {

constexpr int kLeastPrecision = 4;
constexpr std::size_t kMostBytes = 16 << 20;  // .rsix files with all blueprints have 0.1 MB

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// An attribute whatever its case: ObjID in one form is ObjId in the other.
std::string_view attribute(const pugi::xml_node& node, std::string_view name) {
  for (const auto& attribute : node.attributes())
    if (equal_ignoring_case(attribute.name(), name)) return attribute.value();
  return {};
}

bool is_named(const pugi::xml_node& node, std::string_view name) {
  return equal_ignoring_case(node.name(), name);
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  return node.find_child([&](const pugi::xml_node& each) { return is_named(each, name); });
}

bool moves_the_robot(std::string_view type) {
  constexpr std::array<std::string_view, 4> kMoving = {"AXISCORR", "AXISCORREXT", "POSCORR",
                                                       "MAP2OV_PRO"};
  return std::any_of(kMoving.begin(), kMoving.end(),
                     [&](std::string_view each) { return equal_ignoring_case(type, each); });
}

class Reader {
 public:
  Reader(std::string_view xml, RsiContext& context) : xml_(xml), context_(context) {}

  void read() {
    if (xml_.find('\0') != std::string_view::npos)
      fail(0, "expected ASCII or UTF-8 text, found zero bytes: give the .rsi.xml or .rsix");
    pugi::xml_document document;
    const auto result =
        document.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result)
      fail(result.offset,
           std::string("expected an RSI context in XML, found: ") + result.description());
    const auto root = document.document_element();
    pugi::xml_node objects = root;
    if (is_named(root, "RsiContext")) {
      context_.form = RsiContext::Form::rsix;
      objects = child(root, "RsiObjects");
    } else if (is_named(root, "rSIModel")) {
      fail(root.offset_debug(),
           "expected the context that the controller reads, found the editor's model: give the "
           ".rsi.xml beside it");
    } else if (!is_named(root, "RSIObjects")) {
      fail(root.offset_debug(), "expected <RSIObjects> or <RsiContext>, found <" +
                                    printable(root.name()) +
                                    ">: give the .rsi.xml (RSI 3) or .rsix (RSI 4 and later)");
    }
    const auto ethernet = find_ethernet(objects);
    read_parameters(ethernet);
    read_links(objects, ethernet);
  }

 private:
  pugi::xml_node find_ethernet(const pugi::xml_node& objects) {
    pugi::xml_node found;
    for (const auto& object : objects.children()) {
      if (!equal_ignoring_case(attribute(object, "ObjType"), "ETHERNET")) continue;
      if (found)
        warn(object, "a second Ethernet object: sweepd serves one; the first is checked");
      else
        found = object;
    }
    if (!found)
      fail(objects.offset_debug(),
           "expected an object of type ETHERNET, found none: add one, it is what sends");
    return found;
  }

  void read_parameters(const pugi::xml_node& ethernet) {
    for (const auto& parameter : child(ethernet, "Parameters").children()) {
      const auto name = attribute(parameter, "Name");
      const auto value = attribute(parameter, "ParamValue");
      if (equal_ignoring_case(name, "ConfigFile"))
        context_.config_file = std::string(value);
      else if (equal_ignoring_case(name, "Precision"))
        context_.precision = read_number(parameter, name, value);
      else if (equal_ignoring_case(name, "Timeout"))
        context_.timeout = read_number(parameter, name, value);
    }
    if (context_.config_file.empty()) warn(ethernet, "ConfigFile: not set: name the Ethernet file");
    if (context_.precision.value_or(1) < kLeastPrecision)
      warn(ethernet, "Precision: expected 4 or more, found " +
                         (context_.precision ? std::to_string(*context_.precision)
                                             : std::string("nothing, which is 1")) +
                         ": positions come rounded, which ruins the identification; set it to 4");
  }

  std::optional<int> read_number(const pugi::xml_node& node, std::string_view name,
                                 std::string_view value) {
    const auto number = whole_number(value);
    if (!number || *number < 0)
      fail(node.offset_debug(), std::string(name) + ": expected a whole number, found \"" +
                                    printable(value) + "\": correct it");
    return number;
  }

  void read_links(const pugi::xml_node& objects, const pugi::xml_node& ethernet) {
    const auto ethernet_id = attribute(ethernet, "ObjID");
    const int first = context_.form == RsiContext::Form::xml ? 1 : 0;
    for (const auto& input : child(ethernet, "Inputs").children())
      context_.fed.push_back(channel(input, "InIdx", first));
    for (const auto& object : objects.children())
      for (const auto& input : child(object, "Inputs").children()) {
        if (attribute(input, "OutObjID") != ethernet_id) continue;
        const std::string type(attribute(object, "ObjType"));
        context_.receivers.push_back({type, std::string(attribute(object, "ObjID")),
                                      channel(input, "OutIdx", first), moves_the_robot(type),
                                      position(input.offset_debug())});
        if (context_.receivers.back().moves)
          warn(input, printable(type) +
                          " takes what is received and can move the robot: sweepd sends zeros "
                          "alone; leave the object out");
      }
  }

  int channel(const pugi::xml_node& input, std::string_view name, int first) {
    const auto index = whole_number(attribute(input, name));
    if (!index || *index < first || *index >= first + 64)
      fail(input.offset_debug(), std::string(name) + ": expected a channel from " +
                                     std::to_string(first) + " to " + std::to_string(first + 63) +
                                     ", found \"" + printable(attribute(input, name)) +
                                     "\": correct it");
    return *index - first + 1;
  }

  [[nodiscard]] std::string position(std::ptrdiff_t offset) const {
    offset = std::clamp<std::ptrdiff_t>(offset, 0, static_cast<std::ptrdiff_t>(xml_.size()));
    const auto before = xml_.substr(0, static_cast<std::size_t>(offset));
    const auto newline = before.find_last_of('\n');  // npos + 1 is 0
    return context_.name + ":" +
           std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
           std::to_string(std::max<std::size_t>(before.size() - (newline + 1), 1)) + ": ";
  }
  void warn(const pugi::xml_node& node, const std::string& text) {
    context_.warnings.push_back(position(node.offset_debug()) + text);
  }
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& text) const {
    throw RsiContextError(position(offset) + text);
  }

  std::string_view xml_;
  RsiContext& context_;
};

}  // namespace

RsiContext RsiContext::parse(std::string_view xml, std::string name) {
  RsiContext context;
  context.name = std::move(name);
  if (xml.size() > kMostBytes)
    throw RsiContextError(context.name + ": expected an RSI context, found " +
                          std::to_string(xml.size()) + " bytes: give the .rsi.xml or .rsix");
  Reader(xml, context).read();
  return context;
}

RsiContext RsiContext::load(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream xml;
  xml << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || std::filesystem::is_directory(file))
    throw RsiContextError(file.string() + ": cannot be read: " +
                          std::generic_category().message(errno) + ": correct the path");
  return parse(xml.str(), file.string());
}

std::vector<std::string> RsiContext::compare(const EthernetConfig& config) const {
  std::vector<std::string> findings;
  const auto file = std::filesystem::path(config.name).filename().string();
  if (!config_file.empty() && !equal_ignoring_case(config_file, file))
    findings.push_back(name + ": ConfigFile: expected " + file +
                       " as in ethernet_config of sweepd, found " + printable(config_file) +
                       ": give sweepd the file that the controller reads");
  const auto has = [](const std::vector<EthernetConfig::Element>& list, int index) {
    return std::any_of(list.begin(), list.end(),
                       [&](const auto& element) { return element.index == index; });
  };
  for (const auto& element : config.send)
    if (element.index != 0 && std::find(fed.begin(), fed.end(), element.index) == fed.end())
      findings.push_back(config.name + ":" + std::to_string(element.line) + ": " +
                         printable(element.tag) + ": nothing feeds input " +
                         std::to_string(element.index) + " of the Ethernet object in " + name +
                         ": link it there, or leave the tag out");
  for (const auto& receiver : receivers)
    if (!has(config.receive, receiver.channel))
      findings.push_back(receiver.position + printable(receiver.id) + " takes channel " +
                         std::to_string(receiver.channel) + ", which no tag in RECEIVE of " +
                         config.name +
                         " fills: the controller refuses the context; add the tag, "
                         "or take the link out");
  return findings;
}

}  // namespace rsi
