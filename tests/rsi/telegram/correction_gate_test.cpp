#include "rsi/telegram/correction_gate.hpp"

#include <string>

#include "rsi/telegram/reply.hpp"
#include "tests/catch.hpp"

using rsi::moves_nothing;

namespace {

std::string sen(const std::string& content) {
  return "<Sen Type=\"ImFree\">" + content + "<IPOC>123456</IPOC></Sen>";
}

std::string reply_of(const std::string& receive) {
  const auto config = rsi::EthernetConfig::parse(
      "<ROOT><CONFIG><IP_NUMBER>1.2.3.4</IP_NUMBER><PORT>49152</PORT><SENTYPE>ImFree</SENTYPE>"
      "<ONLYSEND>FALSE</ONLYSEND></CONFIG><SEND><ELEMENTS></ELEMENTS></SEND><RECEIVE><ELEMENTS>" +
          receive + "</ELEMENTS></RECEIVE></ROOT>",
      "test.xml");
  rsi::Reply reply(config);
  return std::string(reply.with_ipoc("18446744073709551615"));
}

}  // namespace

TEST_CASE("every reply that is made passes", "[correction_gate]") {
  for (const std::string receive :
       {"", "<ELEMENT TAG=\"DEF_EStr\" TYPE=\"STRING\" INDX=\"INTERNAL\" />",
        "<ELEMENT TAG=\"RKorr.X\" TYPE=\"DOUBLE\" INDX=\"1\" />"
        "<ELEMENT TAG=\"RKorr.Y\" TYPE=\"DOUBLE\" INDX=\"2\" />",
        "<ELEMENT TAG=\"DiO\" TYPE=\"LONG\" INDX=\"3\" />"
        "<ELEMENT TAG=\"GPIO.01\" TYPE=\"BOOL\" INDX=\"4\" />"}) {
    const auto reply = reply_of(receive);
    INFO(reply);
    CHECK(moves_nothing(reply));
  }
}

TEST_CASE("zeros, empty texts and the IPOC pass", "[correction_gate]") {
  CHECK(moves_nothing(sen("")));
  CHECK(moves_nothing(sen("<EStr></EStr><RKorr X=\"0.0\" Y=\"0\" Z=\"\"/><DiO>0</DiO>")));
  CHECK(moves_nothing(sen("<Tech C11=\"0.0\"></Tech>")));
}

TEST_CASE("a value that is not zero does not pass, wherever it stands and however it is written",
          "[correction_gate]") {
  for (const std::string value :
       {"1", "0.1", "-0.1", "00.1", "1e-9", "0e1", ".5", "5.", "0x1", "nan", "inf", "-0.0", "0.00",
        " 0", "0 ", "0,1", "&#49;", "\x31"}) {
    INFO(value);
    CHECK_FALSE(moves_nothing(sen("<RKorr X=\"" + value + "\"/>")));
    CHECK_FALSE(moves_nothing(sen("<RKorr X=\"0.0\" Y=\"" + value + "\"/>")));
    CHECK_FALSE(moves_nothing(sen("<DiO>" + value + "</DiO>")));
  }
}

TEST_CASE("what cannot be read with certainty does not pass", "[correction_gate]") {
  for (const std::string& text : {std::string(),
                                  std::string("<Sen"),
                                  std::string("<Rob Type=\"ImFree\"></Rob>"),
                                  sen("") + "\n",
                                  sen("") + sen(""),
                                  " " + sen(""),
                                  sen("<RKorr X='0.0'/>"),
                                  sen("<RKorr X=0.0/>"),
                                  sen("<RKorr X=\"0.0/>"),
                                  sen("<A><B>0</B></A>"),
                                  sen("<A>0</B>"),
                                  sen("<!-- 0 -->"),
                                  sen("0"),
                                  sen("<IPOC>12a</IPOC>"),
                                  sen("<IPOC></IPOC>"),
                                  sen("<IPOC X=\"1\">12</IPOC>"),
                                  sen("</A>"),
                                  sen("<A/B>0</A/B>"),
                                  std::string("<Sen Type=\"a\" X=\"1\"></Sen>"),
                                  std::string("<Sen Type=\"<X>1</X>\"></Sen>"),
                                  std::string("<Sen Type=\"ImFree\"><A>0</A></Sen")}) {
    INFO(text);
    CHECK_FALSE(moves_nothing(text));
  }
}

TEST_CASE("no single damaged byte of a value makes a reply that passes with another value",
          "[correction_gate]") {
  const std::string sound =
      sen("<EStr></EStr><RKorr X=\"0.0\" Y=\"0.0\"/><Tech C11=\"0.0\"/><DiO>0</DiO>");
  for (const char* value : {"0.0\" Y", "0.0\"/><T", "0.0\"/><D", "0</DiO"}) {
    const auto at = sound.find(value);
    REQUIRE(at != sound.npos);
    for (int byte = 1; byte < 256; ++byte) {
      if (byte == '0') continue;
      auto damaged = sound;
      damaged[at] = static_cast<char>(byte);
      INFO(damaged);
      CHECK_FALSE(moves_nothing(damaged));
    }
  }
}
