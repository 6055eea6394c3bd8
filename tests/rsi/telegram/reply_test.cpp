#include "rsi/telegram/reply.hpp"

#include <random>
#include <utility>

#include "rsi/telegram/correction_gate.hpp"
#include "tests/catch.hpp"

using rsi::EthernetConfig;
using Type = EthernetConfig::Element::Type;

namespace {

EthernetConfig config_with(const std::vector<std::pair<std::string, Type>>& receive,
                           std::string sentype = "ImFree") {
  EthernetConfig config;
  config.sentype = std::move(sentype);
  for (const auto& [tag, type] : receive) config.receive.push_back({tag, type, 1, false, 0});
  return config;
}

// What a controller with axis corrections, technology parameters and outputs asks for.
const std::vector<std::pair<std::string, Type>> kMuch = {
    {"DEF_EStr", Type::STRING}, {"DEF_Tech.T2", Type::DOUBLE}, {"AKorr.A1", Type::DOUBLE},
    {"AKorr.A2", Type::DOUBLE}, {"FREE", Type::LONG},          {"GPIO.01", Type::BOOL},
    {"RKorr.X", Type::DOUBLE},  {"Stop", Type::BOOL}};

}  // namespace

TEST_CASE("a reply has a zero for every received tag in its order, and echoes the IPOC",
          "[reply]") {
  rsi::Reply reply(config_with(kMuch));
  CHECK(reply.with_ipoc("1525084") ==
        "<Sen Type=\"ImFree\"><EStr></EStr>"
        "<Tech T21=\"0.0\" T22=\"0.0\" T23=\"0.0\" T24=\"0.0\" T25=\"0.0\" T26=\"0.0\" "
        "T27=\"0.0\" T28=\"0.0\" T29=\"0.0\" T210=\"0.0\"/><AKorr A1=\"0.0\" A2=\"0.0\"/>"
        "<FREE>0</FREE><GPIO 01=\"0\"/><RKorr X=\"0.0\"/><Stop>0</Stop>"
        "<IPOC>1525084</IPOC></Sen>");
}

TEST_CASE("one reply serves telegram after telegram, whatever the length of the IPOC", "[reply]") {
  rsi::Reply reply("KMC");
  for (const std::string ipoc : {"1", "18446744073709551615", "0000004", "237433", "7"})
    CHECK(reply.with_ipoc(ipoc) == "<Sen Type=\"KMC\"><IPOC>" + ipoc + "</IPOC></Sen>");
  const char* buffer = reply.with_ipoc("1").data();
  CHECK(reply.with_ipoc("18446744073709551615").data() == buffer);
}

TEST_CASE("the answer to a wrapped telegram is wrapped, passes the gate and is understood",
          "[reply][issue11][point_20]") {
  const auto config = config_with(kMuch);
  rsi::Reply reply(config);
  const std::string flat(reply.with_ipoc("1525084"));
  const std::string wrapped(reply.with_ipoc("1525084", rsi::Form::wrapped));
  const auto begin = flat.find('>') + 1;
  const auto end = flat.rfind("</Sen>");
  CHECK(wrapped == flat.substr(0, begin) + "<Dat TaskType=\"b\">" +
                       flat.substr(begin, end - begin) + "</Dat></Sen>");
  CHECK(rsi::moves_nothing(wrapped));
  const auto content = rsi::ReplyCheck(config).read(wrapped);
  CHECK(content.malformed.empty());
  CHECK(content.right_type);
  CHECK(content.ipoc == 1525084);
  CHECK(content.missing.empty());
  CHECK(content.not_zero.empty());
  CHECK(reply.with_ipoc("1525084") == flat);
  // Every damaged byte that makes a value is seen.
  for (const auto* moving :
       {"<Dat TaskType=\"1\">", "<Dat TaskType=\"b\" X=\"1\">", "<Dat TaskType=\"b\"><X>1</X>"}) {
    auto damaged = wrapped;
    damaged.replace(begin, std::string("<Dat TaskType=\"b\">").size(), moving);
    CHECK_FALSE(rsi::moves_nothing(damaged));
  }
  CHECK_FALSE(rsi::moves_nothing("<Sen Type=\"A\"><Dat TaskType=\"b\"><IPOC>1</IPOC></Sen>"));
  CHECK_FALSE(rsi::moves_nothing("<Sen Type=\"A\"><IPOC>1</IPOC></Dat></Sen>"));
}

