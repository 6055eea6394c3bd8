#include "rsi/rsi_context.hpp"

#include <filesystem>

#include "tests/catch.hpp"

using Catch::Matchers::ContainsSubstring;
using rsi::EthernetConfig;
using rsi::RsiContext;

namespace {

const std::filesystem::path kKrc4 =
    std::filesystem::path(SWEEPD_SOURCE_DIR) / "config/controller/krc4";

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += line + '\n';
  return text;
}

/// In the form of RSI 3; channels count from 1.
std::string rsi3(const std::string& parameters, const std::string& others = "",
                 const std::string& inputs = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n<RSIObjects>\n" + others +
         "<RSIObject ObjType=\"ETHERNET\" ObjTypeID=\"64\" ObjID=\"ETHERNET1\">\n<Inputs>" +
         inputs + "</Inputs>\n<Parameters>\n" + parameters +
         "</Parameters>\n</RSIObject>\n</RSIObjects>\n";
}

/// In the form of RSI 4; channels count from 0.
std::string rsi4(const std::string& parameters, const std::string& others = "") {
  return "\xef\xbb\xbf<RsiContext SchemaVersion=\"2.0.0\" xmlns=\"RsiContext\">\n<RsiObjects "
         "xmlns=\"RsiDriver\">\n<RsiObject ObjTypeId=\"64\" ObjType=\"Ethernet\" "
         "ObjId=\"Ethernet_1\">\n<Parameters>\n" +
         parameters + "</Parameters>\n</RsiObject>\n" + others +
         "</RsiObjects>\n<BlueprintCollections/>\n</RsiContext>\n";
}

const std::string kGood =
    "<Parameter Name=\"ConfigFile\" ParamID=\"1\" ParamValue=\"eth.xml\" IsRuntime=\"false\" />\n"
    "<Parameter Name=\"Timeout\" ParamID=\"1\" ParamValue=\"100\" />\n"
    "<Parameter Name=\"Precision\" ParamID=\"8\" ParamValue=\"4\" />\n";

std::string taken(const std::string& type, int index) {
  return "<RSIObject ObjType=\"" + type + "\" ObjID=\"" + type +
         "1\">\n<Inputs>\n<Input InIdx=\"1\" "
         "OutObjID=\"ETHERNET1\" OutIdx=\"" +
         std::to_string(index) + "\" />\n</Inputs>\n</RSIObject>\n";
}

RsiContext parse(const std::string& xml) {
  return RsiContext::parse(xml, "a.rsi.xml");
}

std::string error_of(const std::string& xml) {
  try {
    static_cast<void>(parse(xml));
    return "no error";
  } catch (const rsi::RsiContextError& error) {
    return error.what();
  }
}

EthernetConfig ethernet(const std::string& sent, const std::string& received,
                        const std::string& name = "/somewhere/eth.xml") {
  return EthernetConfig::parse(
      "<ROOT><CONFIG><IP_NUMBER>10.0.0.5</IP_NUMBER><PORT>49152</PORT><SENTYPE>ImFree</SENTYPE>"
      "<ONLYSEND>FALSE</ONLYSEND></CONFIG><SEND><ELEMENTS>" +
          sent + "</ELEMENTS></SEND><RECEIVE><ELEMENTS>" + received +
          "</ELEMENTS></RECEIVE></ROOT>",
      name);
}

}  // namespace

TEST_CASE("a context of RSI 3 and one of RSI 4 say the same of the link") {
  const auto [xml, form] = GENERATE(table<std::string, RsiContext::Form>(
      {{rsi3(kGood), RsiContext::Form::xml}, {rsi4(kGood), RsiContext::Form::rsix}}));
  const auto context = parse(xml);
  CHECK(context.form == form);
  CHECK(context.config_file == "eth.xml");
  CHECK(context.precision == 4);
  CHECK(context.timeout == 100);
  CHECK(context.receivers.empty());
  CHECK(joined(context.warnings) == "");
  CHECK(joined(context.compare(ethernet("", ""))) == "");
}

TEST_CASE("the shipped contexts name the shipped Ethernet files and cannot move the robot") {
  const auto [context_file, ethernet_file] =
      GENERATE(table<std::string, std::string>({{"sweepd.rsi.xml", "sweepd_ethernet.xml"},
                                                {"sweepd.rsix", "sweepd_ethernet.xml"},
                                                {"sweepd_onlysend.rsi.xml", "sweepd_onlysend.xml"},
                                                {"sweepd_onlysend.rsix", "sweepd_onlysend.xml"}}));
  const auto context = RsiContext::load(kKrc4 / context_file);
  CHECK(context.config_file == ethernet_file);
  CHECK(context.precision == 4);
  CHECK(context.timeout == 100);
  CHECK(context.receivers.empty());
  CHECK(joined(context.warnings) == "");
  CHECK(joined(context.compare(EthernetConfig::load(kKrc4 / ethernet_file))) == "");
}

