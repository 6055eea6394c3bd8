// As many telegrams as wanted go to the real service over a network that spoils them in every way
// that is known; all that can be counted is counted beside it, and compared. The next telegram
// leaves when the last one that can be answered was: so nothing depends on how fast the machine is.
// 20,000 telegrams, or as many as SWEEPD_TELEGRAMS says.

#include <array>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include "rsi/asio.hpp"

#include "daemon/replay_command.hpp"
#include "daemon/robot_description.hpp"
#include "daemon/robot_service.hpp"
#include "daemon/simulated_robot.hpp"
#include "daemon/sweep_plan.hpp"
#include "rsi/capture_writer.hpp"
#include "rsi/faulty_wire.hpp"
#include "rsi/ipoc.hpp"
#include "rsi/reply.hpp"
#include "rsi/simulated_controller.hpp"
#include "tests/catch.hpp"
#include "tests/scenarios/sweepd_process.hpp"

using namespace sweepd::test;
using boost::asio::ip::udp;
using rsi::ReplyFault;
using What = rsi::Sent::What;
using Json = nlohmann::json;

namespace {

const auto kRobot = kConfig / "robots/kr5_arc.toml";
const auto kPlan = kConfig / "plans/kr5_arc_90deg.toml";
const auto kEthernet = kConfig / "controller/krc4/sweepd_ethernet.xml";
constexpr std::chrono::milliseconds kCycle{4};

std::uint64_t wanted_telegrams() {
  const char* const text = std::getenv("SWEEPD_TELEGRAMS");
  return text == nullptr ? 20'000 : std::stoull(text);
}

/// A controller whose robot repeats the plan, and whose RSI is now and then restarted while the
/// robot rests. The same each time.
class Controller {
 public:
  explicit Controller(const rsi::Endpoint& server)
      : rsi_(rsi::EthernetConfig::load(kEthernet),
             {.server = server, .cycle = kCycle, .first_ipoc = next_start()}) {}

  /// Goes on by a cycle; whether RSI was restarted before it. Then the IPOC starts anew.
  bool next() {
    const auto before = values_.ASPos;
    if (!robot_.next(values_)) {
      robot_ = start();
      static_cast<void>(robot_.next(values_));
    }
    const bool rests = values_.ASPos == before;
    return rests && random_() % 250 == 0;
  }
  void restart() { rsi_.restart(next_start()); }
  /// The telegram of this cycle.
  std::string_view telegram() {
    telegram_.clear();
    if (!rsi_.next_telegram(values_, telegram_)) throw std::runtime_error("RSI has stopped");
    rsi_.sent({});
    return telegram_;
  }
  rsi::SimulatedController& rsi() { return rsi_; }

 private:
  static sweepd::SimulatedRobot start() {
    return {sweepd::load_robot(kRobot), sweepd::load_plan(kPlan), {}};
  }

