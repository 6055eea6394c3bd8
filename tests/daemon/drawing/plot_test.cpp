#include "daemon/drawing/plot.hpp"

#include <cmath>

#include "tests/catch.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::WithinAbs;

TEST_CASE("ticks are round, within the range, and about as many as asked for", "[plot]") {
  const auto apart = ticks({-13, 97}, 5);
  CHECK(apart == std::vector<double>{0, 50});
  for (const double size : {1e-6, 0.37, 12.0, 8.1e5})
    for (const double low : {-3.3, 0.0, 41.7}) {
      const Range range{low * size, low * size + size};
      const auto all = ticks(range, 5);
      CHECK(all.size() >= 2);
      CHECK(all.size() <= 11);
      for (const double tick : all) {
        CHECK(tick >= range.low - 1e-9 * size);
        CHECK(tick <= range.high + 1e-9 * size);
      }
    }
  CHECK(ticks({1, 1}, 5).empty());
  CHECK(ticks({0, INFINITY}, 5).empty());
}

TEST_CASE("no axis has one tick alone", "[plot]") {
  CHECK(ticks({-9, 9}, 1) == std::vector<double>{-5, 0, 5});
  CHECK(ticks({0.1, 1.4}, 3) == std::vector<double>{0.5, 1});
  for (int low = -40; low < 40; ++low)
    for (const double size : {1.0, 1.9, 4.9, 9.9})
      for (const std::size_t about : {1U, 2U, 3U, 5U})
        CHECK(ticks({0.1 * low, 0.1 * low + size}, about).size() >= 2);
}

TEST_CASE("ticks have as many decimals as tell them apart", "[plot]") {
  CHECK(tick_text(0.25, 0.05) == "0.25");
  CHECK(tick_text(200, 100) == "200");
  CHECK(tick_text(-1e-12, 0.5) == "0.0");
}

TEST_CASE("a logarithmic axis has figures also where it holds no power of ten", "[plot]") {
  pugi::xml_document document;
  Picture picture(Markup(document).add("div"), 200, 100, "a plot");
  const double low = std::log10(169.0), high = std::log10(600.0);
  const Plot plot(picture, {40, 10, 160, 70}, {{-1, 1}, "x", false, 0},
                  {.range = {low, high}, .title = "T²", .logarithmic = true});
  CHECK_THAT(html_text(document), ContainsSubstring(">200<") && ContainsSubstring(">600<"));
}

TEST_CASE("a plot puts its corners where the frame has them", "[plot]") {
  pugi::xml_document document;
  Picture picture(Markup(document).add("div"), 200, 100, "a plot");
  const Plot plot(picture, {20, 10, 160, 70}, {{-1, 1}, "x, mm", false, 5},
                  {{0, 10}, "y", false, 5});
  CHECK_THAT((plot.spot(-1, 0) - Spot(20, 80)).norm(), WithinAbs(0, 1e-9));
  CHECK_THAT((plot.spot(1, 10) - Spot(180, 10)).norm(), WithinAbs(0, 1e-9));
  CHECK_THAT(html_text(document), ContainsSubstring(">x, mm<"));
}

TEST_CASE("a range that holds nothing or one value still makes a plot", "[plot]") {
  CHECK(Range::nothing().empty());
  CHECK(Range::nothing().widened(0.1).size() > 0);
  CHECK(Range{5, 5}.widened(0.1).size() > 0);
  CHECK(Range{0, 0}.widened(0.1).size() > 0);
}
