#include "rsi/telegram/telegram.hpp"

#include <memory>
#include <random>
#include <string>

#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"

using rsi::Defect;
using rsi::Signal;
using rsi::Telegram;

namespace {

std::string value(const Telegram& telegram, std::string_view element,
                  std::string_view attribute = {}) {
  const auto at = telegram.find(element, attribute);
  return at ? std::string(telegram.signals()[*at].text) : "(missing)";
}

const std::string kRecorded =
    R"(<Rob Type="KUKA"><RIst X="812.3456" Y="-0.5" Z="1.0e2" A="0.0" B="90.0" C="-180.0"/>)"
    R"(<AIPos A1="0.0" A2="-90.0" A3="90.0" A4="0.0" A5="0.0" A6="0.0"/><Delay D="2"/>)"
    R"(<Tech C15="0.0" C16="0.0"  C17="0.0"/><DiL>7</DiL><Digout o1="0" o2="1"/>)"
    "<Source1>0.3</Source1><IPOC>237437</IPOC></Rob>\n";

}  // namespace

TEST_CASE("a telegram in the recorded form gives every signal in its order", "[telegram]") {
  Telegram telegram;
  REQUIRE(telegram.parse(kRecorded) == Defect::none);
  CHECK(telegram.ipoc() == 237437u);
  CHECK(telegram.signals().size() == 6 + 6 + 1 + 3 + 1 + 2 + 1);
  CHECK(telegram.signals().front().element == "RIst");
  CHECK(telegram.signals().back().element == "Source1");
  CHECK(value(telegram, "RIst", "X") == "812.3456");
  CHECK(value(telegram, "AIPos", "A2") == "-90.0");
  CHECK(value(telegram, "Delay", "D") == "2");
  CHECK(value(telegram, "Tech", "C17") == "0.0");
  CHECK(value(telegram, "DiL") == "7");
  CHECK(value(telegram, "Digout", "o2") == "1");
}

TEST_CASE("every known variant of the markup is understood", "[telegram]") {
  Telegram telegram;
  SECTION("TYPE in upper case, a blank before the end, single quotes, text elements by name") {
    REQUIRE(telegram.parse("<Rob TYPE='KUKA'><Act_X >1.5</Act_X><RIst X='1' Y = \"2\" /><IPOC>1"
                           "</IPOC></Rob>") == Defect::none);
    CHECK(value(telegram, "Act_X") == "1.5");
    CHECK(value(telegram, "RIst", "Y") == "2");
  }
  SECTION("wrapped in Dat, with tabs and line feeds and elements after the IPOC") {
    REQUIRE(
        telegram.parse("<?xml version=\"1.0\"?>\r\n<Rob Type=\"KUKA\">\n\t<Dat TaskType=\"b\">\n"
                       "\t\t<RIst X=\"1.0\"\n\t\t Y=\"2.0\"/>\n\t\t<IPOC>4711</IPOC>\n"
                       "\t\t<Late>9</Late>\n\t</Dat>\n</Rob>\n") == Defect::none);
    CHECK(telegram.ipoc() == 4711u);
    CHECK(value(telegram, "RIst", "Y") == "2.0");
    CHECK(value(telegram, "Late") == "9");
  }
  SECTION("attribute names that begin with a digit, and everything after them") {
    REQUIRE(telegram.parse("<Rob Type=\"KUKA\"><GPIO 01=\"1\" 02=\"0\"/><RIst X=\"3.5\"/>"
                           "<IPOC>8</IPOC></Rob>") == Defect::none);
    CHECK(value(telegram, "GPIO", "01") == "1");
    CHECK(value(telegram, "GPIO", "02") == "0");
    CHECK(value(telegram, "RIst", "X") == "3.5");
    CHECK(telegram.ipoc() == 8u);
  }
  SECTION("the first packet of old controllers") {
    CHECK(telegram.parse("<Rob Type=\"KUKA\"><Ipoc>0</Ipoc></Rob>") == Defect::none);
    CHECK(telegram.parse("<ipoc>12</ipoc>") == Defect::none);
    CHECK(telegram.ipoc() == 12u);
  }
  SECTION("comments, a byte order mark, NULs and blanks behind") {
    const std::string text =
        "\xef\xbb\xbf<!-- <Rob> --><Rob><!-- <IPOC>1</IPOC> --><A b=\"1\"/>"
        "<IPOC>2</IPOC></Rob>" +
        std::string("\0\0 \n\0", 5);
    CHECK(telegram.parse(text) == Defect::none);
    CHECK(telegram.ipoc() == 2u);
    CHECK(telegram.signals().size() == 1);
  }
  SECTION("empty elements") {
    CHECK(telegram.parse("<Rob><EStr></EStr><None/><IPOC>2</IPOC></Rob>") == Defect::none);
    CHECK(value(telegram, "EStr").empty());
  }
}

