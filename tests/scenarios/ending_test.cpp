#include <csignal>

#include <nlohmann/json.hpp>

#include "rsi/capture/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Json = nlohmann::json;

TEST_CASE("SIGTERM and SIGINT while a robot streams leave everything complete", "[ending]") {
  for (const int signal : {SIGTERM, SIGINT}) {
    INFO("signal " << signal);
    const TemporaryFolder folder;
    Daemon daemon(folder.path());
    SweepdProcess controller({"simulate", "--robot", (kConfig / "robots/kr5_arc.toml").string(),
                              "--plan", write_short_plan(folder).string(), "--to", daemon.address(),
                              "--timeout-cycles", "50"});
    const bool seen = eventually(
        [&] { return daemon.process().errors().find("joint 1: sweep of") != std::string::npos; });
    REQUIRE(seen);
    daemon.process().signal(signal);
    CHECK(daemon.process().wait() == 0);
    INFO(daemon.process().errors());
    const auto session = daemon.session();

    std::uint64_t telegrams = 0;
    std::uint64_t replies = 0;
    rsi::CaptureReader trace(session / "trace.pcap");
    while (const auto datagram = trace.next())
      ++(datagram->destination.port == daemon.port() ? telegrams : replies);
    CHECK(trace.notes().empty());
    CHECK(replies > 0);
    const auto result = Json::parse(content(session / "result.json"));
    CHECK(result["status"] == "partial");
    CHECK_FALSE(result["reason"].get<std::string>().empty());
    CHECK(result["source"]["telegrams"] == telegrams);
    CHECK(result["joints"][0]["sweeps"].size() >= 1);
    CHECK(Json::parse(content(session / "run.json")).contains("ended"));
    for (const auto& entry : std::filesystem::directory_iterator(session))
      CHECK(entry.path().extension() != ".tmp");

    // Without replies a controller stops: that is what the signal did to it, not sweepd's crash.
    CHECK(controller.wait() == 1);
  }
}
