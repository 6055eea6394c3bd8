#include "rsi/telegram/ethernet_config.hpp"

#include <filesystem>

#include "rsi/telegram/wire_layout.hpp"
#include "tests/catch.hpp"

using rsi::EthernetConfig;
using Type = EthernetConfig::Element::Type;
using Catch::Matchers::ContainsSubstring;

namespace {

const std::string kSettings =
    "<IP_NUMBER>10.0.0.5</IP_NUMBER><PORT>49152</PORT><SENTYPE>ImFree</SENTYPE>"
    "<ONLYSEND>FALSE</ONLYSEND>";
const std::string kSent = R"(<ELEMENT TAG="DEF_RIst" TYPE="DOUBLE" INDX="INTERNAL"/>)"
                          R"(<ELEMENT TAG="DEF_AIPos" TYPE="DOUBLE" INDX="INTERNAL"/>)"
                          R"(<ELEMENT TAG="DEF_Delay" TYPE="LONG" INDX="INTERNAL"/>)";

std::string file(const std::string& settings, const std::string& sent = kSent,
                 const std::string& received = "") {
  return "<ROOT>\n<CONFIG>" + settings + "</CONFIG>\n<SEND><ELEMENTS>\n" + sent +
         "</ELEMENTS></SEND>\n<RECEIVE><ELEMENTS>\n" + received + "</ELEMENTS></RECEIVE>\n</ROOT>";
}

EthernetConfig parse(const std::string& xml) {
  return EthernetConfig::parse(xml, "eth.xml");
}

std::string error_of(const std::string& xml) {
  try {
    const auto config = parse(xml);
    return "no error";
  } catch (const rsi::EthernetConfigError& error) {
    return error.what();
  }
}

/// Of a file with this one tag in its RECEIVE list, which begins in line 6.
std::string error_of_tag(const std::string& attributes) {
  return error_of(file(kSettings, kSent, "<ELEMENT " + attributes + "/>"));
}

std::vector<std::string> warnings_of_tag(const std::string& attributes) {
  return parse(file(kSettings, kSent, "<ELEMENT " + attributes + "/>")).warnings;
}

std::string printed(const std::vector<rsi::WireElement>& layout) {
  std::string text;
  for (const auto& element : layout) {
    text += element.name + "(";
    for (const auto& field : element.fields) text += field.attribute + ",";
    text += ") ";
  }
  return text;
}

std::string layout_of(const std::vector<std::string>& tags) {
  std::vector<EthernetConfig::Element> list;
  for (const auto& tag : tags) list.push_back({tag, Type::DOUBLE, 1, false, 0});
  return printed(rsi::wire_layout(list));
}

}  // namespace

