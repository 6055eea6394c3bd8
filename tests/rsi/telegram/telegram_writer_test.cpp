#include "rsi/telegram/telegram_writer.hpp"

#include <limits>

#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/telegram.hpp"
#include "tests/catch.hpp"

using rsi::EthernetConfig;
using Type = EthernetConfig::Element::Type;

namespace {

EthernetConfig sending(const std::vector<std::pair<std::string, Type>>& send) {
  EthernetConfig config;
  for (const auto& [tag, type] : send) config.send.push_back({tag, type, 1, false, 0});
  return config;
}

std::string written(const std::vector<std::pair<std::string, Type>>& send,
                    const rsi::SignalValues& values, int precision, std::uint64_t ipoc = 1) {
  std::string text;
  rsi::TelegramWriter(sending(send), precision).append(text, values, ipoc);
  return text;
}

}  // namespace

TEST_CASE("a telegram has the bytes that a KR C4 sends", "[telegram_writer]") {
  rsi::SignalValues values;
  values.AIPos = {1.5, -88.0, 91.25, 0.0, 45.0, -170.04};
  values.ASPos = {1.5, -88.0, 91.3, 0.0, 45.0, -170.0};
  values.Delay = 2;
  CHECK(written({{"DEF_AIPos", Type::DOUBLE},
                 {"DEF_ASPos", Type::DOUBLE},
                 {"DEF_Delay", Type::LONG},
                 {"DEF_Tech.C1", Type::DOUBLE},
                 {"DiL", Type::LONG},
                 {"Digout.o1", Type::BOOL},
                 {"Digout.o2", Type::BOOL},
                 {"Digout.o3", Type::BOOL},
                 {"Source1", Type::DOUBLE}},
                values, 1, 1525084) ==
        "<Rob Type=\"KUKA\">"
        "<AIPos A1=\"1.5\" A2=\"-88.0\" A3=\"91.2\" A4=\"0.0\" A5=\"45.0\" A6=\"-170.0\"/>"
        "<ASPos A1=\"1.5\" A2=\"-88.0\" A3=\"91.3\" A4=\"0.0\" A5=\"45.0\" A6=\"-170.0\"/>"
        "<Delay D=\"2\"/>"
        "<Tech C11=\"0.0\" C12=\"0.0\" C13=\"0.0\" C14=\"0.0\" C15=\"0.0\" C16=\"0.0\"  "
        "C17=\"0.0\" C18=\"0.0\" C19=\"0.0\" C110=\"0.0\"/>"
        "<DiL>0</DiL><Digout o1=\"0\" o2=\"0\" o3=\"0\"/><Source1>0.0</Source1>"
        "<IPOC>1525084</IPOC></Rob>\n");
}

TEST_CASE("elements come in the order of the list, every signal from its own value",
          "[telegram_writer]") {
  rsi::SignalValues values;
  values.RIst = {1, 2, 3, 4, 5, 6};
  values.RSol[1] = 7;
  values.EIPos[2] = 8;
  values.ESPos[3] = 9;
  values.MACur[4] = 10;
  values.MECur[5] = 11;
  values.ASPos[0] = 12;
  CHECK(written({{"DEF_MECur", Type::DOUBLE},
                 {"DEF_MACur", Type::DOUBLE},
                 {"DEF_ESPos", Type::DOUBLE},
                 {"DEF_EIPos", Type::DOUBLE},
                 {"DEF_ASPos", Type::DOUBLE},
                 {"DEF_RSol", Type::DOUBLE},
                 {"DEF_RIst", Type::DOUBLE}},
                values, 0) ==
        "<Rob Type=\"KUKA\">"
        "<MECur E1=\"0\" E2=\"0\" E3=\"0\" E4=\"0\" E5=\"0\" E6=\"11\"/>"
        "<MACur A1=\"0\" A2=\"0\" A3=\"0\" A4=\"0\" A5=\"10\" A6=\"0\"/>"
        "<ESPos E1=\"0\" E2=\"0\" E3=\"0\" E4=\"9\" E5=\"0\" E6=\"0\"/>"
        "<EIPos E1=\"0\" E2=\"0\" E3=\"8\" E4=\"0\" E5=\"0\" E6=\"0\"/>"
        "<ASPos A1=\"12\" A2=\"0\" A3=\"0\" A4=\"0\" A5=\"0\" A6=\"0\"/>"
        "<RSol X=\"0\" Y=\"7\" Z=\"0\" A=\"0\" B=\"0\" C=\"0\"/>"
        "<RIst X=\"1\" Y=\"2\" Z=\"3\" A=\"4\" B=\"5\" C=\"6\"/><IPOC>1</IPOC></Rob>\n");
}

