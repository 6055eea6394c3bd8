#include "rsi/ipoc.hpp"

#include <string_view>

#include "tests/catch.hpp"

using rsi::find_ipoc;
using namespace std::string_view_literals;

TEST_CASE("the IPOC is found without a parse, wherever it stands and however it is written") {
  CHECK(find_ipoc("<Rob Type=\"KUKA\"><DiL>0</DiL><IPOC>1525084</IPOC></Rob>\n") == "1525084");
  CHECK(find_ipoc("<Rob><IPOC>7</IPOC><After>1</After></Rob>") == "7");
  CHECK(find_ipoc("<rob><ipoc>42</ipoc></rob>") == "42");
  CHECK(find_ipoc("<Rob>\r\n\t<IPOC>\n 123 </IPOC>\n</Rob>") == "123");
  CHECK(find_ipoc("<IPOC>18446744073709551615</IPOC>") == "18446744073709551615");
  CHECK(find_ipoc("<Rob><IPOC\t >8</IPOC></Rob>") == "8");
}

TEST_CASE("a telegram that no parser could read still gives its IPOC") {
  CHECK(find_ipoc("<Rob><GPIO 01=\"1\"/><X a=\"<<<\xff\x01<IPOC>99</IPOC>") == "99");
  CHECK(find_ipoc("\0\0garbage<IPOC>5</IPOC"sv) == "5");
}

TEST_CASE("what is no IPOC is not taken for one") {
  for (const auto* text :
       {"", "<", "IPOC", "<IPOC>", "<IPOC>12", "<IPOC></IPOC>", "<IPOC>-4</IPOC>",
        "<IPOC>1.5</IPOC>", "<IPOC>12 34</IPOC>", "<IPOCS>12</IPOCS>", "<IPOC X=\"1\">12</IPOC>",
        "<IPOC ", "<IPOC>123456789012345678901</IPOC>"})
    CHECK(find_ipoc(text).empty());
}

TEST_CASE("the digits of an IPOC are echoed as they came and read as 64 bits") {
  CHECK(find_ipoc("<IPOC>000123</IPOC>") == "000123");
  CHECK(rsi::ipoc_number("000123") == 123u);
  CHECK(rsi::ipoc_number("18446744073709551615") == 18446744073709551615u);
  CHECK_FALSE(rsi::ipoc_number("18446744073709551616"));
  CHECK_FALSE(rsi::ipoc_number(""));
}
