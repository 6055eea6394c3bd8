// The files of a campaign, as `history` reads them: result.json, run.json, link.json, currents.csv
// and notes.jsonl, one after the other with a line of -- between. Whatever they are, the record
// says why it tells no arm, and comes back from the index as it went in; whatever the index has is
// read or refused.
#include <array>
#include <exception>

#include "daemon/history/campaign_record.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest = fuzz::text(data, size);
  constexpr std::string_view kNext = "\n--\n";
  std::array<std::string, 5> texts;
  for (std::string& text : texts) {
    const auto end = rest.find(kNext);
    text = rest.substr(0, end);
    rest.remove_prefix(end == rest.npos ? rest.size() : end + kNext.size());
  }
  sweepd::CampaignTexts files;
  files.name = "campaign";
  files.result = texts[0];
  files.run = texts[1];
  files.link = texts[2];
  files.currents = texts[3];
  files.notes = texts[4];
  const auto record = sweepd::campaign_record(files);
  expect(record.arm.has_value() == record.why_not.empty(), "there is an arm, or a reason");
  expect(record.arm || fuzz::is_one_line(record.why_not), "the reason is a line");
  const auto bytes = sweepd::packed(record);
  expect(sweepd::packed(sweepd::unpacked(bytes.data(), bytes.size())) == bytes,
         "the index gives back what it got");

  try {
    static_cast<void>(sweepd::unpacked(data, size));
  } catch (const std::exception&) {
  }
  return 0;
}
