#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Json = nlohmann::json;

namespace {

/// Writes a capture of the 90 degree set; returns what `simulate` says.
std::string simulate(const std::string& trace, const std::vector<std::string>& faults) {
  std::vector<std::string> arguments{"simulate",
                                     "--robot",
                                     (kConfig / "robots/kr5_arc.toml").string(),
                                     "--plan",
                                     (kConfig / "plans/kr5_arc_90deg.toml").string(),
                                     "--write",
                                     trace};
  arguments.insert(arguments.end(), faults.begin(), faults.end());
  const auto run = run_sweepd(arguments);
  INFO(run.errors);
  REQUIRE(run.code == 0);
  return run.out;
}

Json replay(const std::string& trace, const std::filesystem::path& output) {
  const auto run = run_sweepd({"replay", trace, "--config", (kConfig / "sweepd.toml").string(),
                               "--output", output.string(), "--quiet"});
  INFO(run.errors);
  REQUIRE(run.code == 0);
  return Json::parse(content(output / "result.json"));
}

/// The number behind `label` in a report.
std::uint64_t count(const std::string& report, const std::string& label) {
  const auto at = report.find(label);
  INFO(report);
  REQUIRE(at != std::string::npos);
  return std::stoull(report.substr(at + label.size()));
}

}  // namespace

TEST_CASE("a network that loses, doubles and swaps telegrams changes no sweep and hardly a number",
          "[faulty_network]") {
  const TemporaryFolder folder;
  const auto clean_trace = (folder / "clean.pcap").string();
  const auto faulty_trace = (folder / "faulty.pcap").string();
  simulate(clean_trace, {});
  const auto report = simulate(
      faulty_trace, {"--lose-percent", "1", "--duplicate-percent", "0.5", "--swap-percent", "0.5"});
  const auto clean = replay(clean_trace, folder / "clean");
  const auto faulty = replay(faulty_trace, folder / "faulty");

  const auto lost = count(report, "lost on purpose");
  const auto duplicated = count(report, "duplicated on purpose");
  const auto swapped = count(report, "swapped on purpose");
  // Of 11,068 telegrams: the rates within four standard deviations.
  CHECK(std::abs(static_cast<double>(lost) - 110.7) < 42);
  CHECK(std::abs(static_cast<double>(duplicated) - 55.3) < 30);
  CHECK(std::abs(static_cast<double>(swapped) - 55.3) < 30);
  const auto& source = faulty["source"];
  CHECK(source["lost"] == lost);
  CHECK(source["duplicated"] == duplicated);
  CHECK(source["reordered"] == swapped);
  CHECK(source["malformed"] == 0);
  CHECK(source["restarts"] == 0);
  CHECK(source["telegrams"] ==
        clean["source"]["telegrams"].get<std::uint64_t>() - lost + duplicated);

  CHECK(faulty["status"] == "complete");
  for (std::size_t j = 0; j < 6; ++j) {
    const auto& expected = clean["joints"][j]["sweeps"];
    const auto& found = faulty["joints"][j]["sweeps"];
    REQUIRE(found.size() == expected.size());
    for (std::size_t s = 0; s < expected.size(); ++s) {
      INFO("joint " << j + 1 << ", sweep " << s + 1);
      CHECK(found[s]["direction"] == expected[s]["direction"]);
      CHECK(found[s].contains("positioning") == expected[s].contains("positioning"));
      CHECK(found[s]["used"] == expected[s]["used"]);
      // At 60 deg/s, the plan's fastest, a cycle of 4 ms is 0.24 degrees.
      CHECK(found[s]["range_deg"].get<double>() ==
            Approx(expected[s]["range_deg"].get<double>()).margin(0.24));
    }
  }

  // Both have the same wobble in the samples that both have. Where 1.5 % of them differ, estimates
  // move by about sqrt(0.015) = 0.12 standard uncertainties: all of these within one is 8 sigma.
  int compared = 0;
  for (std::size_t j = 0; j < 6; ++j)
    for (const std::string name : {"b", "theta", "a", "alpha"}) {
      const std::string unit = name == "b" || name == "a" ? "_mm" : "_deg";
      const auto& row = clean["dh"][j];
      if (row[name + "_sigma" + unit].is_null()) continue;
      INFO(name << " of row " << j + 1);
      CHECK(std::abs(faulty["dh"][j][name + unit].get<double>() - row[name + unit].get<double>()) <
            row[name + "_sigma" + unit].get<double>());
      ++compared;
    }
  CHECK(compared == 19);  // five rows of four, but b of the parallel axes
}
