#include "rsi/telegram/telegram_shape.hpp"

#include <string>
#include <string_view>
#include <vector>

#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/telegram.hpp"
#include "tests/catch.hpp"

namespace {

using rsi::Signal;
using rsi::Telegram;
using rsi::TelegramShape;

std::string text_of(const std::vector<Signal>& signals, std::string_view ipoc) {
  std::string text(ipoc);
  for (const Signal& signal : signals) {
    text += '|';
    text.append(signal.element) += '.';
    text.append(signal.attribute) += '=';
    text.append(signal.text);
  }
  return text;
}

/// What the shape of `learned` makes of `datagram`; "other" if it is none of its.
std::string read(std::string_view learned, std::string_view datagram) {
  Telegram telegram;
  TelegramShape shape;
  REQUIRE(telegram.parse(learned) == rsi::Defect::none);
  shape.learn(learned, telegram.signals(), rsi::find_ipoc(learned));
  std::vector<Signal> signals;
  std::string_view ipoc;
  return shape.read(datagram, signals, ipoc) ? text_of(signals, ipoc) : "other";
}

constexpr std::string_view kOne =
    R"(<Rob Type="KUKA"><RIst X="1.0" Y="-2.5"/><DiL>0</DiL><IPOC>17</IPOC><E 01="a"/></Rob>)";

}  // namespace

TEST_CASE("values of any length are read by the shape", "[telegram_shape]") {
  CHECK(read(kOne, kOne) == "17|RIst.X=1.0|RIst.Y=-2.5|DiL.=0|E.01=a");
  CHECK(read(kOne, R"(<Rob Type="KUKA"><RIst X="-1000.25" Y=""/><DiL>15 4</DiL><IPOC>4711</IPOC>)"
                   R"(<E 01="b c"/></Rob>)") == "4711|RIst.X=-1000.25|RIst.Y=|DiL.=15 4|E.01=b c");
}

TEST_CASE("values are read whatever sizes those of the telegram before had", "[telegram_shape]") {
  Telegram telegram;
  TelegramShape shape;
  REQUIRE(telegram.parse(kOne) == rsi::Defect::none);
  shape.learn(kOne, telegram.signals(), rsi::find_ipoc(kOne));
  std::vector<Signal> signals;
  std::string_view ipoc;
  for (const std::string_view x :
       {"1.0", "-1.0", "1.0", "", "1234567", "-1234567", "123456789.123456", "-123456789.123456",
        "12345678.12345678.12345678", "-", "abcdefgh", "abc", "x y z", "\x80\xff\x80\xff\x80"})
    for (const std::string_view number : {"17", "18446744073709551615", "0"}) {
      std::string datagram(kOne);
      datagram.replace(datagram.find("17"), 2, number);
      datagram.replace(datagram.find("1.0"), 3, x);
      CAPTURE(datagram);
      REQUIRE(shape.read(datagram, signals, ipoc));
      CHECK(text_of(signals, ipoc) ==
            std::string(number) + "|RIst.X=" + std::string(x) + "|RIst.Y=-2.5|DiL.=0|E.01=a");
    }
  // Markup anywhere in a value: the parser has to look.
  for (std::size_t at = 0; at <= 20; ++at)
    for (const char markup : {'<', '>', '=', '\'', '"'}) {
      std::string value(20, '7');
      value.insert(at, 1, markup);
      for (const std::string_view before : {value.substr(0, at), std::string(21, '7')}) {
        std::string datagram(kOne);
        datagram.replace(datagram.find("1.0"), 3, before);
        REQUIRE(shape.read(datagram, signals, ipoc));
        datagram = kOne;
        datagram.replace(datagram.find("1.0"), 3, value);
        CHECK_FALSE(shape.read(datagram, signals, ipoc));
      }
    }
}

TEST_CASE("what is not the same but for its values has another shape", "[telegram_shape]") {
  const std::string one(kOne);
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string other = one;
    other.replace(other.find(from), from.size(), to);
    return read(kOne, other);
  };
  CHECK(with("Y=", "Z=") == "other");
  CHECK(with("KUKA", "OTHER") == "other");
  CHECK(with("<DiL>0</DiL>", "") == "other");
  CHECK(with("</Rob>", "</Rob>\r\n") == "other");
  CHECK(with("</Rob>", "</Ro") == "other");
  CHECK(with("\"1.0\"", "'1.0'") == "other");
  // These the parser could see otherwise.
  CHECK(with(">0<", "><") == "other");
  CHECK(with(">0<", "> 0<") == "other");
  CHECK(with(">0<", ">0 <") == "other");
  CHECK(with("1.0", "<IPOC>9</IPOC>") == "other");
  CHECK(with("\"a\"", "\"a='\"") == "other");
  for (std::size_t size = 0; size < one.size(); ++size)
    CHECK(read(kOne, std::string_view(one).substr(0, size)) == "other");
}

TEST_CASE("a telegram that could be read in another way has no shape", "[telegram_shape]") {
  for (const std::string_view strange :
       {R"(<Rob><R X="a=b"/><IPOC>1</IPOC></Rob>)", R"(<Rob><R X=1 /><IPOC>1</IPOC></Rob>)",
        R"(<Rob><T></T><IPOC>1</IPOC></Rob>)", R"(<Rob><T> 1</T><IPOC>1</IPOC></Rob>)",
        R"(<Rob><R ="1"/><IPOC>1</IPOC></Rob>)", R"(<Rob><IPOC> 1 </IPOC></Rob>)"})
    CHECK(read(strange, strange) == "other");
  // Another IPOC than the last one is none of the values.
  constexpr std::string_view kTwo = "<Rob><IPOC>1</IPOC><T>5</T><IPOC>2</IPOC></Rob>";
  CHECK(read(kTwo, kTwo) == "2|T.=5");
  CHECK(read(kTwo, "<Rob><IPOC>3</IPOC><T>5</T><IPOC>4</IPOC></Rob>") == "other");
}

TEST_CASE("an IPOC that is none is looked for again", "[telegram_shape]") {
  Telegram telegram;
  REQUIRE(telegram.parse("<Rob><IPOC>1</IPOC><T>5</T><IPOC>2</IPOC></Rob>") == rsi::Defect::none);
  CHECK(telegram.parse("<Rob><IPOC>1</IPOC><T>5</T><IPOC>x</IPOC></Rob>") == rsi::Defect::none);
  CHECK(telegram.ipoc() == 1);
  CHECK(telegram.parse("<Rob><IPOC>1</IPOC><T>6</T><IPOC>18446744073709551616</IPOC></Rob>") ==
        rsi::Defect::none);
  CHECK(telegram.ipoc() == 1);
}
