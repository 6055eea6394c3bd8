#include "rsi/telegram/ipoc.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <random>
#include <string>
#include <string_view>

#include "rsi/telegram/telegram.hpp"
#include "tests/catch.hpp"

using rsi::find_ipoc;
using namespace std::string_view_literals;

TEST_CASE("the IPOC is found without a parse, wherever it stands and however it is written",
          "[ipoc]") {
  CHECK(find_ipoc("<Rob Type=\"KUKA\"><DiL>0</DiL><IPOC>1525084</IPOC></Rob>\n") == "1525084");
  CHECK(find_ipoc("<Rob><IPOC>7</IPOC><After>1</After></Rob>") == "7");
  CHECK(find_ipoc("<rob><ipoc>42</ipoc></rob>") == "42");
  CHECK(find_ipoc("<Rob>\r\n\t<IPOC>\n 123 </IPOC>\n</Rob>") == "123");
  CHECK(find_ipoc("<IPOC>18446744073709551615</IPOC>") == "18446744073709551615");
  CHECK(find_ipoc("<Rob><IPOC\t >8</IPOC></Rob>") == "8");
}

TEST_CASE("a telegram that no parser could read still gives its IPOC", "[ipoc]") {
  CHECK(find_ipoc("<Rob><GPIO 01=\"1\"/><X a=\"<<<\xff\x01<IPOC>99</IPOC>") == "99");
  CHECK(find_ipoc("\0\0garbage<IPOC>5</IPOC"sv) == "5");
}

TEST_CASE("what is no IPOC is not taken for one", "[ipoc]") {
  for (const auto* text :
       {"", "<", "IPOC", "<IPOC>", "<IPOC>12", "<IPOC></IPOC>", "<IPOC>-4</IPOC>",
        "<IPOC>1.5</IPOC>", "<IPOC>12 34</IPOC>", "<IPOCS>12</IPOCS>", "<IPOC/>12</IPOC>", "<IPOC ",
        "<IPOC>123456789012345678901</IPOC>", "<IPOC>18446744073709551616</IPOC>",
        "<IPOC>1<A/></IPOC>", "<IPOC>1<!-- -->2</IPOC>", "<!-- <IPOC>5</IPOC> -->",
        "<X a='<IPOC>5</IPOC>'/>"}) {
    CAPTURE(text);
    CHECK(find_ipoc(text).empty());
  }
}

TEST_CASE("the IPOC that is echoed is the one that is parsed", "[ipoc][issue11][point_19]") {
  const auto rob = [](const std::string& inner) {
    return "<Rob Type=\"KUKA\"><IPOC>5</IPOC>" + inner + "</Rob>\n";
  };
  const auto check = [](const std::string& text, std::string_view digits) {
    CAPTURE(text);
    rsi::Telegram telegram;
    telegram.parse(text);
    CHECK(find_ipoc(text) == digits);
    CHECK(telegram.ipoc() == rsi::ipoc_number(digits).value_or(0));
  };
  for (const auto* hidden :
       {"<!-- <IPOC>6</IPOC> -->", "<![CDATA[<IPOC>6</IPOC>]]>", "<![CDATA[>]]x><IPOC>6</IPOC>]]>",
        "<A x=\"<IPOC>6</IPOC>\"/>", "<A x = '><IPOC>6</IPOC>'></A>", "<?a <IPOC>6</IPOC> ?>",
        "<A>it's</A>", "<IPOC>6<B/></IPOC>", "<IPOC>99999999999999999999</IPOC>"})
    check(rob(hidden), "5");
  check(rob("<IPOC a=\"1\">6</IPOC>"), "6");
  check(rob("<A>it's<IPOC>6</IPOC>'</A>"), "6");
  check(rob("") + rob("<IPOC>6</IPOC>"), "6");
  // Damaged: what has no end hides nothing, and what can be answered is answered.
  for (const auto* damaged : {"<A x=\"1><IPOC>6</IPOC>", "<!-- <IPOC>6</IPOC>", "<? <IPOC>6</IPOC>",
                              "<![CDATA[<IPOC>6</IPOC>", "<A <<<< B <IPOC 6>6</IPOC"})
    check("<Rob>" + std::string(damaged), "6");
}

TEST_CASE("of any bytes, what is echoed and what is parsed are the same",
          "[ipoc][issue11][point_19]") {
  // Pieces of markup at random; seed 19.
  constexpr const char* kPieces[] = {"<IPOC>8</IPOC>",
                                     "<IPOC>",
                                     "</IPOC>",
                                     "5",
                                     "67",
                                     "<Rob>",
                                     "</Rob>",
                                     "<!--",
                                     "-->",
                                     "<?",
                                     "?>",
                                     "\"",
                                     "'",
                                     "=",
                                     "<A x=\"",
                                     "\"/>",
                                     "<IPOC ",
                                     "/>",
                                     ">",
                                     "<",
                                     " ",
                                     "]]>",
                                     "</",
                                     "text",
                                     "<!",
                                     "\xff",
                                     "<![CDATA["};
  std::mt19937_64 random(19);
  rsi::Telegram telegram;
  int found = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::string text;
    for (auto pieces = random() % 20; pieces > 0; --pieces)
      text += kPieces[random() % std::size(kPieces)];
    telegram.parse(text);
    const auto digits = find_ipoc(text);
    found += !digits.empty();
    if (telegram.ipoc() != rsi::ipoc_number(digits).value_or(0)) FAIL(text);
    // Behind this byte no IPOC is plain: the whole rule is walked.
    if (find_ipoc(text + "?") != digits) FAIL(text);
  }
  CHECK(found > 200);
}

TEST_CASE("the search for an IPOC takes time by the size alone, whatever the bytes are",
          "[ipoc][issue11][point_19]") {
  const auto took = [](const std::string& piece) {
    std::string text;
    while (text.size() < 60'000) text += piece;
    auto best = std::chrono::nanoseconds::max();
    for (int round = 0; round < 5; ++round) {
      const auto start = std::chrono::steady_clock::now();
      CHECK(find_ipoc(text).empty());
      best = std::min<std::chrono::nanoseconds>(best, std::chrono::steady_clock::now() - start);
    }
    return best;
  };
  // A search to the end from each would take thousands of times as long.
  const auto plain =
      std::max<std::chrono::nanoseconds>(took("x=y "), std::chrono::microseconds(100));
  for (const auto* piece : {"<", "<!--", "<![CDATA[", "<?", "<!", "<a b=\"", "<a b='", "=\"", "</",
                            "<IPOC", "<IPOC>", "<IPOC>1", "<a b=\"<a c='"}) {
    CAPTURE(piece);
    CHECK(took(piece) < 100 * plain);
  }
}

TEST_CASE("the digits of an IPOC are echoed as they came and read as 64 bits", "[ipoc]") {
  CHECK(find_ipoc("<IPOC>000123</IPOC>") == "000123");
  CHECK(rsi::ipoc_number("000123") == 123u);
  CHECK(rsi::ipoc_number("18446744073709551615") == 18446744073709551615u);
  CHECK_FALSE(rsi::ipoc_number("18446744073709551616"));
  CHECK_FALSE(rsi::ipoc_number(""));
}