TEST_CASE("decimals are fixed, and zero has no sign", "[telegram_writer]") {
  rsi::SignalValues values;
  values.RIst = {-0.0, -0.00004, -0.00006, 1e6, 1e-7, 123.45678};
  CHECK(written({{"DEF_RIst", Type::DOUBLE}}, values, 4) ==
        "<Rob Type=\"KUKA\"><RIst X=\"0.0000\" Y=\"0.0000\" Z=\"-0.0001\" A=\"1000000.0000\" "
        "B=\"0.0000\" C=\"123.4568\"/><IPOC>1</IPOC></Rob>\n");
}

TEST_CASE("the longest numbers fit", "[telegram_writer]") {
  rsi::SignalValues values;
  values.RIst.fill(std::numeric_limits<double>::lowest());
  const auto text =
      written({{"DEF_RIst", Type::DOUBLE}}, values, 15, std::numeric_limits<std::uint64_t>::max());
  CHECK(text.find("X=\"-179769") != std::string::npos);
  CHECK(text.find("<IPOC>18446744073709551615</IPOC>") != std::string::npos);
}

TEST_CASE("tags that the robot has no value for are zero, strings empty", "[telegram_writer]") {
  CHECK(written({{"Act.X", Type::DOUBLE},
                 {"GPIO.01", Type::BOOL},
                 {"Text", Type::STRING},
                 {"Act.Y", Type::DOUBLE},
                 {"Act", Type::LONG}},
                {}, 2) ==
        "<Rob Type=\"KUKA\"><Act X=\"0.00\" Y=\"0.00\">0</Act><GPIO 01=\"0\"/><Text></Text>"
        "<IPOC>1</IPOC></Rob>\n");
}

TEST_CASE("an element of one's own that has a whole pose is fed with it", "[telegram_writer]") {
  rsi::SignalValues values;
  values.RIst = {1, 2, 3, 4, 5, 6};
  std::vector<std::pair<std::string, Type>> send;
  for (const char* name : {"Y", "X", "Z", "A", "B", "C"})
    send.push_back({std::string("Pos.") + name, Type::DOUBLE});
  CHECK(written(send, values, 1) ==
        "<Rob Type=\"KUKA\"><Pos Y=\"2.0\" X=\"1.0\" Z=\"3.0\" A=\"4.0\" B=\"5.0\" C=\"6.0\"/>"
        "<IPOC>1</IPOC></Rob>\n");
  send.pop_back();
  CHECK(written(send, values, 0) ==
        "<Rob Type=\"KUKA\"><Pos Y=\"0\" X=\"0\" Z=\"0\" A=\"0\" B=\"0\"/>"
        "<IPOC>1</IPOC></Rob>\n");
}

TEST_CASE("a telegram is appended without further allocation once there is room",
          "[telegram_writer]") {
  const rsi::TelegramWriter writer(sending({{"DEF_RIst", Type::DOUBLE}}), 4);
  std::string text;
  writer.append(text, {}, 1000);
  const auto first = text;
  const char* buffer = text.data();
  text.clear();
  writer.append(text, {}, 1000);
  CHECK(text == first);
  CHECK(text.data() == buffer);
  writer.append(text, {}, 1000);
  CHECK(text == first + first);
}

TEST_CASE("the parser reads what the writer writes", "[telegram_writer]") {
  rsi::SignalValues values;
  values.RIst = {1032.4, -599.7, 489.25, 179.9999, -90.0, 0.0001};
  values.Delay = 3;
  rsi::Telegram telegram;
  const auto text = written({{"GPIO.01", Type::BOOL},
                             {"DEF_RIst", Type::DOUBLE},
                             {"DEF_Tech.C1", Type::DOUBLE},
                             {"DEF_Delay", Type::LONG}},
                            values, 4, 4294967297);
  CHECK(telegram.parse(text) == rsi::Defect::none);
  CHECK(telegram.ipoc() == 4294967297);
  const auto value = [&](const char* element, const char* attribute) {
    return rsi::number(telegram.signals().at(telegram.find(element, attribute).value()).text);
  };
  CHECK(value("RIst", "X") == 1032.4);
  CHECK(value("RIst", "A") == 179.9999);
  CHECK(value("RIst", "C") == 0.0001);
  CHECK(value("Delay", "D") == 3);
  CHECK(value("Tech", "C17") == 0);
}

TEST_CASE("decimals outside of what a double holds are refused", "[telegram_writer]") {
  CHECK_THROWS_AS(rsi::TelegramWriter({}, -1), std::invalid_argument);
  CHECK_THROWS_AS(rsi::TelegramWriter({}, 16), std::invalid_argument);
}
