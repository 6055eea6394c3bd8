#include <csignal>
#include <filesystem>
#include <list>
#include <memory>

#include <nlohmann/json.hpp>

#include "rsi/asio.hpp"

#include "rsi/telegram/ethernet_config.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using Catch::Matchers::ContainsSubstring;

namespace {

std::filesystem::path controller() {
  return kConfig / "controller";
}

/// The value between <KEY> and </KEY> becomes another, as an engineer edits it.
std::string edited(std::string xml, const std::string& key, const std::string& value) {
  const auto begin = xml.find('<' + key + '>') + key.size() + 2;
  return xml.replace(begin, xml.find("</" + key + '>') - begin, value);
}

struct ShippedFile {
  std::string name;
  std::string cycle_ms;
  std::string settings = {};  ///< lines that follow in [[robot]]
};

/// sweepd and a simulated controller, both with one of the files.
class Campaign {
 public:
  explicit Campaign(const ShippedFile& shipped) : shipped_(shipped) {
    const auto original = rsi::EthernetConfig::load(controller() / shipped.name);
    only_send_ = original.only_send;
    const bool tcp = original.protocol == rsi::EthernetConfig::Protocol::TCP;
    const std::string port = std::to_string(tcp ? free_tcp_port() : free_port());
    const std::string address = "127.0.0.1:" + port;
    // What the file tells the engineer to edit, and nothing else.
    const auto ethernet =
        folder_.write("ethernet.xml",
                      edited(edited(content(controller() / shipped.name), "IP_NUMBER", "127.0.0.1"),
                             "PORT", port));
    const auto settings = folder_.write(
        "sweepd.toml", "[http]\nlisten = \"off\"\n[[robot]]\nname = \"kr5-arc\"\ndescription = \"" +
                           std::string(kRobot) + "\"\nlisten = \"" + address +
                           "\"\noutput = \"output\"\nethernet_config = \"ethernet.xml\"\n" +
                           shipped.settings);
    const auto checked = run_sweepd({"check", "--files-only", "--config", settings.string()});
    INFO(shipped.name << '\n' << checked.out << checked.errors);
    CHECK(checked.code == 0);

    daemon_ = std::make_unique<SweepdProcess>(
        std::vector<std::string>{"run", "--config", settings.string()});
    const std::string listening = std::string("listening on ") + (tcp ? "TCP " : "UDP ") + address;
    REQUIRE(eventually([&] {
      return !daemon_->running() || daemon_->errors().find(listening) != std::string::npos;
    }));
    REQUIRE(daemon_->running());
    controller_ = std::make_unique<SweepdProcess>(std::vector<std::string>{
        "simulate", "--robot", kRobot, "--plan", write_short_plan(folder_).string(), "--cycle-ms",
        shipped.cycle_ms, "--ethernet-config", ethernet.string(), "--to", address, "--check",
        "sweepd"});
  }

  void check_end() {
    const int code = controller_->wait();
    const std::string report = controller_->out();
    INFO(shipped_.name << '\n' << report << controller_->errors());
    CHECK_THAT(report, ContainsSubstring("played to its end") &&
                           ContainsSubstring("replies refused                  0"));
    const auto telegrams = figure(report, "\ntelegrams ");
    CHECK(telegrams > 0);
    if (only_send_) {
      CHECK(code == 0);
      CHECK_THAT(report, ContainsSubstring("none expected: ONLYSEND"));
    } else {
      // Whether a reply came in time, or a newer one before it, is up to this machine.
      const auto accepted = figure(report, "\nreplies accepted ");
      const auto late = figure(report, "\nreplies late ");
      const auto unanswered = figure(report, "\ncycles unanswered ");
      CHECK(10 * (accepted + late) >= 9 * telegrams);
      CHECK((code == 0 || late + unanswered > 0));
    }
    daemon_->signal(SIGTERM);
    REQUIRE(daemon_->wait() == 0);

    std::filesystem::path session;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "output/kr5-arc"))
      session = entry.path();
    const auto result = nlohmann::json::parse(content(session / "result.json"));
    CHECK(result["source"]["telegrams"] == telegrams);
    CHECK(result["source"]["lost"].get<std::uint64_t>() <= figure(report, "\ncycles overslept "));
    CHECK(result["source"]["malformed"] == 0);
    // The simulator knows no channels that objects feed: it sends zeros there.
    if (shipped_.settings.empty()) CHECK(result["status"] == "complete");
  }

 private:
  ShippedFile shipped_;
  bool only_send_ = false;
  TemporaryFolder folder_;
  std::unique_ptr<SweepdProcess> daemon_;
  std::unique_ptr<SweepdProcess> controller_;
};

}  // namespace

TEST_CASE("each Ethernet file for the controller passes sweepd check as it is shipped",
          "[controller_files]") {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(controller())) {
    const auto name = entry.path().filename().string();
    if (!name.ends_with(".xml") || name.ends_with(".rsi.xml")) continue;
    ++files;
    const auto checked = run_sweepd({"check", "--ethernet-config", entry.path().string()});
    INFO(checked.out << checked.errors);
    CHECK(checked.code == 0);
    if (name == "sweepd_actpos.xml")
      CHECK_THAT(checked.out, ContainsSubstring("no DEF_RIst"));  // which is its purpose
    else
      CHECK_THAT(checked.out, !ContainsSubstring("warning"));
  }
  CHECK(files == 7);
}

TEST_CASE("each Ethernet file for the controller serves both sides of a campaign",
          "[controller_files]") {
  std::list<Campaign> campaigns;  // all at once
  for (const ShippedFile& file : {
           ShippedFile{"krc2/sweepd_udp.xml", "12"},
           ShippedFile{"krc2/sweepd_udp_onlysend.xml", "12"},
           ShippedFile{"krc2/sweepd_tcp.xml", "12"},
           ShippedFile{"krc2/sweepd_tcp_onlysend.xml", "12"},
           ShippedFile{"krc2/sweepd_actpos.xml", "12",
                       "[robot.signals]\nposition = [\"Pos.X\", \"Pos.Y\", \"Pos.Z\"]\n"},
           ShippedFile{"krc4/sweepd_ethernet.xml", "4"},
           ShippedFile{"krc4/sweepd_onlysend.xml", "4"},
       })
    campaigns.emplace_back(file);
  for (Campaign& campaign : campaigns) campaign.check_end();
}
