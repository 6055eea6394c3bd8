#include "daemon/commands/check_command.hpp"

#include <sstream>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::check;
using sweepd::test::kConfig;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

struct Checked {
  int code = 0;
  std::string text;
};

/// Of the files alone: the machine is any.
Checked checked(sweepd::CheckOptions options) {
  options.files_only = true;
  std::ostringstream out;
  const int code = check(options, out);
  return {code, out.str()};
}

/// An Ethernet file on lines of its own, so that a test knows their numbers.
std::string ethernet_text(const std::string& ip = "192.168.1.10", const std::string& port = "49152",
                          const std::string& more = "",
                          const std::string& send =
                              "<ELEMENT TAG=\"DEF_RIst\" TYPE=\"DOUBLE\" "
                              "INDX=\"INTERNAL\"/><ELEMENT TAG=\"DEF_AIPos\" "
                              "TYPE=\"DOUBLE\" INDX=\"INTERNAL\"/>") {
  return "<ROOT>\n<CONFIG>\n<IP_NUMBER>" + ip + "</IP_NUMBER>\n<PORT>" + port +
         "</PORT>\n<SENTYPE>ImFree</SENTYPE><ONLYSEND>FALSE</ONLYSEND>" + more +
         "</CONFIG>\n<SEND><ELEMENTS>" + send +
         "<ELEMENT TAG=\"DEF_Delay\" TYPE=\"LONG\" INDX=\"INTERNAL\"/>"
         "</ELEMENTS></SEND>\n<RECEIVE><ELEMENTS>"
         "<ELEMENT TAG=\"RKorr.X\" TYPE=\"DOUBLE\" INDX=\"1\" HOLDON=\"1\"/>"
         "<ELEMENT TAG=\"DiO\" TYPE=\"LONG\" INDX=\"2\" HOLDON=\"1\"/>"
         "</ELEMENTS></RECEIVE>\n</ROOT>\n";
}

/// Settings beside which robot and Ethernet file lie.
std::string settings_with(const std::string& more = "", const std::string& listen = "0.0.0.0:49152",
                          const std::string& zeros = "\"RKorr.X\", \"DiO\"") {
  return "[[robot]]\nname = \"kr5-arc\"\ndescription = \"robot.toml\"\nlisten = \"" + listen +
         "\"\noutput = \"out\"\nethernet_config = \"ethernet.xml\"\nanswers_with_zeros = [" +
         zeros + "]\n" + more;
}

/// A folder where everything fits together.
struct Sound : TemporaryFolder {
  Sound() {
    fs::copy_file(kConfig / "robots/kr5_arc.toml", path() / "robot.toml");
    static_cast<void>(write("ethernet.xml", ethernet_text()));
    static_cast<void>(write("sweepd.toml", settings_with()));
  }
  [[nodiscard]] Checked check() const { return checked({path() / "sweepd.toml", {}}); }
};

}  // namespace

TEST_CASE("the shipped settings and all files that they name are sound", "[check_command]") {
  const auto result = checked({kConfig / "sweepd.toml", {}});
  INFO(result.text);
  CHECK(result.code == 0);
  CHECK_THAT(result.text, !ContainsSubstring("error") && !ContainsSubstring("warning"));
  CHECK_THAT(result.text,
             ContainsSubstring("<Sen Type=\"ImFree\"><EStr></EStr><IPOC>123456</IPOC></Sen>"));
}

TEST_CASE("the reply is printed as it will be sent: zero for every tag, in order",
          "[check_command]") {
  const Sound folder;
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("<Sen Type=\"ImFree\"><RKorr X=\"0.0"));
  CHECK_THAT(result.text, ContainsSubstring("<DiO>0</DiO><IPOC>123456</IPOC></Sen>"));
}

