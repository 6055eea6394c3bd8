#include <algorithm>
#include <array>
#include <csignal>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <poll.h>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using boost::asio::ip::udp;
using Json = nlohmann::json;

namespace {

/// A socket that talks to the daemon, in plain order: what was sent is answered before the next.
class Peer {
 public:
  Peer(const char* address, std::uint16_t server_port)
      : socket_(context_, {boost::asio::ip::make_address_v4(address), 0}),
        server_(boost::asio::ip::address_v4::loopback(), server_port) {}

  void send(std::string_view payload) {
    socket_.send_to(boost::asio::buffer(payload.data(), payload.size()), server_);
  }
  /// The reply to what was sent last; throws if there is none.
  std::string reply() {
    pollfd wanted{socket_.native_handle(), POLLIN, 0};
    if (poll(&wanted, 1, 20'000) != 1) throw std::runtime_error("no reply");
    std::array<char, 2048> buffer{};
    const auto size = socket_.receive(boost::asio::buffer(buffer));
    return {buffer.data(), size};
  }
  [[nodiscard]] std::size_t waiting() const { return socket_.available(); }

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
  udp::endpoint server_;
};

struct Garbage {
  std::string payload;
  const char* kind;        ///< as result.json names it; empty: a telegram after all
  std::uint64_t ipoc = 0;  ///< that can be found, and is answered; 0: none
};

}  // namespace

TEST_CASE("whatever comes to the port, every telegram is answered and everything is counted",
          "[garbage]") {
  constexpr std::size_t kLargest = 65'507;
  const std::string whole = telegram(77, joint_1_at(0));
  std::string binary;
  for (int k = 0; k < 1024; ++k) binary += static_cast<char>(k * 37 % 256);
  std::string huge_telegram = telegram(0, joint_1_at(0));  // its IPOC is set below
  huge_telegram.insert(huge_telegram.find("<AIPos"), kLargest - huge_telegram.size() - 3, ' ');

  const std::vector<Garbage> garbage{
      {"", "empty"},
      {" \r\n", "empty"},
      {std::string(64, '\0'), "empty"},
      {binary, "not a telegram"},
      {"GET / HTTP/1.1\r\nHost: robot\r\n\r\n", "not a telegram"},
      {"<Sen Type=\"ImFree\"><EStr></EStr></Sen>", "not a telegram"},
      {std::string(kLargest, '<'), "not a telegram"},
      {std::string(kLargest, 'x'), "not a telegram"},
      {whole.substr(0, whole.size() / 2), "truncated"},
      {"<Rob", "truncated"},
      {"<Rob Type=\"KUKA\">" + std::string(kLargest - 20, '"'), "truncated"},
      {"<Rob Type=\"KUKA\"><RIst X=\"1.0\"/></Rob>", "no IPOC"},
      {"<Rob Type=\"KUKA\"><IPOC>minus one</IPOC></Rob>", "no IPOC"},
      {"<Rob Type=\"KUKA\"><IPOC>18446744073709551616</IPOC></Rob>", "no IPOC"},
      {"<Rob Type=\"KUKA\"><IPOC>4242</IPOC>", "truncated", 4242},
      {binary + "<IPOC>4343</IPOC>", "not a telegram", 4343},
  };

  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  Peer controller("127.0.0.1", daemon.port());
  Peer stranger("127.0.0.2", daemon.port());
  std::uint64_t ipoc = 1'525'084;
  std::uint64_t telegrams = 0;
  const auto expect_answer = [&](const std::string& payload, const std::string& digits) {
    controller.send(payload);
    const auto reply = controller.reply();
    INFO(payload.substr(0, 80));
    CHECK(reply == "<Sen Type=\"ImFree\"><EStr></EStr><IPOC>" + digits + "</IPOC></Sen>");
  };
  const auto send_telegram = [&] {
    expect_answer(telegram(ipoc, joint_1_at(0)), std::to_string(ipoc));
    ipoc += 4;
    ++telegrams;
  };

  for (int k = 0; k < 4; ++k) send_telegram();  // now it streams, and others are strangers
  std::uint64_t answered_garbage = 0;
  std::uint64_t unanswerable = 0;
  std::uint64_t foreign = 0;
  Json kinds = Json::object();
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    for (const auto& [payload, kind, found] : garbage) {
      if (found != 0) {
        const auto begin = payload.rfind("<IPOC>") + 6;
        expect_answer(payload, payload.substr(begin, payload.rfind("</IPOC>") - begin));
        ++answered_garbage;
      } else {
        controller.send(payload);
        ++unanswerable;
      }
      kinds[kind] = kinds.value(kind, 0) + 1;
      // From another address not even a good telegram counts.
      stranger.send(payload);
      stranger.send(telegram(ipoc, joint_1_at(0)));
      foreign += 2;
      send_telegram();
    }
    auto huge = huge_telegram;
    const auto digits = std::to_string(ipoc);
    huge.replace(huge.find("<IPOC>0<") + 6, 1, digits);
    huge.erase(huge.find("   "), huge.size() - std::min(huge.size(), kLargest));
    expect_answer(huge, digits);
    ipoc += 4;
    ++telegrams;
  }
  CHECK(stranger.waiting() == 0);
  CHECK(daemon.process().running());

  daemon.process().signal(SIGTERM);
  REQUIRE(daemon.process().wait() == 0);
  const auto session = daemon.session();
  const auto source = Json::parse(content(session / "result.json"))["source"];
  CHECK(source["telegrams"] == telegrams);
  CHECK(source["lost"] == 0);
  CHECK(source["duplicated"] == 0);
  CHECK(source["restarts"] == 0);
  CHECK(source["malformed"] == garbage.size() * kRounds);
  CHECK(source["malformed_by_kind"] == kinds);
  const auto link = Json::parse(content(session / "run.json"))["since_start_of_sweepd"];
  CHECK(link["answered"] == telegrams + answered_garbage);
  CHECK(link["superseded"] == 0);
  CHECK(link["unanswerable"] == unanswerable);
  CHECK(link["foreign"] == foreign);
  CHECK(link["overflows"] == 0);
  CHECK(link["send_failures"] == 0);

  // The recording has the garbage too, and a replay counts the same.
  const auto replayed =
      run_sweepd({"replay", (session / "trace.pcap").string(), "--config", daemon.config().string(),
                  "--output", (folder / "replayed").string(), "--quiet"});
  CHECK(replayed.code == 1);  // nothing moved
  CHECK(content(folder / "replayed/result.json") == content(session / "result.json"));
}
