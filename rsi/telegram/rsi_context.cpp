#include "rsi/telegram/rsi_context.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"
#include "rsi/file_bytes.hpp"
#include "rsi/telegram/rsi_object.hpp"
#include "rsi/telegram/text_positions.hpp"

namespace rsi {
namespace {

constexpr int kLeastPrecision = 4;
constexpr std::size_t kMostContextBytes = 16 << 20;  // .rsix files with all blueprints have 0.1 MB
constexpr std::size_t kMostObjects = 10'000;

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

class ContextReader {
 public:
  ContextReader(std::string_view xml, RsiContext& context)
      : xml_(xml), text_(xml), context_(context) {}

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
    if (is_named(root, "RsiContext"))
      context_.form = RsiContext::Form::rsix;
    else if (is_named(root, "rSIModel"))
      fail(root.offset_debug(),
           "expected the context that the controller reads, found the editor's model: give the "
           ".rsi.xml beside it");
    else if (!is_named(root, "RSIObjects"))
      fail(root.offset_debug(), "expected <RSIObjects> or <RsiContext>, found <" +
                                    in_short(root.name()) +
                                    ">: give the .rsi.xml (RSI 3) or .rsix (RSI 4 and later)");
    find_objects(root);
    const auto ethernet = find_ethernet(root);
    read_parameters(ethernet);
    read_links(ethernet);
    name_actors();
  }

 private:
  struct Object {
    pugi::xml_node node;
    std::string_view type, type_id, id;
  };

  /// Wherever they stand: an .rsix may group them.
  void find_objects(const pugi::xml_node& root) {
    struct Walker : pugi::xml_tree_walker {
      std::vector<Object>* objects = nullptr;
      bool for_each(pugi::xml_node& node) override {
        if (is_named(node, "RSIObject") || !attribute(node, "ObjType").empty())
          objects->push_back({node, attribute(node, "ObjType"), attribute(node, "ObjTypeID"),
                              attribute(node, "ObjID")});
        return objects->size() <= kMostObjects;
      }
    } walker;
    walker.objects = &objects_;
    pugi::xml_node(root).traverse(walker);
    if (objects_.size() > kMostObjects)
      fail(root.offset_debug(), "expected at most " + std::to_string(kMostObjects) +
                                    " objects, found more: give the .rsi.xml or .rsix");
    for (const Object& object : objects_)
      if (!flow_.add(object.id, is_ethernet(object.type, object.type_id)))
        warn(object.node, "\"" + in_short(object.id) +
                              "\" is the name of another object already: give each its own");
  }

  pugi::xml_node find_ethernet(const pugi::xml_node& root) {
    pugi::xml_node found;
    for (const Object& object : objects_) {
      if (!is_ethernet(object.type, object.type_id)) continue;
      if (found)
        warn(object.node, "a second Ethernet object: sweepd serves one; the first is checked");
      else
        found = object.node;
    }
    if (!found)
      fail(root.offset_debug(),
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
      warn(ethernet,
           "Precision: expected 4 or more, found " +
               (context_.precision ? std::to_string(*context_.precision)
                                   : std::string("nothing, which is 1")) +
               ": positions come rounded; with 1 decimal a simulated KR 5 arc was identified to "
               "0.03 mm and 0.003°, with 4 to 0.0001 mm and 0.00001°; set it to 4");
  }

  std::optional<int> read_number(const pugi::xml_node& node, std::string_view name,
                                 std::string_view value) {
    const auto number = whole_number(value);
    if (!number || *number < 0)
      fail(node.offset_debug(), std::string(name) + ": expected a whole number, found \"" +
                                    in_short(value) + "\": correct it");
    return number;
  }

  void read_links(const pugi::xml_node& ethernet) {
    const int first = context_.form == RsiContext::Form::xml ? 1 : 0;
    const auto ethernet_index = flow_.of(attribute(ethernet, "ObjID"));
    std::array<bool, 65> fed{};
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const Object& object = objects_[i];
      for (const auto& input : child(object.node, "Inputs").children()) {
        if (input.type() != pugi::node_element) continue;
        if (object.node == ethernet) {
          const int to = channel(input, "InIdx", first);
          if (!std::exchange(fed[static_cast<std::size_t>(to)], true)) context_.fed.push_back(to);
        }
        const auto source = attribute(input, "OutObjID");
        const auto from = flow_.of(source);
        if (from == SignalFlow::none) {
          warn(input, in_short(object.id) + " takes a signal of \"" + in_short(source) +
                          "\", which is no object here: correct the link");
          continue;
        }
        flow_.link(from, i);
        if (from == ethernet_index)
          context_.receivers.push_back({std::string(object.type), std::string(object.id),
                                        channel(input, "OutIdx", first),
                                        position(input.offset_debug())});
      }
    }
    flow_.trace();
  }