  /// Of real controllers, and just below the powers of two at which counters pass over.
  std::uint64_t next_start() {
    const std::uint64_t back = 4 * (100 + random_() % 400);
    const std::array starts{1'525'084 + back, (std::uint64_t{1} << 32) - back,
                            999'999'000'000 + back, 0 - back};
    return starts[starts_++ % starts.size()];
  }

  std::mt19937_64 random_{3};
  std::size_t starts_ = 0;
  sweepd::SimulatedRobot robot_ = start();
  rsi::SignalValues values_;
  rsi::SimulatedController rsi_;
  std::string telegram_;
};

/// A socket that waits at most ten seconds for a reply.
class Peer {
 public:
  Peer(const char* address, const rsi::Endpoint& server)
      : socket_(context_, {boost::asio::ip::make_address_v4(address), 0}),
        server_(boost::asio::ip::address_v4(server.address), server.port) {
    const timeval longest{10, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  }
  void send(std::string_view payload) {
    socket_.send_to(boost::asio::buffer(payload.data(), payload.size()), server_);
  }
  std::string_view reply() {
    const auto size = recv(socket_.native_handle(), buffer_.data(), buffer_.size(), 0);
    if (size < 0) throw std::runtime_error("no reply");
    return {buffer_.data(), static_cast<std::size_t>(size)};
  }
  [[nodiscard]] std::size_t waiting() const { return socket_.available(); }

 private:
  boost::asio::io_context context_;
  udp::socket socket_;
  udp::endpoint server_;
  std::array<char, 2048> buffer_{};
};

/// The kind of malformed datagram that this is, as result.json names it.
const char* kind_of(const rsi::Sent& sent) {
  constexpr std::string_view kBlank(" \t\r\n\0", 5);
  if (sent.payload.find_first_not_of(kBlank) == std::string_view::npos) return "empty";
  return sent.payload.starts_with("<Rob") ? "truncated" : "not a telegram";
}

/// A controller answers what has an IPOC that something follows.
bool has_ipoc(std::string_view payload) {
  const auto ipoc = payload.find("<IPOC>");
  return ipoc != std::string_view::npos && payload.find('<', ipoc + 1) != std::string_view::npos;
}

std::uint64_t delay_in(std::string_view telegram) {
  constexpr std::string_view kTag = "<Delay D=\"";
  const auto at = telegram.find(kTag) + kTag.size();
  std::uint64_t delay = 0;
  std::from_chars(telegram.data() + at, telegram.data() + telegram.size(), delay);
  return delay;
}

/// What went out, counted here.
struct Expected {
  std::uint64_t whole = 0;
  std::uint64_t restarts = 0;
  std::uint64_t answered = 0;
  std::uint64_t unanswerable = 0;
  std::uint64_t late = 0;  ///< by the Delay of the telegrams that came whole and in order
  std::uint64_t late_runs = 0;
  std::uint64_t longest_late_run = 0;
  Json malformed = Json::object();
  std::vector<bool> came;  ///< by number, whole
};

/// Plays the controller over the faulty wire.
class Campaign {
 public:
  explicit Campaign(const rsi::Endpoint& server)
      : server_(server),
        controller_(server),
        wire_({.lose = 0.01,
               .duplicate = 0.005,
               .swap = 0.005,
               .cut = 0.01,
               .garbage = 0.005,
               .foreign = 0.005},
              7),
        peer_(std::make_unique<Peer>("127.0.0.1", server)),
        stranger_("127.0.0.2", server) {}

  void play(std::uint64_t telegrams) {
    expected_.came.resize(telegrams);
    for (number_ = 0; number_ < telegrams; ++number_) {
      if (controller_.next() && number_ > 0) {
        end_run();
        auto renewed = std::make_unique<Peer>("127.0.0.1", server_);  // has another port
        peer_ = std::move(renewed);
        controller_.restart();
        ++expected_.restarts;
      }
      const auto telegram = controller_.telegram();
      send(wire_.pass(telegram));
    }
    end_run();
    CHECK(stranger_.waiting() == 0);
  }

  [[nodiscard]] const Expected& expected() const { return expected_; }
  [[nodiscard]] const rsi::FaultyWire::Counts& wire() const { return wire_.counts(); }
  [[nodiscard]] const rsi::SimulatedController& rsi() { return controller_.rsi(); }

 private:
  void end_run() {
    --number_;  // one that was held back is the last of this run
    send(wire_.flush());
    ++number_;
    controller_.rsi().finish();
    CHECK(peer_->waiting() == 0);
  }

  void send(const std::vector<rsi::Sent>& datagrams) {
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      const auto& sent = datagrams[i];
      if (sent.what == What::foreign) {
        stranger_.send(sent.payload);
        continue;
      }
      if (sent.what == What::telegram) {
        const bool again =
            i > 0 && sent.payload == datagrams[0].payload && datagrams[0].what == What::telegram;
        const bool overtaken = i > 0 && !again && datagrams[0].what == What::telegram;
        ++expected_.whole;
        expected_.came[overtaken ? number_ - 1 : number_] = true;
        if (!again && !overtaken) count_late(delay_in(sent.payload));
      } else {
        auto& kind = expected_.malformed[kind_of(sent)];
        kind = kind.is_null() ? 1 : kind.get<int>() + 1;
      }
      peer_->send(sent.payload);
      if (has_ipoc(sent.payload))
        take_reply(sent.payload);
      else
        ++expected_.unanswerable;
    }
  }

  void take_reply(std::string_view telegram) {
    const auto reply = peer_->reply();
    // Not a CHECK for each of a million.
    if (rsi::find_ipoc(reply) != rsi::find_ipoc(telegram))
      FAIL("to " << telegram << " the reply " << reply);
    controller_.rsi().on_reply(reply, server_, {});
    ++expected_.answered;
  }

