#include <algorithm>
#include <csignal>

#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;
using Words = std::vector<std::string>;

namespace {

/// One line on stderr, `sweepd: what went wrong: what to do`, and nothing else.
void check_message(const Run& run) {
  INFO(run.errors);
  CHECK(run.out.empty());
  CHECK(run.errors.starts_with("sweepd: "));
  CHECK(std::count(run.errors.begin(), run.errors.end(), '\n') == 1);
  const auto what = run.errors.find(": ", 8);
  REQUIRE(what != std::string::npos);
  CHECK(run.errors.size() > what + 5);
}

void check_failure(int code, const Words& arguments, const std::string& said) {
  std::string command;
  for (const auto& word : arguments) command += " " + word;
  INFO("sweepd" << command);
  const auto run = run_sweepd(arguments);
  CHECK(run.code == code);
  check_message(run);
  CHECK_THAT(run.errors, ContainsSubstring(said));
}

std::string settings(const std::string& description, const std::string& more) {
  return "[[robot]]\nname = \"kr5-arc\"\ndescription = \"" + description +
         "\"\nlisten = \"127.0.0.1:" + std::to_string(free_port()) + "\"\noutput = \"out\"\n" +
         more;
}

}  // namespace

TEST_CASE("0: help, version, and what is sound", "[exit_codes]") {
  for (const auto& arguments :
       {Words{"--help"}, Words{"--version"}, Words{"run", "--help"}, Words{"replay", "--help"},
        Words{"simulate", "--help"}, Words{"plan", "--help"}, Words{"export", "--help"},
        Words{"check", "--help"},
        Words{"check", "--files-only", "--config", (kConfig / "sweepd.toml").string()}}) {
    const auto run = run_sweepd(arguments);
    INFO(arguments.front());
    CHECK(run.code == 0);
    CHECK_FALSE(run.out.empty());
    CHECK(run.errors.empty());
  }
}

TEST_CASE("1: something that is not there or does not answer", "[exit_codes]") {
  const TemporaryFolder folder;
  const auto text = folder.write("text.pcap", "this is no capture").string();
  check_failure(1, {"replay", (folder / "missing.pcap").string()}, "missing.pcap");
  check_failure(1, {"replay", text}, "text.pcap");
  check_failure(1, {"replay", folder.path().string()}, folder.path().string());
  check_failure(1, {"export", (folder / "missing.pcap").string(), "--csv", "-"}, "missing.pcap");
  check_failure(1, {"simulate", "--robot", kRobot, "--plan", kPlan, "--write", text + "/x.pcap"},
                text + "/x.pcap");
  check_failure(1,
                {"simulate", "--robot", kRobot, "--plan", kPlan, "--to",
                 "127.0.0.1:" + std::to_string(free_port()), "--timeout-cycles", "5", "--quiet"},
                "nobody answered");
}

TEST_CASE("1: a device that sends nothing, with what to look at", "[exit_codes]") {
  const std::string port = "udp://127.0.0.1:" + std::to_string(free_port());
  const auto silent = run_sweepd({"listen", port, "--seconds", "0.2"});
  CHECK(silent.code == 1);
  CHECK_THAT(silent.errors,
             ContainsSubstring("sweepd: nothing came to " + port + " in 0.2 s: see the device's"));
}

TEST_CASE("plan: 0 for what can be run, 1 for what is refused, 78 beyond limits", "[exit_codes]") {
  const TemporaryFolder folder;
  const Words words{"plan", "--robot",    kRobot, "--plan",
                    kPlan,  "--cycle-ms", "16",   "--position-sigma-mm",
                    "0.02"};  // given, it takes one rehearsal and not six
  const auto with = [&](Words more) {
    more.insert(more.begin(), words.begin(), words.end());
    return more;
  };
  const auto output = (folder / "krl").string();
  const auto done = run_sweepd(with({"--krl", "krc2", "--output", output}));
  CHECK(done.code == 0);
  CHECK(done.errors.empty());
  CHECK(std::filesystem::exists(folder / "krl/sweepd_sweeps.src"));

  const auto refused = run_sweepd(
      with({"--tool-mm", "0,0,215", "--krl", "krc4", "--output", (folder / "none").string()}));
  CHECK(refused.code == 1);
  CHECK_THAT(refused.errors, ContainsSubstring("sweepd: joint 6: the target point is 0.00 mm"));
  CHECK_FALSE(std::filesystem::exists(folder / "none"));

  std::string text = content(kPlan);
  const auto start = text.find("start_deg = -45.0");
  const auto sweep = text.begin() + static_cast<std::ptrdiff_t>(text.rfind("[[sweep]]", start));
  const auto line = 1 + std::count(text.begin(), sweep, '\n');
  text.replace(start, 17, "start_deg = -156.0");
  const auto far = folder.write("far.toml", text);
  check_failure(78, {"plan", "--robot", kRobot, "--plan", far.string()},
                far.string() + ":" + std::to_string(line) +
                    ": sweep.start_deg: expected joint 1 from -155 to 155 degrees");
  check_failure(2, with({"--krl", "krc4"}), "--output");
  check_failure(2, with({"--write-plan", "x.toml"}), "--propose");
  check_failure(2, with({"--krl", "krc3", "--output", output}), "--krl");
}