TEST_CASE("too few decimals are warned about, and none said is one") {
  const auto [precision, found] = GENERATE(table<std::string, std::string>(
      {{"<Parameter Name=\"Precision\" ParamValue=\"1\"/>", "found 1:"},
       {"<Parameter Name=\"Precision\" ParamValue=\"3\"/>", "found 3:"},
       {"", "found nothing, which is 1:"}}));
  const auto context =
      parse(rsi3("<Parameter Name=\"ConfigFile\" ParamValue=\"e.xml\"/>" + precision));
  CHECK_THAT(joined(context.warnings),
             Catch::Matchers::StartsWith("a.rsi.xml:3:1: Precision: expected 4 or more, " + found));
}

TEST_CASE("an object that turns what is received into motion is warned about") {
  const auto type = GENERATE(as<std::string>(), "AXISCORR", "POSCORR", "AxisCorrExt", "Map2OV_PRO");
  const auto context = parse(rsi3(kGood, taken(type, 1)));
  REQUIRE(context.receivers.size() == 1);
  CHECK(context.receivers[0].moves);
  CHECK(context.receivers[0].channel == 1);
  CHECK_THAT(joined(context.warnings),
             ContainsSubstring("a.rsi.xml:5:1: " + type + " takes what is received and can move"));
}

TEST_CASE("an object that cannot move the robot may take what is received") {
  const auto context = parse(rsi3(kGood, taken("MAP2DIGOUT", 2)));
  REQUIRE(context.receivers.size() == 1);
  CHECK_FALSE(context.receivers[0].moves);
  CHECK(joined(context.warnings) == "");
}

TEST_CASE("channels count from 1 in both forms") {
  const auto four = parse(rsi4(kGood,
                               "<RsiObject ObjType=\"Stop\" ObjId=\"S\"><Inputs><Input InIdx=\"0\" "
                               "OutObjId=\"Ethernet_1\" OutIdx=\"0\"/></Inputs></RsiObject>"));
  REQUIRE(four.receivers.size() == 1);
  CHECK(four.receivers[0].channel == 1);
  const auto three =
      parse(rsi3(kGood, "", "<Input InIdx=\"5\" OutObjID=\"SOURCE1\" OutIdx=\"1\"/>"));
  CHECK(three.fed == std::vector<int>{5});
}

TEST_CASE("context and Ethernet file are held against each other") {
  const std::string sent = "<ELEMENT TAG=\"Source\" TYPE=\"DOUBLE\" INDX=\"5\"/>";
  const std::string received = "<ELEMENT TAG=\"Out\" TYPE=\"BOOL\" INDX=\"2\"/>";
  const std::string input = "<Input InIdx=\"5\" OutObjID=\"SOURCE1\" OutIdx=\"1\"/>";
  const auto context = parse(rsi3(kGood, taken("MAP2DIGOUT", 2), input));
  CHECK(joined(context.compare(ethernet(sent, received))) == "");
  CHECK_THAT(
      joined(context.compare(ethernet(sent, received, "other.xml"))),
      ContainsSubstring("ConfigFile: expected other.xml") && ContainsSubstring("found eth.xml"));
  CHECK_THAT(joined(context.compare(ethernet(sent, ""))),
             ContainsSubstring("MAP2DIGOUT1 takes channel 2, which no tag in RECEIVE"));
  CHECK_THAT(joined(parse(rsi3(kGood)).compare(ethernet(sent, received))),
             ContainsSubstring("Source: nothing feeds input 5"));
}

TEST_CASE("what is no context is refused with its place and a remedy") {
  CHECK_THAT(error_of(""), ContainsSubstring("a.rsi.xml:1:1: expected an RSI context in XML"));
  CHECK_THAT(error_of("<ROOT/>"), ContainsSubstring("found <ROOT>: give the .rsi.xml"));
  CHECK_THAT(error_of("<rSIModel><rSIObjects/></rSIModel>"),
             ContainsSubstring("found the editor's model: give the .rsi.xml beside it"));
  CHECK_THAT(error_of("<RSIObjects/>"), ContainsSubstring("expected an object of type ETHERNET"));
  CHECK_THAT(error_of("<RSIObjects>\n<RSIObject"), ContainsSubstring("a.rsi.xml:2:"));
  CHECK_THAT(error_of(rsi3("<Parameter Name=\"Precision\" ParamValue=\"four\"/>")),
             ContainsSubstring("Precision: expected a whole number, found \"four\""));
  CHECK_THAT(error_of(rsi3(kGood, taken("STOP", 65))),
             ContainsSubstring("OutIdx: expected a channel from 1 to 64, found \"65\""));
  CHECK_THAT(error_of(std::string("<RSIObjects>\0</RSIObjects>", 26)),
             ContainsSubstring("zero bytes"));
  CHECK_THROWS_WITH(RsiContext::load("/nowhere/a.rsix"), ContainsSubstring("cannot be read"));
}

TEST_CASE("a context without the name of its Ethernet file, or with two, is warned about") {
  CHECK_THAT(joined(parse(rsi3("<Parameter Name=\"Precision\" ParamValue=\"4\"/>")).warnings),
             ContainsSubstring("ConfigFile: not set"));
  CHECK_THAT(joined(parse(rsi3(kGood, "<RSIObject ObjType=\"ETHERNET\" ObjID=\"E2\"><Parameters>" +
                                          kGood + "</Parameters></RSIObject>"))
                        .warnings),
             ContainsSubstring("a second Ethernet object"));
}
