#include "daemon/drawing/picture.hpp"

#include <cmath>
#include <vector>

#include "tests/catch.hpp"

using namespace sweepd;
using Catch::Matchers::ContainsSubstring;

namespace {

/// What `draw` draws, as text.
template <typename Draw>
std::string drawn(const Draw& draw) {
  pugi::xml_document document;
  Picture picture(Markup(document).add("div"), 100, 50, "a test");
  draw(picture);
  return html_text(document);
}

}  // namespace

TEST_CASE("a path leaves out what nobody could tell apart, and has gaps", "[picture]") {
  const double gap = std::nan("");
  const std::vector<Spot> spots{{0, 0},   {0.1, 0}, {0.2, 0.1},  {10, 1.25},
                                {gap, 0}, {20, 0},  {30, -0.001}};
  const auto text = drawn([&](Picture& picture) { picture.path(spots, "l1"); });
  CHECK_THAT(text, ContainsSubstring("d=\"M0 0L10 1.25M20 0L30 0\""));
  CHECK_THAT(drawn([&](Picture& picture) { picture.path({}, "l1"); }), !ContainsSubstring("path"));
}

TEST_CASE("the end of a path is always drawn", "[picture]") {
  const std::vector<Spot> spots{{0, 0}, {5, 0}, {5.1, 0}};
  CHECK_THAT(drawn([&](Picture& picture) { picture.path(spots, "l1"); }),
             ContainsSubstring("M0 0L5 0L5.1 0"));
}

TEST_CASE("a picture says what it shows to who cannot see it", "[picture]") {
  CHECK_THAT(drawn([](Picture&) {}), ContainsSubstring("role=\"img\" aria-label=\"a test\""));
}

TEST_CASE("neighbouring joints differ in colour and in dash", "[picture]") {
  const auto style = drawing_style();
  CHECK(style.find('>') == std::string::npos);
  for (std::size_t joint = 0; joint + 1 < 7; ++joint) {
    const auto rule = [&](std::size_t index) {
      const auto at = style.find("." + joint_line(index) + "{");
      REQUIRE(at != std::string::npos);
      return style.substr(at, style.find('}', at) - at);
    };
    const auto dash = [&](std::size_t index) {
      const auto text = rule(index);
      return text.substr(text.find("dasharray"));
    };
    CHECK(rule(joint).substr(4) != rule(joint + 1).substr(4));
    CHECK(dash(joint) != dash(joint + 1));
  }
}
