// Whether the uncertainties of real arms contain what halves of their sweeps differ by.

#include "tests/acceptance/halves.hpp"

#include <iostream>

#include "tests/acceptance/acceptance.hpp"
#include "tests/catch.hpp"

using namespace acceptance;

TEST_CASE("Halves of real sweeps agree within their uncertainties", "[halves]") {
  const auto logs = real_data("sweep-logs");
  const auto scene = real_data("sweep-logs-scene");
  if (!logs || !scene) return;
  const auto arms = halves_apart(logs->parent_path());
  CHECK(arms.size() >= 2);
  for (const auto& [arm, axes, table] : arms) {
    INFO(arm);
    for (const Apart* apart : {&axes, &table}) {
      std::cout << arm << ": rms z " << root_mean_square(apart->z) << " of " << apart->z.size()
                << " numbers\n";
      CHECK(apart->z.size() > 5);
      CHECK(root_mean_square(apart->z) <= 1.5);
    }
  }
}

// Simulated arms, of which there may be many: real arms that are seen without noise are few.
TEST_CASE("Halves of arcs that weight bends agree within their uncertainties", "[halves]") {
  for (const double sag_arcsec : {300.0, 1500.0})
    for (const auto& [arm, axes, table] : sagging_halves_apart(sag_arcsec, 10)) {
      INFO(arm << ", " << sag_arcsec << " arcsec");
      CHECK(axes.z.size() >= 240);
      CHECK(root_mean_square(axes.z) <= 1.5);
    }
}
