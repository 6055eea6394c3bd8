// Replies of any bytes, as a controller checks them. Beside pugixml: where a reply passes, an XML
// parser does not see a number other than zero in any tag that the controller takes either.
#include <utility>

#include <pugixml.hpp>

#include "rsi/ascii.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;
using Type = rsi::EthernetConfig::Element::Type;

namespace {

const rsi::EthernetConfig& config() {
  static const rsi::EthernetConfig config = [] {
    rsi::EthernetConfig made;
    made.sentype = "ImFree";
    for (const auto& [tag, type] : {std::pair("DEF_EStr", Type::STRING),
                                    {"RKorr.X", Type::DOUBLE},
                                    {"RKorr.Y", Type::DOUBLE},
                                    {"FREE", Type::LONG}})
      made.receive.push_back({tag, type, 1, false, 0});
    return made;
  }();
  return config;
}

bool is_correction(std::string_view text) {
  const auto number = rsi::number(text);
  return !number || *number != 0;
}

std::string all_text(const pugi::xml_node& node) {
  std::string text;
  for (const auto& child : node.children())
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
      text += child.value();
  return text;
}

struct Corrections : pugi::xml_tree_walker {
  bool for_each(pugi::xml_node& node) override {
    const std::string_view name = node.name();
    if (name == "RKorr")
      for (const char* axis : {"X", "Y"})
        if (const auto value = node.attribute(axis)) found = found || is_correction(value.value());
    if (name == "FREE") found = found || is_correction(all_text(node));
    return true;
  }
  bool found = false;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = fuzz::text(data, size);
  static const rsi::ReplyCheck check(config());
  const auto read = check.read(bytes);
  if (!read.malformed.empty()) {
    expect(read.sen_type.empty() && read.ipoc == 0 && !read.right_type, "the rest is unset");
    return 0;
  }
  expect(read.right_type == (read.sen_type == "ImFree"), "the type is compared to the letter");
  expect(bytes.find(std::to_string(read.ipoc)) != std::string_view::npos, "the IPOC is in there");
  if (!read.missing.empty() || !read.not_zero.empty()) return 0;

  pugi::xml_document document;
  if (!document.load_buffer(bytes.data(), bytes.size(), pugi::parse_default, pugi::encoding_utf8))
    return 0;
  Corrections corrections;
  document.traverse(corrections);
  expect(!corrections.found, "no correction is overlooked");
  return 0;
}