TEST_CASE("tags that can move the robot by zeros are refused unless the settings name each",
          "[check_command][issue11][point_1]") {
  const Sound folder;
  const auto refused = [&](const std::string& zeros) {
    static_cast<void>(folder.write("sweepd.toml", settings_with("", "0.0.0.0:49152", zeros)));
    const auto result = folder.check();
    CHECK(result.code == 78);
    return result.text;
  };
  const auto place = (folder / "ethernet.xml").string() + ":7: RECEIVE: zeros for ";
  CHECK_THAT(refused(""), ContainsSubstring("error    " + place + "RKorr.X, DiO can move") &&
                              ContainsSubstring("ONLYSEND") &&
                              ContainsSubstring("answers_with_zeros"));
  CHECK_THAT(refused("\"DiO\""), ContainsSubstring(place + "RKorr.X can move"));
  CHECK_THAT(refused("\"RKor.X\", \"DiO\""),
             ContainsSubstring("\"RKor.X\" is no tag in RECEIVE of") &&
                 ContainsSubstring("did you mean \"RKorr.X\"?"));
  CHECK_THAT(refused("\"RKorr.X\", \"DiO\", \"Gripper\""),
             ContainsSubstring("it has RKorr.X, DiO"));

  SECTION("ONLYSEND answers nothing") {
    auto text = ethernet_text();
    text.replace(text.find("FALSE"), 5, "TRUE");
    static_cast<void>(folder.write("ethernet.xml", text));
    static_cast<void>(folder.write("sweepd.toml", settings_with("", "0.0.0.0:49152", "")));
    CHECK(folder.check().code == 0);
  }
  SECTION("without settings that could allow it, a file is warned of") {
    const auto result = checked({{}, {folder / "ethernet.xml"}});
    CHECK(result.code == 0);
    CHECK_THAT(result.text, ContainsSubstring("warning  " + place));
  }
}

TEST_CASE("replies that no datagram holds are refused, those in pieces are warned of",
          "[check_command][issue11][point_2]") {
  const TemporaryFolder folder;
  const auto with_string_of = [&](std::size_t bytes) {
    auto text = ethernet_text();
    const auto begin = text.find("<ELEMENT TAG=\"RKorr");
    text.replace(
        begin, text.find("</ELEMENTS></RECEIVE>") - begin,
        "<ELEMENT TAG=\"" + std::string(bytes, 'x') + "\" TYPE=\"STRING\" INDX=\"INTERNAL\"/>");
    return folder.write("ethernet.xml", text);
  };
  fs::copy_file(kConfig / "robots/kr5_arc.toml", folder / "robot.toml");
  static_cast<void>(folder.write("sweepd.toml", settings_with("", "0.0.0.0:49152", "")));
  static_cast<void>(with_string_of(700));
  CHECK_THAT(checked({folder / "sweepd.toml", {}}).text, !ContainsSubstring("bytes"));
  static_cast<void>(with_string_of(800));  // stands in the reply twice
  const auto pieces = checked({folder / "sweepd.toml", {}});
  CHECK(pieces.code == 0);
  CHECK_THAT(pieces.text, ContainsSubstring("expected replies of at most 1472 bytes, found 16"));
  static_cast<void>(with_string_of(80'000));
  const auto refused = checked({folder / "sweepd.toml", {}});
  CHECK(refused.code == 78);
  CHECK_THAT(refused.text, ContainsSubstring("expected replies of at most 65507 bytes, found 160"));
}

TEST_CASE("wrong settings are 78, with file and line", "[check_command]") {
  const Sound folder;
  SECTION("no TOML") {
    static_cast<void>(folder.write("sweepd.toml", "[[robot]]\nname = kr5\n"));
    CHECK_THAT(folder.check().text, ContainsSubstring((folder / "sweepd.toml").string() + ":2"));
  }
  SECTION("an unknown key") {
    static_cast<void>(folder.write("sweepd.toml", settings_with("recrod = false\n")));
    CHECK_THAT(folder.check().text, ContainsSubstring((folder / "sweepd.toml").string() + ":8") &&
                                        ContainsSubstring("recrod") && ContainsSubstring("record"));
  }
  SECTION("several mistakes, a line each") {
    static_cast<void>(
        folder.write("sweepd.toml", settings_with("recrod = false\nsilence_ms = 1\n")));
    const auto place = "  error    " + (folder / "sweepd.toml").string();
    CHECK_THAT(folder.check().text, ContainsSubstring(place + ":8:1: robot.recrod: ") &&
                                        ContainsSubstring(place + ":9:14: robot.silence_ms: "));
  }
  SECTION("columns of a device that are none, with their place") {
    static_cast<void>(folder.write(
        "sweepd.toml", settings_with("[[robot.device]]\nlisten = \"udp://0.0.0.0:5005\"\n"
                                     "columns = \"x_mm,y_mm,height\"\n")));
    CHECK_THAT(folder.check().text,
               ContainsSubstring("  error    " + (folder / "sweepd.toml").string() +
                                 ":10:11: robot.device.columns, column 3 (height): expected a "
                                 "known column"));
  }
  SECTION("no such file") {
    fs::remove(folder / "sweepd.toml");
    CHECK_THAT(folder.check().text, ContainsSubstring((folder / "sweepd.toml").string()));
  }
  CHECK(folder.check().code == 78);
}

TEST_CASE("a wrong robot file is 78, with file and line; the Ethernet file is looked at too",
          "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write("robot.toml", "name = \"x\"\nhome_deg = \"y\"\n[[joint]]\n"));
  const auto result = folder.check();
  CHECK(result.code == 78);
  CHECK_THAT(result.text, ContainsSubstring((folder / "robot.toml").string() + ":2"));
  CHECK_THAT(result.text, ContainsSubstring("<IPOC>123456</IPOC>"));
}