TEST_CASE("the form of a telegram is told by its first bytes", "[reply][issue11][point_20]") {
  using rsi::Form;
  CHECK(rsi::form_of("<Rob Type=\"KUKA\">\n\t<Dat TaskType=\"b\">") == Form::wrapped);
  CHECK(rsi::form_of("<rob><dat  tasktype='b'>") == Form::wrapped);
  for (const auto* flat : {"", "<", "<Dat", "<Dat ", "<Rob Type=\"KUKA\"><Data TaskType=\"b\"/>",
                           "<Rob Type=\"KUKA\"><Dat A=\"1\"/><IPOC>1</IPOC></Rob>"})
    CHECK(rsi::form_of(flat) == Form::flat);
}

TEST_CASE("there is no reply without an IPOC, or to one that no controller sends", "[reply]") {
  rsi::Reply reply("ImFree");
  CHECK(reply.with_ipoc("").empty());
  CHECK(reply.with_ipoc("123456789012345678901").empty());
  CHECK(reply.with_ipoc("5") == "<Sen Type=\"ImFree\"><IPOC>5</IPOC></Sen>");
}

TEST_CASE("a SENTYPE that XML reserves characters of is escaped, and understood again", "[reply]") {
  const auto config = config_with({}, "A&\"<B>");
  const std::string reply(rsi::Reply(config).with_ipoc("1"));
  CHECK(reply == "<Sen Type=\"A&amp;&quot;&lt;B&gt;\"><IPOC>1</IPOC></Sen>");
  CHECK(rsi::ReplyCheck(config).read(reply).right_type);
}

TEST_CASE("a reply never contains a correction that is not zero", "[reply]") {
  // The receive lists are random, the check is the controller's; seed 11.
  std::mt19937_64 random(11);
  const std::vector<std::string> tags = {"RKorr.X", "RKorr.A", "AKorr.A1",    "AK.A6",
                                         "DiO",     "GPIO.01", "DEF_Tech.T2", "DEF_Tech.C6",
                                         "SenP1",   "Stop",    "DEF_EStr",    "DEF_Foo"};
  for (int round = 0; round < 300; ++round) {
    std::vector<std::pair<std::string, Type>> receive;
    for (const auto& tag : tags)
      if (random() % 2 == 0) receive.emplace_back(tag, static_cast<Type>(random() % 4));
    const auto config = config_with(receive);
    const auto ipoc = random();
    rsi::Reply reply(config);
    const auto text = reply.with_ipoc(std::to_string(ipoc));
    const auto content = rsi::ReplyCheck(config).read(text);
    CAPTURE(text);
    CHECK(content.malformed.empty());
    CHECK(content.right_type);
    CHECK(content.ipoc == ipoc);
    CHECK(content.missing.empty());
    CHECK(content.not_zero.empty());
    // And without trust in the check: between the quotation marks and tags of the values stands no
    // digit but 0.
    const auto values = text.substr(text.find('>') + 1, text.find("<IPOC>") - text.find('>') - 1);
    bool in_value = false;
    for (const char c : values) {
      if (c == '"') in_value = !in_value;
      if (in_value) CHECK((c < '1' || c > '9'));
    }
  }
}

TEST_CASE("a controller finds a missing tag and a correction, numeric names included", "[reply]") {
  const auto config = config_with({{"GPIO.01", Type::BOOL},
                                   {"GPIO.02", Type::BOOL},
                                   {"AK.A1", Type::DOUBLE},
                                   {"EStr", Type::STRING}});
  const rsi::ReplyCheck check(config);
  const auto read = [&](const std::string& inside) {
    return check.read("<Sen Type=\"ImFree\">" + inside + "<IPOC>7</IPOC></Sen>");
  };
  const std::string rest = "<AK A1=\"0.0\"/><EStr></EStr>";

  const auto good = read("<GPIO 01=\"0\" 02='-0'/>" + rest);
  CHECK(good.malformed.empty());
  CHECK(good.missing.empty());
  CHECK(good.not_zero.empty());
  CHECK(good.ipoc == 7);

  CHECK(read("<GPIO 01=\"0\"/>" + rest).missing == "GPIO.02");
  CHECK(read("<GPIO 01=\"0\" 02=\"0\"/><EStr/>").missing == "AK.A1");
  CHECK(read("<GPIO 01=\"0\" 02=\"1\"/>" + rest).not_zero == "GPIO.02 = 1");
  CHECK(read("<GPIO 01=\"0\" 02=\"0\"/><AK A1=\"1e-9\"/><EStr>hello</EStr>").not_zero ==
        "AK.A1 = 1e-9");
  // A second value for a tag does not hide behind the first.
  CHECK(read("<GPIO 01=\"0\" 02=\"0\"/>" + rest + "<AK A1=\"2\"/>").not_zero == "AK.A1 = 2");
  CHECK(read("<GPIO 01=\"0\" 02=\"0\"/><AK A1=\"none\"/>").malformed == "no number: AK.A1 = none");
}