TEST_CASE("a comment ends at its end, however short it looks", "[telegram]") {
  Telegram telegram;
  for (const auto* comment : {"<!-->", "<!--->", "<!---->"}) {
    CAPTURE(comment);
    const std::string text =
        std::string("<Rob>") + comment + "<!-- --><A b=\"1\"/><IPOC>2</IPOC><!-- --></Rob>";
    REQUIRE(telegram.parse(text) == Defect::none);
    CHECK(value(telegram, "A", "b") == "1");
  }
  CHECK(telegram.parse("<Rob><!--><IPOC>1</IPOC>--></Rob>") == Defect::no_ipoc);
  CHECK(telegram.parse("<Rob><!---><IPOC>1</IPOC>--></Rob>") == Defect::no_ipoc);
}

TEST_CASE("of several IPOCs the last that can be read counts, as it is the one that is echoed",
          "[telegram]") {
  Telegram telegram;
  for (const auto* second : {"<IPOC></IPOC>", "<IPOC>x</IPOC>", "<IPOC/>", "<IPOC>-1</IPOC>"}) {
    CAPTURE(second);
    const std::string text = std::string("<Rob><IPOC>4</IPOC><IPOC>5</IPOC>") + second + "</Rob>";
    CHECK(telegram.parse(text) == Defect::none);
    CHECK(telegram.ipoc() == 5u);
    CHECK(rsi::find_ipoc(text) == "5");
  }
}

TEST_CASE("what is no telegram is told by kind", "[telegram]") {
  Telegram telegram;
  CHECK(telegram.parse("") == Defect::empty);
  CHECK(telegram.parse(std::string("\0\0 \n", 4)) == Defect::empty);
  CHECK(telegram.parse("hello") == Defect::not_a_telegram);
  CHECK(telegram.parse("\x7f\x45\x4c\x46\x02") == Defect::not_a_telegram);
  CHECK(telegram.parse("<Sen Type=\"ImFree\"><IPOC>1</IPOC></Sen>") == Defect::not_a_telegram);
  CHECK(telegram.parse("<!-- only a comment -->") == Defect::not_a_telegram);
  CHECK(telegram.parse("<Rob Type=\"KUKA\"><DiL>0</DiL></Rob>") == Defect::no_ipoc);
  CHECK(telegram.parse("<Rob><IPOC>-1</IPOC></Rob>") == Defect::no_ipoc);
  CHECK(telegram.parse("<Rob><IPOC>99999999999999999999</IPOC></Rob>") == Defect::no_ipoc);
}

TEST_CASE("a telegram cut anywhere is truncated, and no half number is taken from it",
          "[telegram]") {
  Telegram telegram;
  const std::string whole = kRecorded.substr(0, kRecorded.rfind('\n'));
  REQUIRE(telegram.parse(whole) == Defect::none);
  const auto all = telegram.signals();
  for (std::size_t size = 4; size < whole.size(); ++size) {
    CAPTURE(size);
    const std::string cut = whole.substr(0, size);
    CHECK(telegram.parse(cut) == Defect::truncated);
    REQUIRE(telegram.signals().size() <= all.size());
    for (std::size_t i = 0; i < telegram.signals().size(); ++i) {
      CHECK(telegram.signals()[i].element == all[i].element);
      if (!telegram.signals()[i].attribute.empty())
        CHECK(telegram.signals()[i].text == all[i].text);
    }
  }
}