  void name_actors() {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const Object& object = objects_[i];
      const RsiEffect effect = rsi_effect(object.type, object.type_id);
      if (effect == RsiEffect::none) continue;
      context_.actors.push_back(
          {std::string(object.type), std::string(object.id), effect, flow_.path(i)});
      warn(object.node, flow_.name(i) + " (" + in_short(object.type) + ") " +
                            std::string(text(effect)) +
                            (flow_.is_fed(i) ? ", fed by " + flow_.path(i) : ", fed by nothing") +
                            ": leave it out, an identification needs no such object");
    }
  }

  int channel(const pugi::xml_node& input, std::string_view name, int first) {
    const auto index = whole_number(attribute(input, name));
    if (!index || *index < first || *index >= first + 64)
      fail(input.offset_debug(), std::string(name) + ": expected a channel from " +
                                     std::to_string(first) + " to " + std::to_string(first + 63) +
                                     ", found \"" + in_short(attribute(input, name)) +
                                     "\": correct it");
    return *index - first + 1;
  }

  [[nodiscard]] std::string position(std::ptrdiff_t offset) const {
    return context_.name + ":" + text_.position(offset) + ": ";
  }
  void warn(const pugi::xml_node& node, const std::string& text) {
    context_.warnings.push_back(position(node.offset_debug()) + text);
  }
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& text) const {
    throw RsiContextError(position(offset) + text);
  }

  std::string_view xml_;
  TextPositions text_;
  RsiContext& context_;
  std::vector<Object> objects_;  // as long as the document
  SignalFlow flow_;
};

}  // namespace

RsiContext RsiContext::parse(std::string_view xml, std::string name) {
  RsiContext context;
  context.name = std::move(name);
  if (xml.size() > kMostContextBytes)
    throw RsiContextError(context.name +
                          ": expected an RSI context of at most 16 MiB, found more: give the "
                          ".rsi.xml or .rsix");
  ContextReader(xml, context).read();
  return context;
}

RsiContext RsiContext::load(const std::filesystem::path& file) {
  return parse(file_bytes<RsiContextError>(file, kMostContextBytes), file.string());
}

std::vector<std::string> RsiContext::compare(const EthernetConfig& config) const {
  std::vector<std::string> findings;
  const auto file = std::filesystem::path(config.name).filename().string();
  if (!config_file.empty() && !equal_ignoring_case(config_file, file))
    findings.push_back(name + ": ConfigFile: expected " + file +
                       " as in ethernet_config of sweepd, found " + printable(config_file) +
                       ": give sweepd the file that the controller reads");
  std::array<bool, 65> received{};
  for (const auto& element : config.receive)
    if (element.index > 0 && element.index <= 64)
      received[static_cast<std::size_t>(element.index)] = true;
  for (const auto& element : config.send)
    if (element.index != 0 && std::find(fed.begin(), fed.end(), element.index) == fed.end())
      findings.push_back(config.name + ":" + std::to_string(element.line) + ": " +
                         in_short(element.tag) + ": nothing feeds input " +
                         std::to_string(element.index) + " of the Ethernet object in " + name +
                         ": link it there, or leave the tag out");
  for (const auto& receiver : receivers)
    if (!received[static_cast<std::size_t>(receiver.channel)])
      findings.push_back(receiver.position + in_short(receiver.id) + " takes channel " +
                         std::to_string(receiver.channel) + ", which no tag in RECEIVE of " +
                         config.name +
                         " fills: the controller refuses the context; add the tag, "
                         "or take the link out");
  return findings;
}

}  // namespace rsi
