#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>

#include <nlohmann/json.hpp>

#include "rsi/asio.hpp"

#include "rsi/telegram/ipoc.hpp"
#include "tests/catch.hpp"
#include "tests/scenarios/streamer.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using boost::asio::ip::udp;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::json;

namespace {

/// Another server, which moves the robot by absolute corrections as long as it lives.
class OtherServer {
 public:
  explicit OtherServer(std::uint16_t port)
      : socket_(context_, {boost::asio::ip::address_v4::loopback(), port}) {
    answer_next();
    thread_ = std::thread([this] { context_.run(); });
  }
  ~OtherServer() {
    context_.stop();
    thread_.join();
  }
  OtherServer(const OtherServer&) = delete;
  OtherServer& operator=(const OtherServer&) = delete;

 private:
  void answer_next() {
    socket_.async_receive_from(
        boost::asio::buffer(buffer_), peer_, [this](const auto& error, std::size_t size) {
          const std::string ipoc(rsi::find_ipoc({buffer_.data(), size}));
          boost::system::error_code gone;
          if (!error)
            socket_.send_to(boost::asio::buffer("<Sen Type=\"ImFree\"><RKorr X=\"50\"/><IPOC>" +
                                                ipoc + "</IPOC></Sen>"),
                            peer_, 0, gone);
          answer_next();
        });
  }

  boost::asio::io_context context_;
  udp::socket socket_;
  udp::endpoint peer_;
  std::array<char, 2048> buffer_{};
  std::thread thread_;
};

/// A controller that another server has moved by 50 mm before it went, with sweepd in its place.
class Takeover {
 public:
  explicit Takeover(const std::string& received, const std::string& settings = "") {
    switch_on();
    {
      const OtherServer other(port_);
      REQUIRE(eventually([&] { return answered_since(0) > 20; }));
    }
    auto ethernet = content(kConfig / "controller/krc4/sweepd_ethernet.xml");
    ethernet.replace(ethernet.find("49152"), 5, std::to_string(port_));
    ethernet.insert(ethernet.find("</ELEMENTS>", ethernet.find("<RECEIVE>")), received);
    static_cast<void>(folder_.write("ethernet.xml", ethernet));
    const auto config = folder_.write(
        "sweepd.toml", "[http]\nlisten = \"off\"\n[[robot]]\nname = \"kr5-arc\"\ndescription = \"" +
                           (kConfig / "robots/kr5_arc.toml").string() +
                           "\"\nlisten = \"127.0.0.1:" + std::to_string(port_) +
                           "\"\noutput = \"output\"\nethernet_config = \"ethernet.xml\"\n" +
                           settings);
    daemon_ = std::make_unique<SweepdProcess>(
        std::vector<std::string>{"run", "--config", config.string()});
    REQUIRE(eventually([&] { return says("listening on"); }));
    taken_over_ = streamer_->sent().size();
  }

  [[nodiscard]] bool says(const std::string& text) const {
    return daemon_->errors().find(text) != std::string::npos;
  }
  /// Telegrams since sweepd listens.
  [[nodiscard]] std::size_t telegrams() const { return streamer_->sent().size() - taken_over_; }
  [[nodiscard]] std::size_t answered() const { return answered_since(taken_over_); }

  /// The network is down for so many cycles, in which RSI goes on.
  void lose(std::uint64_t cycles) {
    fall_silent(cycles);
    speaks_ = true;
  }
  /// RSI is off for so many cycles, then on.
  void restart(std::uint64_t cycles) {
    fall_silent(cycles);
    streamer_.reset();
    speaks_ = true;
    switch_on();
    taken_over_ = 0;
  }
  [[nodiscard]] std::filesystem::path session() const {
    for (const auto& session : std::filesystem::directory_iterator(folder_ / "output/kr5-arc"))
      return session.path();
    return {};
  }
  /// What sweepd writes of the link.
  Json end() {
    daemon_->signal(SIGUSR1);  // of a good link without sweeps nothing is written by itself
    REQUIRE(eventually([&] { return std::filesystem::exists(session() / "link.txt"); }));
    static_cast<void>(streamer_->stop());
    daemon_->signal(SIGTERM);
    REQUIRE(daemon_->wait() == 0);
    return Json::parse(content(session() / "link.json"));
  }

 private:
  void fall_silent(std::uint64_t cycles) {
    speaks_ = false;
    const auto until = cycles_ + cycles;
    REQUIRE(eventually([&] { return cycles_ >= until; }));
  }
  void switch_on() {
    streamer_.emplace(port_, Streamer::Options{.speaks = [this](std::uint64_t cycle) {
                        cycles_ = cycle;
                        return speaks_.load();
                      }});
  }
  [[nodiscard]] std::size_t answered_since(std::size_t first) const {
    const auto sent = streamer_->sent();
    return static_cast<std::size_t>(
        std::count_if(sent.begin() + static_cast<std::ptrdiff_t>(first), sent.end(),
                      [](const auto& telegram) { return telegram.answered_after.has_value(); }));
  }

  TemporaryFolder folder_;
  std::uint16_t port_ = free_port();
  std::atomic<std::uint64_t> cycles_{0};
  std::atomic<bool> speaks_{true};
  std::optional<Streamer> streamer_;
  std::unique_ptr<SweepdProcess> daemon_;
  std::size_t taken_over_ = 0;
};

const std::string kCorrection =
    "<ELEMENT TAG=\"RKorr.X\" TYPE=\"DOUBLE\" INDX=\"1\" HOLDON=\"1\"/>";

}  // namespace

TEST_CASE("a robot that another server moves is not taken over, but answered when RSI starts anew",
          "[takeover][issue11][point_1]") {
  Takeover takeover(kCorrection, "answers_with_zeros = [\"RKorr.X\"]\n");
  REQUIRE(eventually([&] { return takeover.says("the stream had begun before sweepd listened"); }));
  REQUIRE(eventually([&] { return takeover.telegrams() > 300; }));
  CHECK(takeover.answered() == 0);

  takeover.lose(350);  // of 4 ms: 1.4 s
  const auto before = takeover.telegrams();
  REQUIRE(eventually([&] { return takeover.telegrams() > before + 50; }));
  CHECK(takeover.answered() == 0);

  takeover.restart(350);
  CHECK(eventually([&] { return takeover.answered() > 100; }));
  const auto link = takeover.end();
  INFO(link.dump(2));
  CHECK(link["replies"]["withheld"] > 300);
  CHECK(link["replies"]["sent"] > 100);
  CHECK(link["reasons"][0]["code"] == "not_begun");
}

TEST_CASE("a stream that is not answered to its end is not called bad for the network's sake",
          "[takeover][issue11][point_1]") {
  Takeover takeover(kCorrection, "answers_with_zeros = [\"RKorr.X\"]\n");
  REQUIRE(eventually([&] { return takeover.telegrams() > 100; }));
  const auto link = takeover.end();
  INFO(link.dump(2));
  CHECK(link["replies"]["sent"] == 0);
  CHECK(link["reasons"][0]["code"] == "not_begun");
  CHECK_FALSE(takeover.says("what kept this machine busy"));
  CHECK(takeover.says("it was not answered, since it had begun before sweepd listened"));
}

TEST_CASE("a stream that zeros cannot harm is taken over at once", "[takeover][issue11][point_1]") {
  Takeover takeover("");
  CHECK(eventually([&] { return takeover.answered() > 50; }));
  const auto link = takeover.end();
  CHECK(link["replies"]["withheld"] == 0);
}
