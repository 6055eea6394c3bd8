#include <algorithm>
#include <sstream>

#include "daemon/results/result_formats.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/chain_outcomes.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd::test;
using sweepd::dh_latex;

namespace {

identify::DhNumber identified(double value, double sigma) {
  return {value, sigma, identify::Knowledge::identified};
}

}  // namespace

TEST_CASE("dh.tex has two digits of the 95 % interval, and the value to the same decimals",
          "[dh_latex]") {
  auto outcome = chain_outcome();
  auto& found = outcome.identification;
  found.dh[0].b_mm = identified(400.0112345, 0.0004);  // 1.96 x 0.0004 = 0.00078
  found.dh[0].alpha_rad = identified(sweepd::radians(89.99876), sweepd::radians(0.01));
  found.dh[2].b_mm = identified(-12.3, 7);  // 13.7
  const auto text = dh_latex(outcome);
  CHECK_THAT(text, ContainsSubstring(
                       "& $b_{1}$ (mm) & $400.01123 \\pm 0.00078$ & $400$ & $0.01123$ \\\\\n"));
  CHECK_THAT(text, ContainsSubstring(
                       "& $\\alpha_{1}$ (deg) & $89.999 \\pm 0.020$ & $90$ & $-0.001$ \\\\\n"));
  CHECK_THAT(text, ContainsSubstring("& $b_{3}$ (mm) & $-12 \\pm 14$ & $0$ & $-12$ \\\\\n"));
}

TEST_CASE("dh.tex marks what convention sets, and shows beta where axes are parallel",
          "[dh_latex]") {
  const auto text = dh_latex(chain_outcome());
  CHECK_THAT(text, ContainsSubstring("& $b_{2}$ (mm) & $0^{\\dagger}$ & $0$ & -- \\\\\n"));
  CHECK_THAT(text, ContainsSubstring("$\\beta_{2}$"));
  CHECK_THAT(text, !ContainsSubstring("$\\beta_{1}$"));
  CHECK_THAT(text, ContainsSubstring("Set by convention"));
}

TEST_CASE("every row of dh.tex has as many cells as the table columns", "[dh_latex]") {
  for (const bool compared : {true, false}) {
    auto outcome = chain_outcome();
    if (!compared) outcome.identification.specified.clear();
    const auto text = dh_latex(outcome);
    CHECK_THAT(text, ContainsSubstring(compared ? "{clrrr}" : "{clr}"));
    std::istringstream stream(text);
    int rows = 0;
    for (std::string line; std::getline(stream, line);) {
      if (line.find("\\\\") == std::string::npos || line.find("multicolumn") != std::string::npos)
        continue;
      INFO(line);
      CHECK(std::count(line.begin(), line.end(), '&') == (compared ? 4 : 2));
      CHECK(std::count(line.begin(), line.end(), '$') % 2 == 0);
      CHECK(std::count(line.begin(), line.end(), '{') == std::count(line.begin(), line.end(), '}'));
      ++rows;
    }
    CHECK(rows == 1 + 6 * 4 + 1);
  }
}
