#include "rsi/telegram/rsi_context.hpp"

#include <filesystem>

#include "tests/catch.hpp"
#include "tests/rsi/lines.hpp"

using Catch::Matchers::ContainsSubstring;
using rsi::EthernetConfig;
using rsi::RsiContext;
using rsi::test::joined;

namespace {

const std::filesystem::path kKrc4 =
    std::filesystem::path(SWEEPD_SOURCE_DIR) / "config/controller/krc4";

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

/// TYPE1, which takes the first output of each of these.
std::string object(const std::string& type, const std::vector<std::string>& sources) {
  std::string text = "<RSIObject ObjType=\"" + type + "\" ObjID=\"" + type + "1\">\n<Inputs>\n";
  for (const auto& source : sources)
    text += "<Input InIdx=\"1\" OutObjID=\"" + source + "\" OutIdx=\"1\" />\n";
  return text + "</Inputs>\n</RSIObject>\n";
}

RsiContext parsed_context(const std::string& xml) {
  return RsiContext::parse(xml, "a.rsi.xml");
}

std::string context_error(const std::string& xml) {
  try {
    static_cast<void>(parsed_context(xml));
    return "no error";
  } catch (const rsi::RsiContextError& error) {
    return error.what();
  }
}

EthernetConfig ethernet_with(const std::string& sent, const std::string& received,
                             const std::string& name = "/somewhere/eth.xml") {
  return EthernetConfig::parse(
      "<ROOT><CONFIG><IP_NUMBER>10.0.0.5</IP_NUMBER><PORT>49152</PORT><SENTYPE>ImFree</SENTYPE>"
      "<ONLYSEND>FALSE</ONLYSEND></CONFIG><SEND><ELEMENTS>" +
          sent + "</ELEMENTS></SEND><RECEIVE><ELEMENTS>" + received +
          "</ELEMENTS></RECEIVE></ROOT>",
      name);
}

}  // namespace

TEST_CASE("a context of RSI 3 and one of RSI 4 say the same of the link", "[rsi_context]") {
  const auto [xml, form] = GENERATE(table<std::string, RsiContext::Form>(
      {{rsi3(kGood), RsiContext::Form::xml}, {rsi4(kGood), RsiContext::Form::rsix}}));
  const auto context = parsed_context(xml);
  CHECK(context.form == form);
  CHECK(context.config_file == "eth.xml");
  CHECK(context.precision == 4);
  CHECK(context.timeout == 100);
  CHECK(context.receivers.empty());
  CHECK(joined(context.warnings) == "");
  CHECK(joined(context.compare(ethernet_with("", ""))) == "");
}

TEST_CASE("the shipped contexts name the shipped Ethernet files and cannot move the robot",
          "[rsi_context]") {
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
  CHECK(context.actors.empty());
  CHECK(joined(context.warnings) == "");
  CHECK(joined(context.compare(EthernetConfig::load(kKrc4 / ethernet_file))) == "");
}

TEST_CASE("too few decimals are warned about, and none said is one", "[rsi_context]") {
  const auto [precision, found] = GENERATE(table<std::string, std::string>(
      {{"<Parameter Name=\"Precision\" ParamValue=\"1\"/>", "found 1:"},
       {"<Parameter Name=\"Precision\" ParamValue=\"3\"/>", "found 3:"},
       {"", "found nothing, which is 1:"}}));
  const auto context =
      parsed_context(rsi3("<Parameter Name=\"ConfigFile\" ParamValue=\"e.xml\"/>" + precision));
  CHECK_THAT(joined(context.warnings),
             Catch::Matchers::StartsWith("a.rsi.xml:3:1: Precision: expected 4 or more, " + found));
}

TEST_CASE("an object that can act is warned about, once, with what it can do",
          "[rsi_context][issue11][point_2]") {
  const auto [type, effect] = GENERATE(table<std::string, std::string>(
      {{"AXISCORR", "can move the robot"},
       {"POSCORR", "can move the robot"},
       {"AxisCorrExt", "can move the robot"},
       {"Map2OV_PRO", "sets the speed of the robot's program"},
       {"MAP2DIGOUT", "sets an output"},
       {"SetDigOut", "sets an output"},
       {"Map2AnOut", "sets an output"},
       {"Map2Sen_PRea", "writes a variable that the robot's program may act on"},
       {"WIDGET", "is an object that sweepd does not know"}}));
  const auto context = parsed_context(rsi3(kGood, taken(type, 1)));
  REQUIRE(context.receivers.size() == 1);
  CHECK(context.receivers[0].channel == 1);
  REQUIRE(context.actors.size() == 1);
  CHECK(context.actors[0].id == type + "1");
  CHECK(context.actors[0].path == "ETHERNET1 -> " + type + "1");
  REQUIRE(context.warnings.size() == 1);
  CHECK_THAT(context.warnings[0],
             Catch::Matchers::StartsWith("a.rsi.xml:3:1: " + type + "1 (" + type + ") " + effect) &&
                 ContainsSubstring("fed by ETHERNET1 -> " + type + "1: leave it out"));
}

