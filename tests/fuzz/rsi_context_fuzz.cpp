// The controller's RSI context: whatever of it is accepted speaks of channels that there are, and
// can be held against any Ethernet file.
#include "rsi/telegram/rsi_context.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;
using rsi::RsiContext;

namespace {

void check_lines(const std::vector<std::string>& lines) {
  for (const auto& line : lines) expect(fuzz::is_one_line(line), "a finding is one line");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  RsiContext context;
  try {
    context = RsiContext::parse(fuzz::text(data, size), "a.rsix");
  } catch (const rsi::RsiContextError& error) {
    expect(std::string_view(error.what()).starts_with("a.rsix:"), "an error names the file");
    expect(fuzz::is_one_line(error.what()), "an error is one line");
    return 0;
  }
  check_lines(context.warnings);
  for (const auto& warning : context.warnings)
    expect(warning.starts_with("a.rsix:"), "a warning names the file");
  expect(context.precision.value_or(0) >= 0, "decimals are counted");
  for (const int channel : context.fed) expect(channel >= 1 && channel <= 64, "a channel");
  for (const auto& receiver : context.receivers)
    expect(receiver.channel >= 1 && receiver.channel <= 64, "a channel");
  for (const auto& actor : context.actors)
    expect(!actor.path.empty() && fuzz::is_one_line(actor.path), "a way leads to each object");
  expect(context.warnings.size() >= context.actors.size(), "what can act is warned about");

  rsi::EthernetConfig ethernet;
  ethernet.name = "eth.xml";
  const auto alone = context.compare(ethernet);
  check_lines(alone);
  expect(alone.size() >= context.receivers.size(), "nothing is received, and that is said");
  for (int channel = 1; channel <= 64; ++channel)
    ethernet.receive.push_back({"tag", rsi::EthernetConfig::Element::Type::DOUBLE, channel});
  expect(context.compare(ethernet).size() <= 1, "all is received, but the name may differ");
  return 0;
}
