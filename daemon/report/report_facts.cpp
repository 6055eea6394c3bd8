#include "daemon/report/report_facts.hpp"

#include <array>
#include <string_view>

#include "daemon/settings/toml_table.hpp"

namespace sweepd {
namespace {

struct Fact {
  std::string_view key;
  const char* name;
};

constexpr std::array<Fact, 11> kFacts{{{"serial_number", "Serial number of the robot"},
                                       {"controller", "Controller and its software"},
                                       {"payload", "Payload"},
                                       {"temperature", "Temperature"},
                                       {"device", "Measuring device"},
                                       {"certificate", "Certificate of the device"},
                                       {"place", "Place"},
                                       {"date", "Date"},
                                       {"operator", "Operator"},
                                       {"customer", "Customer"},
                                       {"remarks", "Remarks"}}};

}  // namespace

ReportFacts no_facts() {
  ReportFacts facts;
  for (const Fact& fact : kFacts) facts.emplace_back(fact.name, "");
  return facts;
}

ReportFacts read_facts(const std::filesystem::path& file) {
  const auto table = TomlTable::load(file);
  std::vector<std::string_view> keys;
  keys.reserve(kFacts.size());
  for (const Fact& fact : kFacts) keys.push_back(fact.key);
  table.allow_only(keys);
  ReportFacts facts;
  for (const Fact& fact : kFacts)
    facts.emplace_back(fact.name, table.has(fact.key) ? table.text(fact.key) : "");
  return facts;
}

}  // namespace sweepd