TEST_CASE("no bytes make the parser fail, whatever they are", "[telegram]") {
  std::mt19937 random(20130704);
  Telegram telegram;
  const std::string alphabet = "<>/=\"' RobIPOC01.-!?\n";
  for (int run = 0; run < 20000; ++run) {
    std::string bytes = run % 2 == 0 ? kRecorded : "<Rob>";
    for (int edit = 0; edit < 30; ++edit) {
      const char c =
          run % 3 == 0 ? static_cast<char>(random() & 0xff) : alphabet[random() % alphabet.size()];
      if (run % 2 == 0)
        bytes[random() % bytes.size()] = c;
      else
        bytes += c;
    }
    telegram.parse(bytes);
    for (const auto& signal : telegram.signals()) {
      const auto* begin = bytes.data();
      if (!signal.text.empty()) {
        REQUIRE(signal.text.data() >= begin);
        REQUIRE(signal.text.data() + signal.text.size() <= begin + bytes.size());
      }
    }
  }
}

TEST_CASE("a signal is found by its names", "[telegram]") {
  Telegram telegram;
  telegram.parse(kRecorded);
  CHECK(telegram.find("RIst", "X") == 0u);
  CHECK(telegram.find("AIPos", "A1") == 6u);
  CHECK_FALSE(telegram.find("RSol", "X"));
}

TEST_CASE("a place follows its signal when the telegram changes", "[telegram]") {
  Telegram telegram;
  rsi::SignalPlace y("R", "Y");
  rsi::SignalPlace text("T");
  const auto is = [&](rsi::SignalPlace& place, std::string_view datagram) {
    REQUIRE(telegram.parse(datagram) == Defect::none);
    const rsi::Signal* const signal = place.in(telegram);
    return signal == nullptr ? std::string("none") : std::string(signal->text);
  };
  CHECK(is(y, R"(<Rob><R X="1" Y="2"/><IPOC>1</IPOC></Rob>)") == "2");
  CHECK(is(y, R"(<Rob><R X="10" Y="-20"/><IPOC>2</IPOC></Rob>)") == "-20");
  CHECK(is(text, R"(<Rob><R X="10" Y="-20"/><IPOC>3</IPOC></Rob>)") == "none");
  CHECK(is(y, R"(<Rob><T>7</T><R Y="3" X="1"/><IPOC>4</IPOC></Rob>)") == "3");
  CHECK(is(text, R"(<Rob><T>70</T><R Y="3" X="1"/><IPOC>5</IPOC></Rob>)") == "70");
  CHECK(is(y, R"(<Rob><R X="1"/><IPOC>6</IPOC></Rob>)") == "none");
  CHECK(is(y, R"(<Rob><R X="1" Y="2"/><IPOC>7</IPOC></Rob>)") == "2");
}

TEST_CASE("names stay right when telegrams of another kind came between, and in a copy",
          "[telegram]") {
  const auto read = [](Telegram& telegram, std::string text) {
    const bool whole = telegram.parse(text) == Defect::none;
    std::string names;
    for (const Signal& signal : telegram.signals())
      names.append(signal.element).append(1, '.').append(signal.attribute).append(1, ' ');
    return whole ? names : "defect: " + names;
  };
  const auto one = [](int x) {
    return "<Rob><RIst X=\"" + std::to_string(x) + "\" Y=\"2\"/><IPOC>7</IPOC></Rob>";
  };
  constexpr auto kNames = "RIst.X RIst.Y ";
  auto telegram = std::make_unique<Telegram>();
  for (int x = 0; x < 3; ++x) CHECK(read(*telegram, one(x)) == kNames);
  CHECK(read(*telegram, R"(<Rob><Wrong Q="1" R="2"/>)") == "defect: Wrong.Q Wrong.R ");
  CHECK(read(*telegram, one(11)) == kNames);
  CHECK(read(*telegram, R"(<Rob><DiL>3</DiL><IPOC>8</IPOC></Rob>)") == "DiL. ");
  CHECK(read(*telegram, R"(<Rob><DiL>4</DiL><IPOC>9</IPOC></Rob>)") == "DiL. ");
  for (int x = 0; x < 3; ++x) CHECK(read(*telegram, one(x)) == kNames);
  Telegram copy = *telegram;
  CHECK(read(*telegram, one(100)) == kNames);
  telegram.reset();
  for (int x = 0; x < 3; ++x) CHECK(read(copy, one(x)) == kNames);
}
