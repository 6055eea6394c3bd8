#include "daemon/drawing/markup.hpp"

#include "tests/catch.hpp"

using namespace sweepd;

TEST_CASE("a text is never markup, in elements and in attributes", "[markup]") {
  pugi::xml_document document;
  Markup html = Markup(document).add("html");
  html.put("p", "<script>alert(\"1\")</script> & 'x'", {{"title", "\"><script>"}});
  html.add("td");
  html.add("meta", {{"charset", "utf-8"}});
  CHECK(html_text(document) ==
        "<html><p title=\"&quot;>&lt;script>\">&lt;script&gt;alert(\"1\")&lt;/script&gt; "
        "&amp; 'x'</p><td></td><meta charset=\"utf-8\"></html>\n");
}

TEST_CASE("bytes that are no UTF-8 are replaced, control characters are blanks", "[markup]") {
  CHECK(clean_text("Gr\xC3\xB6\xC3\x9F"
                   "e \xE2\x82\xAC \xF0\x9F\x98\x80") ==
        "Gr\xC3\xB6\xC3\x9F"
        "e \xE2\x82\xAC \xF0\x9F\x98\x80");
  CHECK(clean_text("a\xFF"
                   "b") ==
        "a\xEF\xBF\xBD"
        "b");
  CHECK(clean_text("\xC0\xAF") == "\xEF\xBF\xBD\xEF\xBF\xBD");  // too long a form of '/'
  CHECK(clean_text("\xED\xA0\x80") == "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");  // a surrogate
  CHECK(clean_text("\xE2\x82") == "\xEF\xBF\xBD\xEF\xBF\xBD");                  // cut
  CHECK(clean_text(std::string_view("a\0b\x1B"
                                    "c\td\n",
                                    8)) == "a b c\td\n");
  CHECK(clean_text("") == "");
}