TEST_CASE("a wrong Ethernet file is 78, with file and line", "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write("ethernet.xml", ethernet_text("192.168.1.10", "70000")));
  const auto result = folder.check();
  CHECK(result.code == 78);
  CHECK_THAT(result.text, ContainsSubstring((folder / "ethernet.xml").string() + ":4") &&
                              ContainsSubstring("PORT"));
}

TEST_CASE("a placeholder for the address is a warning, not an error", "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write("ethernet.xml", ethernet_text("ip.address.of.rospc")));
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("warning") &&
                              ContainsSubstring("ip.address.of.rospc") &&
                              ContainsSubstring((folder / "ethernet.xml").string() + ":3"));
}

TEST_CASE("what does not fit together is 78: port, address, plan", "[check_command]") {
  const Sound folder;
  SECTION("port") {
    static_cast<void>(folder.write("sweepd.toml", settings_with("", "0.0.0.0:59152")));
    CHECK_THAT(folder.check().text, ContainsSubstring("59152") && ContainsSubstring("49152"));
  }
  SECTION("address") {
    static_cast<void>(folder.write("sweepd.toml", settings_with("", "192.168.1.11:49152")));
    CHECK_THAT(folder.check().text,
               ContainsSubstring("192.168.1.11") && ContainsSubstring("IP_NUMBER"));
  }
  SECTION("plan") {
    static_cast<void>(folder.write("sweepd.toml", settings_with("plan = \"plan.toml\"\n")));
    static_cast<void>(folder.write(
        "plan.toml",
        "home_deg = [90, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 60\n"
        "acceleration_deg_s2 = 200\ndwell_ms = 300\n[[sweep]]\njoint = 1\nstart_deg = -45\n"
        "end_deg = 170\nspeed_deg_s = 20\n"));  // A1 goes to 155
    CHECK_THAT(folder.check().text, ContainsSubstring((folder / "plan.toml").string() + ":"));
  }
  CHECK(folder.check().code == 78);
}

TEST_CASE("a controller that speaks TCP is fine", "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write(
      "ethernet.xml", ethernet_text("192.168.1.10", "49152", "<PROTOCOL>TCP</PROTOCOL>")));
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("port 49152, TCP"));
}

TEST_CASE("signals that the controller does not send are warned about, once for each triple",
          "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write("ethernet.xml",
                                 ethernet_text("192.168.1.10", "49152", "",
                                               "<ELEMENT TAG=\"DiL\" TYPE=\"LONG\" INDX=\"1\"/>")));
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("RIst.X") && !ContainsSubstring("RIst.Y") &&
                              ContainsSubstring("AIPos.A1") && !ContainsSubstring("AIPos.A2"));
}

TEST_CASE("angles that leave out joints of the description are warned about", "[check_command]") {
  const Sound folder;
  static_cast<void>(folder.write(
      "sweepd.toml", settings_with() + "[robot.signals]\nangles = [\"AIPos.A1\", \"AIPos.A2\"]\n"));
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("expected 6 signals, one for each joint"));
}

TEST_CASE("settings without an Ethernet file are fine, with a warning of what that means",
          "[check_command]") {
  const Sound folder;
  auto text = settings_with();
  text.erase(text.find("ethernet_config"));
  static_cast<void>(folder.write("sweepd.toml", text));
  const auto result = folder.check();
  CHECK(result.code == 0);
  CHECK_THAT(result.text, ContainsSubstring("warning") && ContainsSubstring("IPOC alone"));
}

