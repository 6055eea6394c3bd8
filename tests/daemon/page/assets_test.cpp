#include "daemon/page/assets.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;

namespace {

const std::filesystem::path kAssets =
    std::filesystem::path(SWEEPD_SOURCE_DIR) / "daemon/page/assets";

}  // namespace

TEST_CASE("the program holds the page's files to the byte", "[assets]") {
  CHECK(sweepd::assets().size() > 10);
  std::size_t bytes = 0;
  for (const auto& asset : sweepd::assets()) {
    INFO(asset.path);
    REQUIRE(asset.path.starts_with("/assets/"));
    CHECK(asset.text == sweepd::test::content(kAssets / asset.path.substr(8)));
    bytes += asset.text.size();
  }
  CHECK(bytes < 150'000);  // of 200,000 that the program may grow by
}

TEST_CASE("uPlot is as its authors published it", "[assets]") {
  const auto folder = kAssets / "uplot";
  const auto readme = sweepd::test::content(folder / "README");
  CHECK_THAT(readme, ContainsSubstring("uPlot 1.6.32, MIT"));
  const auto command = "cd '" + folder.string() + "' && grep '^[0-9a-f]\\{64\\}  ' README | " +
                       "sha256sum --check --strict --quiet >/dev/null";
  CHECK(std::system(command.c_str()) == 0);
  for (const std::string file : {"uPlot.iife.min.js", "uPlot.min.css", "LICENSE"})
    CHECK_THAT(readme, ContainsSubstring("  " + file + "\n"));
  CHECK_THAT(sweepd::test::content(folder / "uPlot.iife.min.js"), ContainsSubstring("(v1.6.32)"));
}

TEST_CASE("the page takes nothing from elsewhere, and has no script or style within", "[assets]") {
  for (const auto& asset : sweepd::assets()) {
    if (asset.path.find("/uplot/") != asset.path.npos) continue;
    INFO(asset.path);
    const std::string text(asset.text);
    if (asset.type != "image/svg+xml") CHECK_THAT(text, !ContainsSubstring("http://"));
    CHECK_THAT(text, !ContainsSubstring("https://") && !ContainsSubstring("innerHTML") &&
                         !ContainsSubstring("eval(") && !ContainsSubstring("style=") &&
                         !ContainsSubstring("<script>"));
  }
}