TEST_CASE("an Ethernet file is read with its settings and both lists in order",
          "[ethernet_config]") {
  const auto config =
      parse(file(kSettings, kSent + R"(<ELEMENT TAG="Digout.o1" TYPE="BOOL" INDX="2"/>)",
                 R"(<ELEMENT TAG="DEF_EStr" TYPE="STRING" INDX="INTERNAL"/>
         <ELEMENT TAG="RKorr.X" TYPE="DOUBLE" INDX="1" HOLDON="1"/>)"));
  CHECK(config.name == "eth.xml");
  CHECK(config.ip_number == "10.0.0.5");
  CHECK(config.port == 49152);
  CHECK(config.sentype == "ImFree");
  CHECK_FALSE(config.only_send);
  CHECK(config.protocol == EthernetConfig::Protocol::UDP);
  CHECK_FALSE(config.length_first);
  CHECK(config.warnings.empty());

  REQUIRE(config.send.size() == 4);
  CHECK(config.send[0].tag == "DEF_RIst");
  CHECK(config.send[0].index == 0);
  CHECK(config.send[2].type == Type::LONG);
  CHECK(config.send[3].tag == "Digout.o1");
  CHECK(config.send[3].type == Type::BOOL);
  CHECK(config.send[3].index == 2);
  REQUIRE(config.receive.size() == 2);
  CHECK(config.receive[0].type == Type::STRING);
  CHECK(config.receive[1].holdon);
  CHECK(config.receive[1].line == 7);
}

TEST_CASE("KUKA's comments, tabs, CRLF, units and booleans of any case are accepted",
          "[ethernet_config]") {
  const auto config = parse(
      "\xef\xbb\xbf<ROOT>\r\n\t<CONFIG>\r\n"
      "\t\t<IP_NUMBER> 10.0.0.5\t</IP_NUMBER>   <!-- the socket's address !-->\r\n"
      "\t\t<PORT>6008</PORT><PROTOCOL>udp</PROTOCOL><SENTYPE>KMC</SENTYPE>\r\n"
      "\t\t<PROTCOLLENGTH>Off</PROTCOLLENGTH><ONLYSEND>True</ONLYSEND>\r\n\t</CONFIG>\r\n"
      "<!-- .C = advance -> <Sen Type=\"\" > !-->\r\n"
      "<SEND><ELEMENTS>\r\n"
      "<ELEMENT TAG=\"DEF_RIst\" TYPE=\"double\" INDX=\"internal\" UNIT=\"0\" />\r\n"
      "<ELEMENT TAG=\"DEF_AIPos\" TYPE=\"DOUBLE\" INDX=\"INTERNAL\" UNIT=\"3601\" />\t<!-- $x "
      "-->\r\n"
      "<ELEMENT TAG=\"DEF_Delay\" TYPE=\"LONG\" INDX=\"INTERNAL\" HOLDON=\"true\" />\r\n"
      "<ELEMENT TAG=\"GPIO.01\" TYPE=\"BOOL\" INDX=\" 64 \" />\r\n"
      "</ELEMENTS></SEND>\r\n<RECEIVE/></ROOT>");
  CHECK(config.warnings.empty());
  CHECK(config.ip_number == "10.0.0.5");
  CHECK(config.port == 6008);
  CHECK(config.only_send);
  REQUIRE(config.send.size() == 4);
  CHECK(config.send[3].tag == "GPIO.01");
  CHECK(config.send[3].index == 64);
  CHECK(config.send[3].line == 12);
}

TEST_CASE("a comment or CDATA amid a value does not end it", "[ethernet_config]") {
  const auto config =
      parse(file("<IP_NUMBER>10.0.<!-- x -->0.5</IP_NUMBER><PORT>491<!-- x -->52</PORT>"
                 "<SENTYPE>Im<![CDATA[Free]]></SENTYPE><ONLYSEND><!-- x -->TRUE</ONLYSEND>"));
  CHECK(config.ip_number == "10.0.0.5");
  CHECK(config.port == 49152);
  CHECK(config.sentype == "ImFree");
  CHECK(config.only_send);
  CHECK_THAT(error_of(file("<PORT>49152</PORT><SENTYPE>Im<b/>Free</SENTYPE>")),
             ContainsSubstring("SENTYPE: expected text alone, found \"b\""));
}

TEST_CASE("a placeholder for the address is a warning with its line, not an error",
          "[ethernet_config]") {
  const auto config = parse(
      "<ROOT>\n <CONFIG>\n  <IP_NUMBER>ip.address.of.rospc</IP_NUMBER><PORT>49152</PORT>\n"
      "  <SENTYPE>ImFree</SENTYPE><ONLYSEND>FALSE</ONLYSEND></CONFIG>\n <SEND><ELEMENTS>" +
      kSent + "</ELEMENTS></SEND><RECEIVE/></ROOT>");
  REQUIRE(config.warnings.size() == 1);
  CHECK_THAT(config.warnings[0], Catch::Matchers::StartsWith("eth.xml:3:3: IP_NUMBER: expected") &&
                                     ContainsSubstring("found \"ip.address.of.rospc\""));
}

TEST_CASE("a wrong setting is refused with place, key, expectation and finding",
          "[ethernet_config]") {
  CHECK_THAT(
      error_of("<ROOT><CONFIG>\n  <PORT>70000</PORT></CONFIG><SEND/></ROOT>"),
      ContainsSubstring("eth.xml:2:3: PORT: expected a number from 1 to 65535, found \"70000\""));
  CHECK_THAT(error_of(file("<PORT>0</PORT>")),
             ContainsSubstring("PORT") && ContainsSubstring("\"0\""));
  CHECK_THAT(error_of(file("<PORT>the port</PORT>")), ContainsSubstring("PORT"));
  CHECK_THAT(error_of(file("<SENTYPE>X</SENTYPE>")),
             ContainsSubstring("eth.xml:2:1: PORT") && ContainsSubstring("found nothing"));
  CHECK_THAT(error_of(file("<PORT>1</PORT><PORT>2</PORT>")),
             ContainsSubstring("PORT: expected this key once"));
  CHECK_THAT(error_of(file("<PORT>1</PORT>")), ContainsSubstring("SENTYPE: expected the name"));
  CHECK_THAT(error_of(file(kSettings + "<PROTOCOL>SCTP</PROTOCOL>")),
             ContainsSubstring("PROTOCOL: expected UDP or TCP, found \"SCTP\""));
  CHECK_THAT(error_of(file("<ONLYSEND>maybe</ONLYSEND>")),
             ContainsSubstring("ONLYSEND: expected TRUE or FALSE, found \"maybe\""));
}

TEST_CASE("a wrong tag is refused with its line", "[ethernet_config]") {
  CHECK_THAT(error_of_tag(R"(TYPE="BOOL" INDX="1")"),
             ContainsSubstring("eth.xml:6:1: TAG: expected a name"));
  CHECK_THAT(error_of_tag(R"(TAG="a b" TYPE="BOOL" INDX="1")"), ContainsSubstring("\"a b\""));
  CHECK_THAT(error_of_tag(R"(TAG="a." TYPE="BOOL" INDX="1")"), ContainsSubstring("TAG"));
  CHECK_THAT(error_of_tag(R"(TAG="IPOC" TYPE="LONG" INDX="1")"),
             ContainsSubstring("expected another name"));
  // Every telegram and reply has these elements already; a second one would be taken for the first.
  for (const auto* tag : {"IPOC.a", "DEF_IPOC", "ipoc", "Sen", "Sen.Type", "DEF_Sen.Type", "Rob"})
    CHECK_THAT(error_of_tag("TAG=\"" + std::string(tag) + R"(" TYPE="LONG" INDX="1")"),
               ContainsSubstring("expected another name"));
  // DEF_ is not part of the name on the wire.
  for (const auto* tag : {"DEF_", "DEF_.a"})
    CHECK_THAT(error_of_tag("TAG=\"" + std::string(tag) + R"(" TYPE="LONG" INDX="INTERNAL")"),
               ContainsSubstring("TAG: expected a name"));
  CHECK_THAT(error_of_tag(R"(TAG="a" TYPE="FLOAT" INDX="1")"),
             ContainsSubstring("TYPE: expected BOOL, STRING, LONG or DOUBLE, found \"FLOAT\""));
  CHECK_THAT(error_of_tag(R"(TAG="a" INDX="1")"),
             ContainsSubstring("TYPE") && ContainsSubstring("found nothing"));
  for (const auto* index : {R"(INDX="0")", R"(INDX="65")", R"(INDX="-1")", R"(INDX="1x")", ""})
    CHECK_THAT(error_of_tag(std::string(R"(TAG="a" TYPE="LONG" )") + index),
               ContainsSubstring("INDX: expected INTERNAL or a number from 1 to 64"));
  CHECK_THAT(error_of_tag(R"(TAG="a" TYPE="LONG" INDX="1" HOLDON="2")"),
             ContainsSubstring("HOLDON"));
}

TEST_CASE("what is no Ethernet file is refused with the place where that shows",
          "[ethernet_config]") {
  CHECK_THAT(error_of(""), ContainsSubstring("eth.xml:1:"));
  CHECK_THAT(error_of("<ROOT>\n<CONFIG>\n</CONFIX></ROOT>"), ContainsSubstring("eth.xml:3:"));
  CHECK_THAT(error_of("<html/>"),
             ContainsSubstring("root element: expected <ROOT>, found \"html\""));
  CHECK_THAT(error_of("<ROOT><SEND/></ROOT>"), ContainsSubstring("CONFIG: expected a section"));
  CHECK_THAT(error_of("<ROOT><CONFIG/></ROOT>"), ContainsSubstring("SEND: expected a section"));
  CHECK_THAT(error_of(std::string("<\0R\0", 4)), ContainsSubstring("zero bytes"));
  CHECK_THAT(error_of(std::string(3, '\xff')), ContainsSubstring("eth.xml:1:"));
}

TEST_CASE("a list of received tags that is not understood is refused, and never passed over",
          "[ethernet_config]") {
  const std::string tag = R"(<ELEMENT TAG="RKorr.X" TYPE="DOUBLE" INDX="1"/>)";
  const auto with = [&](const std::string& received) {
    return error_of("<ROOT><CONFIG>" + kSettings + "</CONFIG><SEND><ELEMENTS>" + kSent +
                    "</ELEMENTS></SEND>\n" + received + "</ROOT>");
  };
  CHECK(with("<RECEIVE><ELEMENTS>" + tag + "</ELEMENTS></RECEIVE>") == "no error");
  CHECK_THAT(
      with("<RECEIVE><ELEMENTS/></RECEIVE>\n<RECEIVE><ELEMENTS>" + tag + "</ELEMENTS></RECEIVE>"),
      ContainsSubstring("eth.xml:3:1: <ROOT>: expected each section once, found \"RECEIVE\""));
  CHECK_THAT(with("<RECEIVE>" + tag + "</RECEIVE>"),
             ContainsSubstring("<RECEIVE>: expected ELEMENTS alone, found \"ELEMENT\""));
  CHECK_THAT(with("<RECEIVE><Elements>" + tag + "</Elements></RECEIVE>"),
             ContainsSubstring("<RECEIVE>: expected ELEMENTS alone, found \"Elements\""));
  CHECK_THAT(with("<RECEIVE><ELEMENTS><element/></ELEMENTS></RECEIVE>"),
             ContainsSubstring("<ELEMENTS>: expected ELEMENT alone, found \"element\""));
  CHECK_THAT(with("<Receive><ELEMENTS>" + tag + "</ELEMENTS></Receive>"),
             ContainsSubstring("expected the sections CONFIG, SEND and RECEIVE alone, found "
                               "\"Receive\""));
  const std::string open = R"(<ELEMENT TAG="DEF_EStr" TYPE="STRING" INDX="INTERNAL")";
  const auto list = [&](const std::string& received) {
    return with("<RECEIVE><ELEMENTS>" + received + "</ELEMENTS></RECEIVE>");
  };
  CHECK(list(open + "/><!-- of mine -->") == "no error");
  CHECK_THAT(list(open + ">" + tag + "</ELEMENT>"),
             ContainsSubstring("ELEMENT: expected attributes alone"));
  CHECK_THAT(list(open + R"( TAG="RKorr.X"/>)"),
             ContainsSubstring("TAG: expected this attribute once"));
  CHECK_THAT(list(open + "/><![CDATA[" + tag + "]]>"),
             ContainsSubstring("<ELEMENTS>: expected ELEMENT alone, found \"<ELEMENT"));
  CHECK_THAT(with("<RECEIVE>" + open + "/></RECEIVE></ROOT><ROOT><RECEIVE/>"),
             ContainsSubstring("root element: expected one, found \"another\""));
}

TEST_CASE("what is said about a file is one line, whatever the file holds", "[ethernet_config]") {
  CHECK_THAT(error_of_tag(R"(TAG="a&#10;&#27;b" TYPE="LONG" INDX="1")"),
             ContainsSubstring("found \"a??b\""));
  const auto config = parse(
      "<ROOT><CONFIG><IP_NUMBER>1\n2</IP_NUMBER><PORT>1</PORT><SENTYPE>X</SENTYPE></CONFIG>"
      "<SEND/></ROOT>");
  for (const auto& warning : config.warnings) CHECK(warning.find('\n') == std::string::npos);
}

TEST_CASE("what a user should know but can run with is a warning", "[ethernet_config]") {
  const auto warnings = [](const std::string& settings, const std::string& sent) {
    std::string all;
    for (const auto& warning : parse(file(settings, sent)).warnings) all += warning + "\n";
    return all;
  };
  CHECK_THAT(warnings(kSettings, R"(<ELEMENT TAG="DiL" TYPE="LONG" INDX="1"/>)"),
             ContainsSubstring("eth.xml:3:1: SEND: no DEF_RIst") &&
                 ContainsSubstring("no DEF_AIPos") && ContainsSubstring("no DEF_Delay"));
  CHECK_THAT(warnings(kSettings, ""), ContainsSubstring("SEND: the list is empty"));
  CHECK_THAT(warnings(kSettings, kSent + "<Element/>"),
             ContainsSubstring("Element: expected ELEMENT"));
  CHECK_THAT(warnings(kSettings + "<PROTOCOL>TCP</PROTOCOL>", kSent),
             !ContainsSubstring("PROTOCOL"));
  CHECK_THAT(warnings(kSettings + "<PROTCOLLENGTH>On</PROTCOLLENGTH>", kSent),
             ContainsSubstring("PROTCOLLENGTH: On puts a length before each telegram"));
  CHECK_THAT(
      warnings(kSettings + "<PROTOCOL>TCP</PROTOCOL><PROTCOLLENGTH>On</PROTCOLLENGTH>", kSent),
      ContainsSubstring("PROTCOLLENGTH: On: how KUKA writes this length"));
  CHECK_THAT(warnings(kSettings + "<Port>1</Port>", kSent), ContainsSubstring("Port: unknown key"));
  CHECK_THAT(warnings("<PORT>1</PORT><SENTYPE>X</SENTYPE>", kSent),
             ContainsSubstring("ONLYSEND: expected TRUE or FALSE, found nothing") &&
                 ContainsSubstring("IP_NUMBER"));
  CHECK_THAT(parse("<ROOT><CONFIG>" + kSettings + "</CONFIG><SEND><ELEMENTS>" + kSent +
                   "</ELEMENTS></SEND></ROOT>")
                 .warnings.at(0),
             ContainsSubstring("RECEIVE: this section is missing"));

  CHECK_THAT(warnings_of_tag(R"(TAG="DEF_Foo" TYPE="LONG" INDX="INTERNAL")").at(0),
             ContainsSubstring("\"DEF_Foo\" is no internal tag"));
  CHECK_THAT(warnings_of_tag(R"(TAG="DEF_EStr" TYPE="STRING" INDX="3")").at(0),
             ContainsSubstring("INDX: expected INTERNAL"));
  CHECK_THAT(warnings_of_tag(R"(TAG="DiO" TYPE="LONG" INDX="INTERNAL")").at(0),
             ContainsSubstring("INDX"));
  CHECK_THAT(warnings_of_tag("TAG=\"a\" TYPE=\"LONG\" INDX=\"1\"/>\n"
                             "<ELEMENT TAG=\"a\" TYPE=\"LONG\" INDX=\"2\"")
                 .at(0),
             ContainsSubstring("eth.xml:7:1: TAG: \"a\" stands in line 6 already"));
}

TEST_CASE("without replies neither SENTYPE nor RECEIVE is needed", "[ethernet_config]") {
  const auto config = parse(
      "<ROOT><CONFIG><IP_NUMBER>10.0.0.5</IP_NUMBER><PORT>1</PORT><ONLYSEND>TRUE</ONLYSEND>"
      "</CONFIG><SEND><ELEMENTS>" +
      kSent + "</ELEMENTS></SEND></ROOT>");
  CHECK(config.only_send);
  CHECK(config.warnings.empty());
}

TEST_CASE("internal tags expand to the attributes that controllers send", "[ethernet_config]") {
  CHECK(layout_of({"DEF_RIst", "DEF_RSol"}) == "RIst(X,Y,Z,A,B,C,) RSol(X,Y,Z,A,B,C,) ");
  CHECK(layout_of({"DEF_AIPos", "DEF_ASPos"}) ==
        "AIPos(A1,A2,A3,A4,A5,A6,) ASPos(A1,A2,A3,A4,A5,A6,) ");
  CHECK(layout_of({"DEF_EIPos", "DEF_ESPos"}) ==
        "EIPos(E1,E2,E3,E4,E5,E6,) ESPos(E1,E2,E3,E4,E5,E6,) ");
  CHECK(layout_of({"DEF_MACur", "DEF_MECur"}) ==
        "MACur(A1,A2,A3,A4,A5,A6,) MECur(E1,E2,E3,E4,E5,E6,) ");
  CHECK(layout_of({"DEF_Delay", "DEF_EStr"}) == "Delay(D,) EStr(,) ");
  CHECK(layout_of({"DEF_Tech.C1"}) == "Tech(C11,C12,C13,C14,C15,C16,C17,C18,C19,C110,) ");
  CHECK(layout_of({"DEF_Tech.T2"}) == "Tech(T21,T22,T23,T24,T25,T26,T27,T28,T29,T210,) ");
}

TEST_CASE("dotted tags fold into the first occurrence of their element, others are text",
          "[ethernet_config]") {
  CHECK(layout_of({"Digout.o1", "DiL", "Digout.o2", "GPIO.01"}) ==
        "Digout(o1,o2,) DiL(,) GPIO(01,) ");
  CHECK(layout_of({"A.b.c"}) == "A(b.c,) ");
  CHECK(layout_of({"DiL", "DiL.x", "DiL", "DiL.x"}) == "DiL(,x,) ");
}

TEST_CASE("each error says what to do", "[ethernet_config]") {
  using Catch::Matchers::EndsWith;
  for (const auto& xml :
       {std::string("<html/>"), std::string("<ROOT><CONFIG/></ROOT>"),
        file(kSettings + "<PROTOCOL>SCTP</PROTOCOL>"), file("<PORT>1</PORT><PORT>2</PORT>"),
        file(kSettings, kSent, "<ELEMENT TAG=\"a\" TYPE=\"FLOAT\" INDX=\"1\"/>"),
        file(kSettings, kSent, "<TAG/>")})
    CHECK_THAT(error_of(xml), EndsWith(": correct it, here and on the controller") ||
                                  EndsWith(": add it, here and on the controller"));
  CHECK_THAT(error_of("<ROOT>\n<CONFIG>\n</CONFIX></ROOT>"),
             EndsWith(": correct it, or copy the file from the controller again"));
  CHECK_THAT(error_of(std::string("<\0R\0", 4)), EndsWith("found zero bytes: save it as UTF-8"));
  CHECK_THROWS_WITH(EthernetConfig::load("/nowhere/ethernet.xml"),
                    EndsWith(": check the path and the permissions"));
}

TEST_CASE("a file that cannot be read is named", "[ethernet_config]") {
  const auto folder = std::filesystem::temp_directory_path();
  for (const auto& file : {folder / "sweepd-no-such-file.xml", folder})
    CHECK_THROWS_WITH(EthernetConfig::load(file),
                      ContainsSubstring(file.string()) && ContainsSubstring("cannot be read"));
}

TEST_CASE("the shipped Ethernet file is without fault and receives no correction",
          "[ethernet_config]") {
  const auto config = EthernetConfig::load(std::filesystem::path(SWEEPD_SOURCE_DIR) /
                                           "config/controller/krc4/sweepd_ethernet.xml");
  CHECK(config.warnings.empty());
  CHECK(config.ip_number == "192.168.1.10");
  CHECK(config.port == 49152);
  CHECK(printed(rsi::wire_layout(config.send)) ==
        "RIst(X,Y,Z,A,B,C,) RSol(X,Y,Z,A,B,C,) AIPos(A1,A2,A3,A4,A5,A6,) "
        "ASPos(A1,A2,A3,A4,A5,A6,) MACur(A1,A2,A3,A4,A5,A6,) Delay(D,) ");
  CHECK(printed(rsi::wire_layout(config.receive)) == "EStr(,) ");
}

TEST_CASE("every tag but an internal string is a command", "[ethernet_config][issue11][point_1]") {
  const auto config = parse(file(kSettings, kSent,
                                 R"(<ELEMENT TAG="DEF_EStr" TYPE="STRING" INDX="INTERNAL"/>
<ELEMENT TAG="RKorr.X" TYPE="DOUBLE" INDX="1"/>
<ELEMENT TAG="DEF_Tech.T2" TYPE="DOUBLE" INDX="INTERNAL"/>
<ELEMENT TAG="OvProW" TYPE="LONG" INDX="2"/>
<ELEMENT TAG="Stop" TYPE="BOOL" INDX="3"/>
<ELEMENT TAG="Stop" TYPE="BOOL" INDX="3"/>
<ELEMENT TAG="DEF_Tech.T3" TYPE="STRING" INDX="INTERNAL"/>
<ELEMENT TAG="Fed" TYPE="STRING" INDX="4"/>
<ELEMENT TAG="Note" TYPE="STRING" INDX="INTERNAL"/>)"));
  std::string commands;
  for (const auto& element : config.commands())
    commands += element.tag + ":" + std::to_string(element.line) + " ";
  CHECK(commands == "RKorr.X:7 DEF_Tech.T2:8 OvProW:9 Stop:10 DEF_Tech.T3:12 Fed:13 ");
}

TEST_CASE("a tag that a controller would not take as it stands is warned about",
          "[ethernet_config][issue11][point_2]") {
  const auto [tags, said] = GENERATE(table<std::string, std::string>(
      {{R"(<ELEMENT TAG="a" TYPE="BOOL" INDX="5"/><ELEMENT TAG="b" TYPE="BOOL" INDX="5"/>)",
        R"(INDX: channel 5 is that of "a" already: give each tag a channel of its own)"},
       {R"(<ELEMENT TAG="DEF_Tech.T1" TYPE="DOUBLE" INDX="INTERNAL"/>)", "function generator 1"},
       {R"(<ELEMENT TAG="DEF_RIst" TYPE="DOUBLE" INDX="INTERNAL"/>)",
        R"("DEF_RIst" is measured by the controller and cannot be received)"},
       {R"(<ELEMENT TAG="DEF_EStr" TYPE="LONG" INDX="INTERNAL"/>)",
        R"(TYPE: expected STRING for "DEF_EStr", found LONG)"}}));
  const auto warnings = parse(file(kSettings, kSent, tags)).warnings;
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], Catch::Matchers::StartsWith("eth.xml:6:") && ContainsSubstring(said));
}

TEST_CASE("positions as whole numbers, and two tags on one channel, are warned about in SEND too",
          "[ethernet_config][issue11][point_2]") {
  auto sent =
      kSent + R"(<ELEMENT TAG="a" TYPE="BOOL" INDX="5"/><ELEMENT TAG="b" TYPE="BOOL" INDX="5"/>)";
  sent.replace(sent.find("DOUBLE"), 6, "LONG");
  const auto warnings = parse(file(kSettings, sent)).warnings;
  REQUIRE(warnings.size() == 2);
  CHECK_THAT(warnings[0], ContainsSubstring(R"(TYPE: expected DOUBLE for "DEF_RIst", found LONG)"));
  CHECK_THAT(warnings[1], ContainsSubstring("INDX: channel 5"));
}

TEST_CASE("a file larger than any Ethernet file is refused before it is read",
          "[ethernet_config][issue11][point_2]") {
  CHECK_THAT(error_of(file(kSettings) + std::string(1 << 20, ' ')),
             ContainsSubstring("eth.xml: expected an RSI Ethernet file of at most 1 MiB"));
  CHECK_THROWS_WITH(EthernetConfig::load("/dev/zero"),
                    ContainsSubstring("/dev/zero: expected an RSI Ethernet file of at most 1 MiB"));
}