TEST_CASE("an object that can act is found whatever lies before it",
          "[rsi_context][issue11][point_2]") {
  const auto [others, path] = GENERATE(table<std::string, std::string>({
      {object("LIMIT", {"ETHERNET1"}) + object("POSCORR", {"LIMIT1"}),
       "ETHERNET1 -> LIMIT1 -> POSCORR1"},
      {object("MULTI", {"SOURCE1", "ETHERNET1"}) + object("SOURCE", {}) +
           object("AXISCORREXT", {"MULTI1"}),
       "ETHERNET1 -> MULTI1 -> AXISCORREXT1"},
      {object("SOURCE", {}) + object("POSCORR", {"SOURCE1"}), "SOURCE1 -> POSCORR1"},
      {object("POSCORR", {}), "POSCORR1"},
      {object("SUM", {"DELAY1"}) + object("DELAY", {"SUM1"}) + object("AXISCORR", {"DELAY1"}),
       "SUM1 -> DELAY1 -> AXISCORR1"},
      {object("AXISCORR", {"AXISCORR1", "ETHERNET1"}), "ETHERNET1 -> AXISCORR1"},
      {object("LIMIT", {"ethernet1"}) + object("MAP2DIGOUT", {"Limit1", "LIMIT1", "LIMIT1"}),
       "ETHERNET1 -> LIMIT1 -> MAP2DIGOUT1"},
      {object("ABS", {"ETHERNET1"}) + object("CEIL", {"ABS1"}) + object("EXP", {"CEIL1"}) +
           object("FLOOR", {"EXP1"}) + object("SIN", {"FLOOR1"}) + object("COS", {"SIN1"}) +
           object("TAN", {"COS1"}) + object("I", {"TAN1"}) + object("POSCORR", {"I1"}),
       "ETHERNET1 -> ... -> EXP1 -> FLOOR1 -> SIN1 -> COS1 -> TAN1 -> I1 -> POSCORR1"},
  }));
  const auto context = parsed_context(rsi3(kGood, others));
  REQUIRE(context.actors.size() == 1);
  CHECK(context.actors[0].path == path);
  CHECK(context.warnings.size() == 1);
  CHECK(parsed_context(rsi4(kGood, object("LIMIT", {"Ethernet_1"}) + object("PosCorr", {"LIMIT1"})))
            .actors.at(0)
            .path == "Ethernet_1 -> LIMIT1 -> PosCorr1");
}

TEST_CASE("an object is what the controller takes it for, by the number of its type",
          "[rsi_context][issue11][point_2]") {
  const auto context = parsed_context(rsi3(
      kGood, "<RSIObject ObjType=\"LIMIT\" ObjTypeID=\"27\" ObjID=\"HARMLESS\"></RSIObject>\n"));
  REQUIRE(context.actors.size() == 1);
  CHECK(context.actors[0].effect == rsi::RsiEffect::moves);
}

TEST_CASE("objects that are grouped are found, and links that lead nowhere are warned about",
          "[rsi_context][issue11][point_2]") {
  const auto context = parsed_context(rsi3(kGood, "<Group>" + object("POSCORR", {"GONE1"}) +
                                                      object("LIMIT", {"ETHERNET1"}) +
                                                      object("LIMIT", {}) + "</Group>"));
  CHECK(context.actors.size() == 1);
  CHECK_THAT(joined(context.warnings),
             ContainsSubstring("POSCORR1 takes a signal of \"GONE1\", which is no object here") &&
                 ContainsSubstring("\"LIMIT1\" is the name of another object already"));
}

TEST_CASE("an object without a name is named as that", "[rsi_context][issue11][point_2]") {
  const auto context = parsed_context(rsi3(kGood, "<RSIObject ObjType=\"POSCORR\"/>\n"));
  REQUIRE(context.actors.size() == 1);
  CHECK(context.actors[0].path == "(no name)");
  CHECK_THAT(joined(context.warnings),
             ContainsSubstring(" (no name) (POSCORR) can move the robot"));
}