TEST_CASE("blanks, line breaks, comments, other elements and trailing zeros are accepted",
          "[reply]") {
  const rsi::ReplyCheck check(config_with({{"DiO", Type::LONG}, {"EStr", Type::STRING}}));
  const auto content = check.read(
      "<?xml version='1.0'?>\r\n<Sen Type = 'ImFree' x=\"<\">\n\t<!-- <IPOC> -->\n\t"
      "<EStr>a b</EStr>\n<Other><DiO> 0 </DiO></Other>\n<IPOC> 12 </IPOC>\n</Sen >\n" +
      std::string(2, '\0'));
  CHECK(content.malformed == "");
  CHECK(content.right_type);
  CHECK(content.ipoc == 12);
  CHECK(content.missing.empty());
}

TEST_CASE("Type must equal SENTYPE to the letter", "[reply]") {
  const rsi::ReplyCheck check(config_with({}));
  const auto content = check.read("<Sen Type=\"imfree\"><IPOC>1</IPOC></Sen>");
  CHECK(content.malformed.empty());
  CHECK_FALSE(content.right_type);
  CHECK(content.sen_type == "imfree");
}

TEST_CASE("what is no reply is malformed, and says why", "[reply]") {
  const rsi::ReplyCheck check(config_with({}));
  for (const std::string wrong :
       {"",
        " ",
        "hello",
        "<Sen",
        "<Sen>",
        "<Sen Type=\"ImFree\">",
        "<Sen Type=\"ImFree\"/>",
        "<Sen Type=\"ImFree\"><IPOC>1</IPOC>",
        "<Sen Type=\"ImFree\"><IPOC>1</Sen>",
        "<Sen Type=\"ImFree\"><IPOC>1</IPOC></Sen>x",
        "<Sen><IPOC>1</IPOC></Sen>",
        "<Sen Type=ImFree><IPOC>1</IPOC></Sen>",
        "<Sen Type=\"ImFree><IPOC>1</IPOC></Sen>",
        "<Sen Type=\"ImFree\"><IPOC></IPOC></Sen>",
        "<Sen Type=\"ImFree\"><IPOC>1a</IPOC></Sen>",
        "<Sen Type=\"ImFree\"><IPOC>-1</IPOC></Sen>",
        "<Sen Type=\"ImFree\"><!-- <IPOC>1</IPOC></Sen>",
        "<Sen Type=\"ImFree\"><IPOC>99999999999999999999</IPOC></Sen>",
        "</Sen>",
        "<>",
        "<<>>",
        "<Rob Type=\"ImFree\"><IPOC>1</IPOC></Rob>",
        "<Sen Type=\"ImFree\"><IPOC>1</IPOC></Sen><Sen Type=\"ImFree\"><IPOC>1</IPOC></Sen>"}) {
    CAPTURE(wrong);
    CHECK_FALSE(check.read(wrong).malformed.empty());
  }
  std::string deep = "<Sen Type=\"ImFree\">";
  for (int i = 0; i < 1000; ++i) deep += "<a>";
  CHECK_FALSE(check.read(deep).malformed.empty());
}

TEST_CASE("a correction does not hide in what interrupts a value, or behind a comment", "[reply]") {
  const rsi::ReplyCheck check(config_with({{"FREE", Type::LONG}}));
  const auto is_taken = [&](const std::string& content) {
    const auto read = check.read("<Sen Type=\"ImFree\">" + content + "<IPOC>1</IPOC></Sen>");
    return read.malformed.empty() && read.missing.empty() && read.not_zero.empty();
  };
  CHECK(is_taken("<FREE><!-- -->0</FREE>"));
  CHECK_FALSE(is_taken("<FREE>5<!-- -->0</FREE>"));
  CHECK_FALSE(is_taken("<FREE>5<a/>0</FREE>"));
  CHECK_FALSE(is_taken("<FREE>0</FREE><!---><?x --><FREE>5</FREE> ?>"));
  CHECK_FALSE(is_taken("<!--><FREE>0</FREE>-->"));
}

TEST_CASE("cut or damaged replies of any kind are read without harm", "[reply]") {
  const auto config = config_with(kMuch);
  const std::string whole(rsi::Reply(config).with_ipoc("123456"));
  const rsi::ReplyCheck check(config);
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(check.read(std::string_view(whole).substr(0, length)).malformed.empty());
  std::mt19937_64 random(3);
  int malformed = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string damaged = whole;
    for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
    malformed += !check.read(damaged).malformed.empty();
  }
  CHECK(malformed > 1000);
}