TEST_CASE("Ethernet files can be looked at by themselves, all of them", "[check_command]") {
  const TemporaryFolder folder;
  const auto good = folder.write("good.xml", ethernet_text());
  const auto bad = folder.write("bad.xml", "<ROOT>\n<CONFIG>");
  const auto silent = folder.write("silent.xml", [] {
    auto text = ethernet_text();
    text.replace(text.find("FALSE"), 5, "TRUE");
    return text;
  }());
  CHECK(checked({{}, {good, silent}}).code == 0);
  const auto result = checked({{}, {bad, good, silent}});
  CHECK(result.code == 78);
  CHECK_THAT(result.text,
             ContainsSubstring(bad.string() + ":") && ContainsSubstring(good.string()));
  CHECK_THAT(result.text, ContainsSubstring("none: ONLYSEND is TRUE"));
  CHECK(checked({{}, {folder / "missing.xml"}}).code == 78);
  CHECK(checked({{}, {folder.path()}}).code == 78);
}

TEST_CASE("a plan is looked at beforehand: targets on an axis, ranges that are too short",
          "[check_command][long]") {
  const Sound folder;
  static_cast<void>(folder.write("sweepd.toml", settings_with("plan = \"plan.toml\"\n")));
  const auto plan = [&](const std::string& end_deg) {
    return "home_deg = [90, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 60\n"
           "acceleration_deg_s2 = 200\ndwell_ms = 300\n[[sweep]]\njoint = 1\nstart_deg = -45\n"
           "end_deg = " +
           end_deg + "\nspeed_deg_s = 20\n";
  };
  static_cast<void>(folder.write("plan.toml", plan("45")));
  const auto sound = folder.check();
  INFO(sound.text);
  CHECK(sound.code == 0);
  CHECK_THAT(sound.text, ContainsSubstring("plan.toml: 1 sweep, within the limits, each axis"));

  static_cast<void>(folder.write("plan.toml", plan("-44")));
  const auto refused = folder.check();
  INFO(refused.text);
  CHECK(refused.code == 78);
  CHECK_THAT(refused.text, ContainsSubstring("plan.toml: sweep 1 (joint 1, -45 to -44 deg)"));
}

TEST_CASE("the RSI context has to name the Ethernet file that sweepd was given",
          "[check_command]") {
  const auto krc4 = kConfig / "controller/krc4";
  const auto fits = checked({{}, {krc4 / "sweepd_ethernet.xml"}, {krc4 / "sweepd.rsi.xml"}});
  INFO(fits.text);
  CHECK(fits.code == 0);
  CHECK_THAT(fits.text, ContainsSubstring("sweepd.rsi.xml: Precision 4, Ethernet file "
                                          "sweepd_ethernet.xml") &&
                            !ContainsSubstring("warning"));
  const auto other =
      checked({{}, {krc4 / "sweepd_ethernet.xml"}, {krc4 / "sweepd_onlysend.rsi.xml"}});
  CHECK(other.code == 0);
  CHECK_THAT(other.text, ContainsSubstring("warning") && ContainsSubstring("ConfigFile"));
  const TemporaryFolder folder;
  static_cast<void>(folder.write("broken.rsi.xml", "<rSIModel>"));
  CHECK(checked({{}, {}, {folder.path() / "broken.rsi.xml"}}).code == 78);
}

TEST_CASE("a port of the pages that another program has is a warning", "[check_command]") {
  namespace asio = boost::asio;
  asio::io_context context;
  const asio::ip::tcp::acceptor other(context, {asio::ip::address_v4::loopback(), 0});
  const auto port = std::to_string(other.local_endpoint().port());
  const Sound folder;
  static_cast<void>(folder.write(
      "sweepd.toml", settings_with() + "[http]\nlisten = \"127.0.0.1:" + port + "\"\n"));
  std::ostringstream out;
  static_cast<void>(check({folder.path() / "sweepd.toml"}, out));
  CHECK_THAT(out.str(), ContainsSubstring("warning  pages on http://127.0.0.1:" + port +
                                          "/: daemon_tests (process "));
}
