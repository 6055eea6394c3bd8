// The paper's controller sent positions alone: nothing but their geometry tells the joints.

#include <fstream>
#include <iostream>

#include "tests/acceptance/acceptance.hpp"
#include "tests/acceptance/campaign.hpp"
#include "tests/catch.hpp"

using namespace acceptance;

namespace {

constexpr const char* kPositionsOnly = R"(<ROOT>
  <CONFIG>
    <IP_NUMBER>192.168.1.10</IP_NUMBER>
    <PORT>49152</PORT>
    <SENTYPE>ImFree</SENTYPE>
    <ONLYSEND>FALSE</ONLYSEND>
  </CONFIG>
  <SEND>
    <ELEMENTS>
      <ELEMENT TAG="DEF_RIst" TYPE="DOUBLE" INDX="INTERNAL" />
      <ELEMENT TAG="DEF_Delay" TYPE="LONG" INDX="INTERNAL" />
    </ELEMENTS>
  </SEND>
  <RECEIVE>
    <ELEMENTS>
      <ELEMENT TAG="DEF_EStr" TYPE="STRING" INDX="INTERNAL" />
    </ELEMENTS>
  </RECEIVE>
</ROOT>
)";

/// The results of all seeds; within bounds.
std::vector<nlohmann::json> check_positions_only(const std::string& plan, const Bounds& bounds,
                                                 bool plan_is_known) {
  const TemporaryFolder folder;
  const auto ethernet = folder / "positions_only.xml";
  std::ofstream(ethernet) << kPositionsOnly;
  auto results = replayed({plan, ethernet, plan_is_known});
  check_within(results, bounds);

  std::cout << plan << ", positions only, " << (plan_is_known ? "" : "not ")
            << "knowing the plan: the largest |identified - specified| of seeds 1 to " << kSeeds
            << "\n\n           row    largest  /std unc\n";
  for (const auto& deviation : deviations(results))
    std::cout << left(deviation.name, 10) << right(std::to_string(deviation.joint), 4)
              << right(deviation.worst, 5, 11) << right(deviation.worst / deviation.sigma, 2, 10)
              << '\n';
  std::cout << '\n';
  return results;
}

}  // namespace

TEST_CASE("Both sets are identified from positions and the plan's order alone",
          "[positions_only]") {
  for (const auto& result : check_positions_only("kr5_arc_90deg.toml", kBounds90, true))
    check_strokes(result, "kr5_arc_90deg.toml");
  for (const auto& result : check_positions_only("kr5_arc_30deg.toml", kBounds30, true))
    check_strokes(result, "kr5_arc_30deg.toml");
}

TEST_CASE("Without a plan, the robot description tells whose sweep is whose", "[positions_only]") {
  for (const auto& result : check_positions_only("kr5_arc_90deg.toml", kBounds90, false))
    CHECK_FALSE(result.contains("home_deg"));  // nothing tells an angle
}