TEST_CASE("2: wrong usage", "[exit_codes]") {
  check_failure(2, {}, "--help");
  check_failure(2, {"frobnicate"}, "--help");
  check_failure(2, {"run", "--confg", "x"}, "--confg");
  check_failure(2, {"replay"}, "TRACE");
  check_failure(2, {"replay", "x.pcap", "--port", "70000"}, "--port");
  check_failure(2, {"replay", "x.pcap", "--controller", "robot"}, "--controller");
  check_failure(2, {"export", "x.pcap"}, "--csv");
  check_failure(2, {"simulate", "--robot", kRobot, "--plan", kPlan}, "--help");
  check_failure(2, {"simulate", "--robot", kRobot, "--plan", kPlan, "--to", "localhost"}, "--to");
  check_failure(
      2,
      {"simulate", "--robot", kRobot, "--plan", kPlan, "--to", "127.0.0.1:1", "--write", "x.pcap"},
      "--help");
  check_failure(
      2, {"simulate", "--robot", kRobot, "--plan", kPlan, "--write", "x.pcap", "--cycle-ms", "0"},
      "--cycle-ms");
  check_failure(2, {"run", "--listen", "127.0.0.1"}, "--listen");
}

TEST_CASE("78: wrong settings, robot or Ethernet file, with file and line", "[exit_codes]") {
  const TemporaryFolder folder;
  const auto config = (folder / "sweepd.toml").string();
  const auto run = [&](const std::string& text, const std::string& said) {
    static_cast<void>(folder.write("sweepd.toml", text));
    check_failure(78, {"run", "--config", config}, said);
  };
  run(settings(kRobot, "recrod = true\n"), config + ":6:1: robot.recrod");
  CHECK_THAT(run_sweepd({"run", "--config", config}).errors,
             ContainsSubstring("did you mean") && ContainsSubstring("record"));
  run("[[robot]]\nname = kr5-arc\n", config + ":2");
  run("", config);
  check_failure(78, {"run", "--config", (folder / "missing.toml").string()}, "missing.toml");
  check_failure(78, {"run", "--config", folder.path().string()}, folder.path().string());

  const auto robot = folder.write("robot.toml", "name = \"x\"\nhome_deg = \"y\"\n[[joint]]\n");
  run(settings("robot.toml", ""), robot.string() + ":2");
}

TEST_CASE("78: an Ethernet file that is wrong or missing", "[exit_codes]") {
  const TemporaryFolder folder;
  const auto config =
      folder.write("sweepd.toml", settings(kRobot, "ethernet_config = \"e.xml\"\n"));
  const auto ethernet = folder.write("e.xml", "<ROOT>\n<CONFIG>\n<PORT>x</PORT></CONFIG></ROOT>");
  check_failure(78, {"run", "--config", config.string()}, ethernet.string() + ":");
  std::filesystem::remove(ethernet);
  check_failure(78, {"run", "--config", config.string()}, ethernet.string());
  check_failure(78,
                {"simulate", "--robot", kRobot, "--plan", kPlan, "--write",
                 (folder / "x.pcap").string(), "--ethernet-config", ethernet.string()},
                ethernet.string());
}

TEST_CASE("78: an Ethernet file whose zeros can move the robot", "[exit_codes][issue11][point_1]") {
  const TemporaryFolder folder;
  auto text = content(kConfig / "controller/krc4/sweepd_ethernet.xml");
  text.insert(text.find("</ELEMENTS>", text.find("<RECEIVE>")),
              "<ELEMENT TAG=\"RKorr.X\" TYPE=\"DOUBLE\" INDX=\"1\" HOLDON=\"1\"/>");
  const auto ethernet = folder.write("e.xml", text).string();
  const auto config =
      folder.write("sweepd.toml", settings(kRobot, "ethernet_config = \"e.xml\"\n"));
  check_failure(78, {"run", "--config", config.string()}, "RECEIVE: zeros for RKorr.X can move");
  CHECK(run_sweepd({"simulate", "--robot", kRobot, "--plan", kPlan, "--write",
                    (folder / "x.pcap").string(), "--ethernet-config", ethernet, "--quiet"})
            .code == 0);
}

TEST_CASE("1: a port that another sweepd has, which goes on undisturbed", "[exit_codes]") {
  const TemporaryFolder folder;
  Daemon first(folder.path());
  check_failure(1, {"run", "--config", first.config().string()}, first.address());
  CHECK_THAT(run_sweepd({"run", "--config", first.config().string()}).errors,
             ContainsSubstring("in use by another program"));
  CHECK(first.process().running());
  first.process().signal(SIGTERM);
  CHECK(first.process().wait() == 0);
}
