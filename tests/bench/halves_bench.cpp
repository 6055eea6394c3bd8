// Whether the uncertainties of real arms, and of simulated ones that bend, contain what halves of
// their sweeps differ by: a table of tests/acceptance/halves.hpp.

#include <algorithm>
#include <cmath>
#include <iostream>

#include <CLI/CLI.hpp>

#include "daemon/text/numbers.hpp"
#include "tests/acceptance/halves.hpp"
#include "tests/bench/table.hpp"

using acceptance::root_mean_square;
using bench::left;
using bench::right;

namespace {

void print(const std::string& arm, const std::string& what, const acceptance::Apart& apart) {
  double most = 0;
  for (const double z : apart.z) most = std::max(most, std::abs(z));
  std::cout << left(arm, 12) << left(what, 10) << right(static_cast<double>(apart.z.size()), 0, 8)
            << right(root_mean_square(apart.z), 2, 8) << right(most, 2, 8)
            << right(root_mean_square(apart.direction_deg), 4, 15)
            << right(root_mean_square(apart.place_mm), 4, 10) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Halves of real sweeps against each other");
  std::filesystem::path data = SWEEPD_ACCEPTANCE_DATA;
  app.add_option("DATA", data, "Folder that holds sweep-logs and sweep-logs-scene");
  CLI11_PARSE(app, argc, argv);
  std::cout << left("arm", 12) << left("what", 10) << right("numbers", 8) << right("rms z", 8)
            << right("most", 8) << right("angles deg", 15) << right("mm", 10)
            << "  (rms of the differences)\n";
  for (const auto& halves : acceptance::halves_apart(data)) {
    print(halves.arm, "axes", halves.axes);
    print(halves.arm, "a b alpha", halves.table);
  }
  for (const double sag_arcsec : {60.0, 300.0, 1500.0})
    for (const auto& halves : acceptance::sagging_halves_apart(sag_arcsec, 20))
      print("sim. " + halves.arm, "sag " + sweepd::fixed(sag_arcsec, 0) + "\"", halves.axes);
}
