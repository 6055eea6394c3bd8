#include <csignal>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

/// An Ethernet file in the manner of a KR C2, and settings for it.
void write_settings(const TemporaryFolder& folder, std::uint16_t port, const std::string& config) {
  static_cast<void>(folder.write(
      "ethernet.xml",
      "<ROOT>\n<CONFIG>\n<IP_NUMBER>127.0.0.1</IP_NUMBER>\n<PORT>" + std::to_string(port) +
          "</PORT>\n<PROTOCOL>TCP</PROTOCOL>\n<SENTYPE>KMC</SENTYPE>\n" + config +
          "</CONFIG>\n<SEND>\n<ELEMENTS>\n"
          "<ELEMENT TAG=\"DEF_RIst\" TYPE=\"DOUBLE\" INDX=\"INTERNAL\" UNIT=\"0\" />\n"
          "<ELEMENT TAG=\"DEF_AIPos\" TYPE=\"DOUBLE\" INDX=\"INTERNAL\" UNIT=\"0\" />\n"
          "<ELEMENT TAG=\"DEF_Delay\" TYPE=\"LONG\" INDX=\"INTERNAL\" UNIT=\"0\" />\n"
          "</ELEMENTS>\n</SEND>\n<RECEIVE>\n<ELEMENTS>\n"
          "<ELEMENT TAG=\"DEF_EStr\" TYPE=\"STRING\" INDX=\"INTERNAL\" UNIT=\"0\" />\n"
          "</ELEMENTS>\n</RECEIVE>\n</ROOT>\n"));
  static_cast<void>(folder.write(
      "sweepd.toml", "[[robot]]\nname = \"kr5-arc\"\ndescription = \"" +
                         (kConfig / "robots/kr5_arc.toml").string() +
                         "\"\nlisten = \"127.0.0.1:" + std::to_string(port) +
                         "\"\noutput = \"output\"\nethernet_config = \"ethernet.xml\"\n"));
}

}  // namespace

TEST_CASE("a campaign over TCP gives the result of its replayed recording", "[tcp]") {
  const auto [config, replies] = GENERATE(table<std::string, std::string>(
      {{"<PROTCOLLENGTH>On</PROTCOLLENGTH>\n<ONLYSEND>FALSE</ONLYSEND>\n", "replies accepted"},
       {"<PROTCOLLENGTH>Off</PROTCOLLENGTH>\n<ONLYSEND>TRUE</ONLYSEND>\n",
        "none expected: ONLYSEND"}}));
  const TemporaryFolder folder;
  const auto port = free_tcp_port();
  write_settings(folder, port, config);
  const auto settings = (folder / "sweepd.toml").string();

  SweepdProcess daemon({"run", "--config", settings});
  REQUIRE(eventually([&] {
    return !daemon.running() || daemon.errors().find("listening on TCP 127.0.0.1:" +
                                                     std::to_string(port)) != std::string::npos;
  }));
  INFO(daemon.errors());
  REQUIRE(daemon.running());

  const auto simulated = run_sweepd(
      {"simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(), "--plan",
       write_short_plan(folder).string(), "--ethernet-config", (folder / "ethernet.xml").string(),
       "--to", "127.0.0.1:" + std::to_string(port), "--check", "sweepd"});
  INFO(simulated.out << simulated.errors);
  // Whether replies were in time is up to this machine; that they were right is not.
  CHECK_THAT(simulated.out, ContainsSubstring("played to its end") && ContainsSubstring(replies) &&
                                ContainsSubstring("replies refused                  0"));
  daemon.signal(SIGTERM);
  REQUIRE(daemon.wait() == 0);

  std::filesystem::path session;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "output/kr5-arc"))
    session = entry.path();
  const auto result = nlohmann::json::parse(content(session / "result.json"));
  CHECK(result["status"] == "complete");
  CHECK(result["source"]["lost"].get<std::uint64_t>() <=
        figure(simulated.out, "\ncycles overslept "));
  CHECK(result["source"]["malformed"] == 0);

  const auto replayed = run_sweepd({"replay", (session / "trace.pcap").string(), "--config",
                                    settings, "--output", (folder / "replayed").string()});
  INFO(replayed.errors);
  CHECK(replayed.code == 0);
  for (const char* name : {"result.json", "dh.csv", "sweeps.csv", "samples.csv"}) {
    INFO(name);
    CHECK(content(session / name) == content(folder / "replayed" / name));
  }
}

TEST_CASE("a simulated controller says that nobody listens over TCP", "[tcp]") {
  const TemporaryFolder folder;
  const auto port = free_tcp_port();
  write_settings(folder, port, "<ONLYSEND>FALSE</ONLYSEND>\n");
  const auto run =
      run_sweepd({"simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(), "--plan",
                  write_short_plan(folder).string(), "--ethernet-config",
                  (folder / "ethernet.xml").string(), "--to", "127.0.0.1:" + std::to_string(port)});
  CHECK(run.code == 1);
  CHECK_THAT(run.errors, ContainsSubstring("sweepd: cannot connect to 127.0.0.1:") &&
                             ContainsSubstring("start `sweepd run`"));
}