  /// One in order was answered, whatever was before it: its Delay ends a run.
  void count_late(std::uint64_t delay) {
    if (delay == 0) return;
    expected_.late += delay;
    ++expected_.late_runs;
    expected_.longest_late_run = std::max(expected_.longest_late_run, delay);
  }

  rsi::Endpoint server_;
  Controller controller_;
  rsi::FaultyWire wire_;
  std::unique_ptr<Peer> peer_;
  Peer stranger_;
  std::uint64_t number_ = 0;
  Expected expected_;
};

/// A replay of the same telegrams as they were before the wire spoilt them.
Json replay_clean(std::uint64_t telegrams, const TemporaryFolder& folder) {
  constexpr std::chrono::seconds kStart{1'735'689'600};
  rsi::Datagram datagram{kStart,
                         *rsi::parse_endpoint("192.168.1.20:49153"),
                         *rsi::parse_endpoint("192.168.1.10:49152"),
                         {},
                         false};
  Controller controller(datagram.destination);
  rsi::Reply reply(rsi::EthernetConfig::load(kEthernet));
  {
    rsi::CaptureWriter capture(folder / "clean.pcap");
    for (std::uint64_t k = 0; k < telegrams; ++k, datagram.time += kCycle) {
      if (controller.next() && k > 0) {
        controller.restart();
        ++datagram.source.port;
      }
      datagram.payload = controller.telegram();
      capture.write(datagram);
      const auto answer = reply.with_ipoc(rsi::find_ipoc(datagram.payload));
      controller.rsi().on_reply(answer, datagram.destination, {});
    }
    REQUIRE(capture.flush());
  }
  sweepd::ReplayOptions options;
  options.traces = {folder / "clean.pcap"};
  options.config = kConfig / "sweepd.toml";
  options.output = folder / "clean";
  options.quiet = true;
  REQUIRE(sweepd::replay(options) == 0);
  return Json::parse(content(folder / "clean/result.json"));
}

void check_samples(const std::filesystem::path& found, const std::filesystem::path& clean,
                   const std::vector<bool>& came) {
  std::ifstream found_file(found), clean_file(clean);
  std::string row, clean_row;
  const auto all_but_time = [](const std::string& line) { return line.substr(line.find(',')); };
  REQUIRE(std::getline(found_file, row));
  REQUIRE(std::getline(clean_file, clean_row));
  CHECK(row == clean_row);
  std::uint64_t differing = 0;
  for (const bool here : came) {
    REQUIRE(std::getline(clean_file, clean_row));
    if (!here) continue;
    REQUIRE(std::getline(found_file, row));
    differing += all_but_time(row) != all_but_time(clean_row);
  }
  CHECK(differing == 0);
  CHECK_FALSE(std::getline(found_file, row));
}

bool memory_was_full(const Json& result) {
  for (const auto& warning : result["warnings"])
    if (warning["code"] == "memory_limit") return true;
  return false;
}

void check_sweeps(const Json& found, const Json& clean) {
  for (std::size_t j = 0; j < 6; ++j) {
    const auto& sweeps = found["joints"][j]["sweeps"];
    const auto& expected = clean["joints"][j]["sweeps"];
    const auto count = std::min(sweeps.size(), expected.size());
    // With lost samples the memory is full a little later.
    if (!memory_was_full(clean)) REQUIRE(sweeps.size() == expected.size());
    CHECK(count > 0);
    for (std::size_t s = 0; s < count; ++s) {
      INFO("joint " << j + 1 << ", sweep " << s + 1);
      CHECK(sweeps[s]["direction"] == expected[s]["direction"]);
      CHECK(sweeps[s].contains("positioning") == expected[s].contains("positioning"));
      CHECK(sweeps[s]["used"] == expected[s]["used"]);
      // At 60 deg/s, the plan's fastest, a cycle of 4 ms is 0.24 degrees.
      CHECK(sweeps[s]["range_deg"].get<double>() ==
            Approx(expected[s]["range_deg"].get<double>()).margin(0.24));
    }
  }
}

}  // namespace

TEST_CASE("whatever a network does to a long stream is counted exactly, and answered once",
          "[million_telegrams]") {
  spdlog::set_level(spdlog::level::off);
  const auto telegrams = wanted_telegrams();
  const TemporaryFolder folder;
  sweepd::RobotSettings settings;
  settings.name = "kr5-arc";
  settings.description = kRobot;
  settings.listen = {*rsi::parse_address("127.0.0.1"), 0};
  settings.ethernet_config = kEthernet;
  settings.output = folder / "out";
  // Lockstep is faster than any controller; and the samples are to lie in one file.
  settings.queue_bytes = std::size_t{64} << 20;
  settings.recording.memory_bytes = std::size_t{1} << 30;
  settings.recording.rotate_bytes = std::uint64_t{1} << 40;
  settings.real_time.wish = sweepd::RealTime::off;
  settings.silence = std::chrono::minutes(10);  // the one stream ends with the service
  sweepd::RobotService service(settings);
  service.start();

  Campaign campaign(service.local());
  campaign.play(telegrams);
  service.stop();

  const auto& wire = campaign.wire();
  const auto& expected = campaign.expected();
  for (const auto count : {wire.lost, wire.duplicated, wire.swapped, wire.cut, wire.garbage,
                           wire.foreign, expected.restarts})
    CHECK(count >= telegrams / 10'000);

  std::vector<std::filesystem::path> sessions;
  for (const auto& entry : std::filesystem::directory_iterator(settings.output / "kr5-arc"))
    sessions.push_back(entry.path());
  REQUIRE(sessions.size() == 1);
  const auto result = Json::parse(content(sessions[0] / "result.json"));
  const auto& source = result["source"];
  CHECK(source["telegrams"] == expected.whole);
  CHECK(expected.whole == telegrams - wire.lost - wire.cut + wire.duplicated);
  CHECK(source["lost"] == wire.lost + wire.cut - wire.missing_at_end);
  CHECK(source["duplicated"] == wire.duplicated);
  CHECK(source["reordered"] == wire.swapped);
  CHECK(source["restarts"] == expected.restarts);
  CHECK(source["late_replies"] == expected.late);
  CHECK(source["late_runs"] == expected.late_runs);
  CHECK(source["longest_late_run"] == expected.longest_late_run);
  CHECK(source["malformed"] == wire.cut + wire.garbage);
  CHECK(source["malformed_by_kind"] == expected.malformed);
  CHECK(source["cycle_ms"] == 4.0);

  const auto run = Json::parse(content(sessions[0] / "run.json"));
  const auto& link = run["since_start_of_sweepd"];
  CHECK(link["answered"] == expected.answered);
  CHECK(link["unanswerable"] == expected.unanswerable);
  CHECK(link["foreign"] == wire.foreign);
  for (const char* none :
       {"superseded", "refused", "cut", "send_failures", "dropped", "overflows"}) {
    INFO(none);
    CHECK(link[none] == 0);
  }

  const auto& recording = run["recording"];
  CHECK(recording["samples"] == telegrams - wire.lost - wire.cut);
  CHECK(recording["datagrams"] ==
        expected.whole + wire.cut + wire.garbage + expected.answered);  // both directions

  // The controller's own verdict on the replies. To those that were swapped they come late, to the
  // doubled ones twice.
  auto faults = campaign.rsi().counts().faults;
  INFO(campaign.rsi().first_fault());
  CHECK(faults[static_cast<std::size_t>(ReplyFault::late)] == wire.swapped);
  CHECK(faults[static_cast<std::size_t>(ReplyFault::repeated)] == wire.duplicated);
  faults[static_cast<std::size_t>(ReplyFault::late)] = 0;
  faults[static_cast<std::size_t>(ReplyFault::repeated)] = 0;
  CHECK(faults == decltype(faults){});
  CHECK(campaign.rsi().counts().replies == expected.answered);

  const auto clean = replay_clean(telegrams, folder);
  CHECK(clean["source"]["telegrams"] == telegrams);
  CHECK(clean["source"]["restarts"] == expected.restarts);
  for (const char* none : {"lost", "duplicated", "reordered", "malformed", "late_replies"}) {
    INFO(none);
    CHECK(clean["source"][none] == 0);
  }
  check_samples(sessions[0] / "samples.csv", folder / "clean/samples.csv", expected.came);
  check_sweeps(result, clean);
  CHECK(result["status"] == "complete");
}
