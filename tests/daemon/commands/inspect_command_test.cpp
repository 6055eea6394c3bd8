#include "daemon/commands/inspect_command.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "rsi/capture/capture_writer.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/rsi/link_stream.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::inspect;
using sweepd::InspectOptions;
using namespace rsi::test;
using sweepd::test::content;
using sweepd::test::TemporaryFolder;
namespace fs = std::filesystem;

namespace {

/// A capture of both directions.
class Trace {
 public:
  explicit Trace(const fs::path& file) : writer_(file) {}
  void telegram(const rsi::Datagram& datagram) { writer_.write(datagram); }
  void reply(const rsi::Datagram& datagram) { writer_.write(datagram); }

 private:
  rsi::CaptureWriter writer_;
};

void write_cycles(const fs::path& file, std::uint64_t first, std::uint64_t end,
                  std::chrono::nanoseconds latency = 50us) {
  Trace trace(file);
  LinkStream(trace).cycles(first, end, latency);
}

struct Inspected {
  int code = 0;
  std::string text;
  std::string errors;
};

Inspected inspected(const InspectOptions& options) {
  std::ostringstream out;
  std::ostringstream errors;
  const int code = inspect(options, out, errors);
  return {code, out.str(), errors.str()};
}

}  // namespace

TEST_CASE("a good link is exit 0 with a report; a bad one exit 1", "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "x.pcap", 0, 500);
  const auto good = inspected({.traces = {folder / "x.pcap"}});
  CHECK(good.code == 0);
  CHECK(good.errors.empty());
  CHECK_THAT(good.text, ContainsSubstring("Link of 192.168.1.20 with 192.168.1.10:49152") &&
                            ContainsSubstring("Verdict: good") &&
                            ContainsSubstring("Replies                        500"));
  write_cycles(folder / "x.pcap", 0, 500, 5ms);
  const auto bad = inspected({.traces = {folder / "x.pcap"}});
  CHECK(bad.code == 1);
  CHECK_THAT(bad.text, ContainsSubstring("Verdict: bad"));
}

TEST_CASE("parts of one recording are one link", "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "trace.pcap", 0, 500);
  write_cycles(folder / "trace-0002.pcap", 500, 800);
  const auto both = inspected({.traces = {folder / "trace.pcap", folder / "trace-0002.pcap"}});
  CHECK(both.code == 0);
  CHECK_THAT(both.text, ContainsSubstring("Telegrams                      800") &&
                            ContainsSubstring("lost                           0") &&
                            ContainsSubstring("3.196 s"));
}

TEST_CASE("the JSON goes into a file beside the text, or to standard output in its place",
          "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "x.pcap", 0, 500);
  const auto beside = inspected({.traces = {folder / "x.pcap"}, .json = folder / "link.json"});
  CHECK_THAT(beside.text, ContainsSubstring("Verdict: good"));
  const auto alone = inspected({.traces = {folder / "x.pcap"}, .json = "-"});
  CHECK(alone.text == content(folder / "link.json"));
  CHECK(nlohmann::json::parse(alone.text)["schema"] == "sweepd.link/1");
  const auto quiet = inspected({.traces = {folder / "x.pcap"}, .quiet = true});
  CHECK(quiet.text.empty());
  CHECK(quiet.code == 0);
  CHECK(quiet.errors.empty());
}

TEST_CASE("of few telegrams a link is good as far as they can tell", "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "x.pcap", 0, 38);
  const auto few = inspected({.traces = {folder / "x.pcap"}});
  CHECK(few.code == 0);
  CHECK_THAT(few.text, ContainsSubstring("Verdict: good, as far as 38 telegrams can tell\n"));
  write_cycles(folder / "y.pcap", 0, 1000);
  const auto enough = inspected({.traces = {folder / "y.pcap"}});
  CHECK_THAT(enough.text, ContainsSubstring("Verdict: good\n"));
}

TEST_CASE("a bad link is said in one line where nothing else is printed", "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "x.pcap", 0, 500, 5ms);
  const auto bad = inspected({.traces = {folder / "x.pcap"}, .quiet = true});
  CHECK(bad.code == 1);
  CHECK(bad.text.empty());
  CHECK_THAT(bad.errors, ContainsSubstring("sweepd: the link is bad: ") &&
                             ContainsSubstring("got no reply within a cycle"));
}

TEST_CASE("one conversation of several is chosen, by port or by controller", "[inspect_command]") {
  const TemporaryFolder folder;
  {
    Trace trace(folder / "x.pcap");
    LinkStream first(trace);
    LinkStream second(trace);
    second.controller = {0xc0a8011e, 49200};  // 192.168.1.30
    for (std::uint64_t k = 0; k < 300; ++k) {
      first.cycles(k, k + 1);
      if (k < 200) second.cycles(k, k + 1);
    }
  }
  const auto busiest = inspected({.traces = {folder / "x.pcap"}});
  CHECK_THAT(busiest.text, ContainsSubstring("Telegrams                      300"));
  CHECK_THAT(busiest.errors,
             ContainsSubstring("192.168.1.30") && ContainsSubstring("--controller"));
  const auto other =
      inspected({.traces = {folder / "x.pcap"}, .filter = {.controller = 0xc0a8011eU}});
  CHECK_THAT(other.text, ContainsSubstring("Telegrams                      200") &&
                             ContainsSubstring("Replies                        200"));
}

TEST_CASE("a capture without RSI is exit 1 with one sentence", "[inspect_command]") {
  const TemporaryFolder folder;
  {
    Trace trace(folder / "x.pcap");
    LinkStream(trace).datagram(0ms, "something else");
  }
  const auto none = inspected({.traces = {folder / "x.pcap"}});
  CHECK(none.code == 1);
  CHECK(none.text.empty());
  CHECK_THAT(none.errors,
             ContainsSubstring("sweepd: no RSI among 1 UDP datagram (IPv4) in 1 packet:"));
}

TEST_CASE("a capture that is cut off is inspected as far as it goes, and said",
          "[inspect_command]") {
  const TemporaryFolder folder;
  write_cycles(folder / "x.pcap", 0, 500);
  fs::resize_file(folder / "x.pcap", fs::file_size(folder / "x.pcap") - 5);
  const auto cut = inspected({.traces = {folder / "x.pcap"}});
  CHECK(cut.code == 0);
  CHECK_THAT(cut.text, ContainsSubstring("Telegrams                      500") &&
                           ContainsSubstring("Replies                        499"));
  CHECK_THAT(cut.errors, ContainsSubstring("cut off"));
}