TEST_CASE("a context of nothing but objects that act is read in time",
          "[rsi_context][issue11][point_2]") {
  std::string chain = object("SUM", {"ETHERNET1"});
  for (int i = 2; i < 5000; ++i)
    chain += "<RSIObject ObjType=\"POSCORR\" ObjID=\"P" + std::to_string(i) +
             "\"><Inputs><Input InIdx=\"1\" OutObjID=\"P" + std::to_string(i - 1) +
             "\" OutIdx=\"1\"/></Inputs></RSIObject>\n";
  CHECK(parsed_context(rsi3(kGood, chain)).actors.size() == 4998);
  std::string many;
  for (int i = 0; i < 10'000; ++i) many += "<RSIObject ObjType=\"SUM\"/>";
  CHECK_THAT(context_error(rsi3(kGood, many)), ContainsSubstring("expected at most 10000 objects"));
}

TEST_CASE("an object that can only stop, show or limit is nothing to warn about", "[rsi_context]") {
  const auto type = GENERATE(as<std::string>(), "STOP", "MONITOR", "POSCORRMON", "LIMIT");
  const auto context = parsed_context(rsi3(kGood, taken(type, 2)));
  CHECK(context.receivers.size() == 1);
  CHECK(context.actors.empty());
  CHECK(joined(context.warnings) == "");
}

TEST_CASE("channels count from 1 in both forms", "[rsi_context]") {
  const auto four =
      parsed_context(rsi4(kGood,
                          "<RsiObject ObjType=\"Stop\" ObjId=\"S\"><Inputs><Input InIdx=\"0\" "
                          "OutObjId=\"Ethernet_1\" OutIdx=\"0\"/></Inputs></RsiObject>"));
  REQUIRE(four.receivers.size() == 1);
  CHECK(four.receivers[0].channel == 1);
  const auto three =
      parsed_context(rsi3(kGood, "", "<Input InIdx=\"5\" OutObjID=\"SOURCE1\" OutIdx=\"1\"/>"));
  CHECK(three.fed == std::vector<int>{5});
}

TEST_CASE("context and Ethernet file are held against each other", "[rsi_context]") {
  const std::string sent = "<ELEMENT TAG=\"Source\" TYPE=\"DOUBLE\" INDX=\"5\"/>";
  const std::string received = "<ELEMENT TAG=\"Out\" TYPE=\"BOOL\" INDX=\"2\"/>";
  const std::string input = "<Input InIdx=\"5\" OutObjID=\"SOURCE1\" OutIdx=\"1\"/>";
  const auto context = parsed_context(rsi3(kGood, taken("DIGOUT", 2), input));
  CHECK(joined(context.compare(ethernet_with(sent, received))) == "");
  CHECK_THAT(
      joined(context.compare(ethernet_with(sent, received, "other.xml"))),
      ContainsSubstring("ConfigFile: expected other.xml") && ContainsSubstring("found eth.xml"));
  CHECK_THAT(joined(context.compare(ethernet_with(sent, ""))),
             ContainsSubstring("DIGOUT1 takes channel 2, which no tag in RECEIVE"));
  CHECK_THAT(joined(parsed_context(rsi3(kGood)).compare(ethernet_with(sent, received))),
             ContainsSubstring("Source: nothing feeds input 5"));
}

TEST_CASE("what is no context is refused with its place and a remedy", "[rsi_context]") {
  CHECK_THAT(context_error(""), ContainsSubstring("a.rsi.xml:1:1: expected an RSI context in XML"));
  CHECK_THAT(context_error("<ROOT/>"), ContainsSubstring("found <ROOT>: give the .rsi.xml"));
  CHECK_THAT(context_error("<rSIModel><rSIObjects/></rSIModel>"),
             ContainsSubstring("found the editor's model: give the .rsi.xml beside it"));
  CHECK_THAT(context_error("<RSIObjects/>"),
             ContainsSubstring("expected an object of type ETHERNET"));
  CHECK_THAT(context_error("<RSIObjects>\n<RSIObject"), ContainsSubstring("a.rsi.xml:2:"));
  CHECK_THAT(context_error(rsi3("<Parameter Name=\"Precision\" ParamValue=\"four\"/>")),
             ContainsSubstring("Precision: expected a whole number, found \"four\""));
  CHECK_THAT(context_error(rsi3(kGood, taken("STOP", 65))),
             ContainsSubstring("OutIdx: expected a channel from 1 to 64, found \"65\""));
  CHECK_THAT(context_error(std::string("<RSIObjects>\0</RSIObjects>", 26)),
             ContainsSubstring("zero bytes"));
  CHECK_THROWS_WITH(RsiContext::load("/nowhere/a.rsix"), ContainsSubstring("cannot be read"));
  CHECK_THROWS_WITH(RsiContext::load("/dev/zero"), ContainsSubstring("at most 16 MiB, found more"));
}

TEST_CASE("a context without the name of its Ethernet file, or with two, is warned about",
          "[rsi_context]") {
  CHECK_THAT(
      joined(parsed_context(rsi3("<Parameter Name=\"Precision\" ParamValue=\"4\"/>")).warnings),
      ContainsSubstring("ConfigFile: not set"));
  CHECK_THAT(joined(parsed_context(
                        rsi3(kGood, "<RSIObject ObjType=\"ETHERNET\" ObjID=\"E2\"><Parameters>" +
                                        kGood + "</Parameters></RSIObject>"))
                        .warnings),
             ContainsSubstring("a second Ethernet object"));
}
