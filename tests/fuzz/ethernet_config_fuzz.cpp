// The controller's Ethernet file: whatever of it is accepted gives replies that a controller takes,
// and that move nothing.
#include <algorithm>

#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/reply.hpp"
#include "rsi/telegram/wire_layout.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;
using rsi::EthernetConfig;

namespace {

void check_list(const std::vector<EthernetConfig::Element>& list, int lines) {
  for (const auto& element : list) {
    expect(!element.tag.empty(), "a tag has a name");
    expect(element.index >= 0 && element.index <= 64, "INDX is a channel");
    expect(element.line >= 1 && element.line <= lines, "the line is one of the file");
  }
  const auto layout = rsi::wire_layout(list);
  expect(layout.empty() == list.empty(), "what is in the list goes over the wire");
  for (const auto& element : layout) {
    expect(!element.name.empty() && !element.fields.empty(), "elements have names and content");
    for (const auto& field : element.fields) expect(field.tag < list.size(), "fields have a tag");
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto xml = fuzz::text(data, size);
  EthernetConfig config;
  try {
    config = EthernetConfig::parse(xml, "eth.xml");
  } catch (const rsi::EthernetConfigError& error) {
    expect(std::string_view(error.what()).starts_with("eth.xml:"), "an error names the file");
    expect(fuzz::is_one_line(error.what()), "an error is one line");
    return 0;
  }
  for (const auto& warning : config.warnings) {
    expect(warning.starts_with("eth.xml:"), "a warning names the file");
    expect(fuzz::is_one_line(warning), "a warning is one line");
  }
  expect(config.port > 0, "there is a port");
  expect(config.only_send || !config.sentype.empty(), "replies have a type");
  const auto lines = 1 + static_cast<int>(std::count(xml.begin(), xml.end(), '\n'));
  check_list(config.send, lines);
  check_list(config.receive, lines);

  rsi::Reply reply(config);
  const auto read = rsi::ReplyCheck(config).read(reply.with_ipoc("18446744073709551615"));
  expect(read.malformed.empty(), "a reply is well-formed");
  expect(read.right_type, "a reply has the Type that the file wants");
  expect(read.ipoc == UINT64_MAX, "a reply echoes the IPOC");
  expect(read.missing.empty(), "a reply has every tag");
  expect(read.not_zero.empty(), "a reply corrects nothing");
  return 0;
}
