#include "daemon/devices/device_text.hpp"

#include "daemon/devices/device_words.hpp"
#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using namespace sweepd;

TEST_CASE("lines come without their ends, and a tab at the end is a field", "[device_text]") {
  const DeviceText text("x",
                        "\xef\xbb\xbf"
                        "a\r\n\r\nb\t\n# c\n,,,\nend ");
  REQUIRE(text.lines() == 6);
  CHECK(text.line(0) == "a");
  CHECK(text.line(2) == "b\t");
  CHECK(text.line(5) == "end");
  CHECK(text.line(6).empty());
  CHECK(text.is_open());
  CHECK(text.is_passed_over(1));
  CHECK_FALSE(text.is_passed_over(2));
  CHECK(text.is_passed_over(3));
  CHECK(text.is_passed_over(4));
  CHECK_FALSE(DeviceText("x", "a\n").is_open());
  CHECK(DeviceText("x", "").lines() == 0);
}

TEST_CASE("fields stand between separators, without blanks and quotes", "[device_text]") {
  CHECK(fields_of("a, \"b, c\" ,,", ',') == Fields{"a", "b, c", "", ""});
  CHECK(fields_of("  a  b\tc ", ' ') == Fields{"a", "b", "c"});
  CHECK(fields_of("a\t\tb\t", '\t') == Fields{"a", "", "b", ""});
  CHECK(fields_of("\"a", ',') == Fields{"a"});
  CHECK(fields_of("\"a\"b,c", ',') == Fields{"a", "c"});
  CHECK(fields_of("\"a b\" c", ' ') == Fields{"a b", "c"});
  CHECK(fields_of("", ',') == Fields{""});
  CHECK(fields_of("", ' ').empty());
}

TEST_CASE("UTF-16 becomes UTF-8, and half a character is an error with its line", "[device_text]") {
  using namespace std::string_literals;
  const DeviceText text("x",
                        "\xff\xfe"s
                        "a\0\xb5\0\xac\x20\x3d\xd8\x00\xde\n\0"s);
  CHECK(text.line(0) == "a\xc2\xb5\xe2\x82\xac\xf0\x9f\x98\x80");
  for (const auto& bytes : {"\xff\xfe"s
                            "a\0\n\0b"s,
                            "\xff\xfe"s
                            "a\0\n\0\x3d\xd8"s,
                            "\xff\xfe"s
                            "a\0\n\0\x3d\xd8\x41\0"s,
                            "\xff\xfe"s
                            "a\0\n\0\0\xde"s,
                            "\xfe\xff"s
                            "\0a\0\n\xd8"s})
    CHECK_THROWS_WITH(DeviceText("x", bytes), ContainsSubstring("x: line 2: expected UTF-16 text"));
}

TEST_CASE("what is no UTF-8 is Latin-1, and becomes UTF-8", "[device_text]") {
  const auto text = [](const char* bytes) { return sweepd::as_utf8("x", bytes); };
  CHECK(text("20 \xb0"
             "C, gr\xfcn\n") ==
        "20 \xc2\xb0"
        "C, gr\xc3\xbcn\n");
  for (const char* utf8 : {"20 \xc2\xb0"
                           "C",
                           "\xe2\x82\xac 5", "\xf0\x9f\xa4\x96", "plain"})
    CHECK(text(utf8) == utf8);
  CHECK(text("cut within \xc2") == "cut within \xc2");
  for (const char* broken : {"\xc0\xaf", "\xe2\x82 5", "\xff", "\x80"})
    CHECK(text(broken) != broken);
}

TEST_CASE("dates are those of ISO, America and Germany", "[date_time]") {
  const double noon = *seconds_of_date("2024-03-14T12:00:00");
  CHECK(*seconds_of_date("2024-03-14 12:00:00.25") - noon == Approx(0.25));
  CHECK(*seconds_of_date("3/14/2024 12:00:01 PM") - noon == 1);
  CHECK(*seconds_of_date("03/14/2024 12:00 AM") - noon == -43200);
  CHECK(*seconds_of_date("14/03/2024 12:00:01") - noon == 1);
  CHECK(*seconds_of_date("14.03.2024 12:00:00,5") - noon == Approx(0.5));
  CHECK(*seconds_of_date("2024/03/15, 12:00:00") - noon == 86400);
  CHECK(*seconds_of_date("2024-03-14T12:00:00Z") == noon);
  CHECK(*seconds_of_date("2024-03-14T12:00:00+01:00") - noon == -3600);
  CHECK(*seconds_of_date("1:02:03.5") == Approx(3723.5));
  for (const char* text : {"", "2024-03-14", "2024-13-14 12:00:00", "2024-02-30 12:00:00",
                           "12:60:00", "25:00:00", "13:00:00 PM", "12:00:00 noon", "1710422553",
                           "2024-03-14 12:00:00.", "1:2:3:4", "-1:00:00"}) {
    INFO(text);
    CHECK_FALSE(seconds_of_date(text));
  }
}
