#include "daemon/report/report_facts.hpp"

#include <algorithm>

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using namespace sweepd;
using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("facts are taken as they are given, what is missing is empty", "[report_facts]") {
  const TemporaryFolder folder;
  const auto facts = read_facts(folder.write("facts.toml", "payload = \"2.3 kg, at 20 °C\"\n"));
  CHECK(facts.size() == no_facts().size());
  CHECK(std::count_if(facts.begin(), facts.end(),
                      [](const auto& fact) { return !fact.second.empty(); }) == 1);
  const auto payload =
      std::find(facts.begin(), facts.end(), ReportFacts::value_type("Payload", "2.3 kg, at 20 °C"));
  CHECK(payload != facts.end());
}

TEST_CASE("a fact that nobody knows is a mistake, with its line", "[report_facts]") {
  const TemporaryFolder folder;
  const auto file = folder.write("facts.toml", "operator = \"me\"\npaylaod = \"2 kg\"\n");
  CHECK_THROWS_WITH(read_facts(file),
                    ContainsSubstring("facts.toml:2") && ContainsSubstring("payload"));
  CHECK_THROWS_AS(read_facts(folder.write("number.toml", "payload = 5\n")), ConfigError);
}
