#include "daemon/session.hpp"

#include <sstream>

#include "daemon/result_json.hpp"
#include "rsi/capture_reader.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/daemon/temporary_folder.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::Session;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

sweepd::RobotSetup setup(std::size_t joints = 6) {
  sweepd::RobotSetup result;
  result.name = "kr5-arc";
  result.joints = joints;
  return result;
}

void stroke(Session& session, std::uint64_t& ipoc, double from_deg, double to_deg) {
  for (const double angle : stroke_deg(from_deg, to_deg)) {
    const auto text = telegram(ipoc, joint_1_at(angle));
    session.telegram(from_controller(text, std::chrono::milliseconds(ipoc)));
    ipoc += 4;
  }
}

}  // namespace

TEST_CASE("a session without a folder leaves no files, and identifies all the same") {
  int sweeps = 0;
  Session session(setup(), {}, {[&](const identify::Sweep&) { ++sweeps; }, {}});
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 60);
  session.finish();
  CHECK(sweeps == 1);
  const auto outcome = session.snapshot().identified();
  CHECK(outcome.robot == "kr5-arc");
  CHECK(outcome.source_kind == "trace");
  CHECK(outcome.counts.link.telegrams == 400);
  CHECK(outcome.identification.joints.at(0).circle->radius_mm == Approx(500).margin(1e-3));
}

TEST_CASE("samples.csv has a header and a row a sample, trace.pcap both directions") {
  const TemporaryFolder folder;
  const auto reply = std::string("<Sen Type=\"ImFree\"><IPOC>4000</IPOC></Sen>");
  {
    Session session(setup(), {folder.path(), true, "trace"}, {});
    const auto text = telegram(4000, joint_1_at(0));
    session.telegram(from_controller(text, 1h));
    session.reply({1h + 20us, kServer, kController, reply, false});
    session.telegram(from_controller("junk", 1h + 1ms));
    session.finish();
  }
  std::istringstream samples(content(folder / "samples.csv"));
  std::string line;
  REQUIRE(std::getline(samples, line));
  CHECK(line.starts_with("t_s,ipoc,x_mm,"));
  REQUIRE(std::getline(samples, line));
  CHECK(line.starts_with("0.000,4000,500.0000,0.0000,900.0000,"));
  CHECK_FALSE(std::getline(samples, line));

  rsi::CaptureReader trace(folder / "trace.pcap");
  const auto first = trace.next();
  REQUIRE(first);
  CHECK(first->source == kController);
  CHECK(first->time == 1h);
  const auto second = trace.next();
  REQUIRE(second);
  CHECK(second->source == kServer);
  CHECK(second->destination == kController);
  CHECK(second->time == 1h + 20us);
  CHECK(second->payload == reply);
  const auto third = trace.next();
  REQUIRE(third);
  CHECK(third->payload == "junk");
  CHECK_FALSE(trace.next());
  CHECK(trace.notes().empty());
}

TEST_CASE("a session that does not record leaves no trace") {
  const TemporaryFolder folder;
  Session session(setup(), {folder.path(), false, "live"}, {});
  CHECK(fs::exists(folder / "samples.csv"));
  CHECK_FALSE(fs::exists(folder / "trace.pcap"));
  CHECK(session.snapshot().source_kind == "live");
}

TEST_CASE("what was flushed is in the files while the session goes on") {
  const TemporaryFolder folder;
  Session session(setup(), {folder.path(), true, "trace"}, {});
  for (const auto ipoc : {4000U, 4004U, 4008U, 4012U, 4016U}) {
    const auto text = telegram(ipoc, joint_1_at(0));
    session.telegram(from_controller(text));
  }
  session.flush();
  rsi::CaptureReader trace(folder / "trace.pcap");
  for (int k = 0; k < 5; ++k) CHECK(trace.next().has_value());
  // Four are held back, for one that was overtaken.
  CHECK_THAT(content(folder / "samples.csv"),
             ContainsSubstring(",4000,") && !ContainsSubstring(",4004,"));
}

TEST_CASE("a session without room for its files says so once a file, and goes on") {
  std::vector<std::string> troubles;
  const TemporaryFolder folder;
  fs::create_symlink("/dev/full", folder / "samples.csv");
  Session session(setup(), {folder.path(), false, "live"},
                  {{}, [&](const std::string& text) { troubles.push_back(text); }});
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 60);
  session.flush();
  session.flush();
  session.finish();
  REQUIRE(troubles.size() == 1);
  CHECK_THAT(troubles[0], ContainsSubstring("samples.csv"));
  CHECK(session.snapshot().sweeps.size() == 1);
}

TEST_CASE("a folder that is not there is said at once") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH(Session(setup(), {folder / "missing", true, "trace"}, {}),
                    ContainsSubstring("samples.csv"));
}

TEST_CASE("it is worth identifying once every joint has a stroke") {
  Session session(setup(1), {}, {});
  CHECK_FALSE(session.worth_identifying());
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 2);  // too short for a sweep
  CHECK(session.snapshot().sweeps.size() == 1);
  CHECK_FALSE(session.worth_identifying());
  stroke(session, ipoc, 2, 60);
  CHECK(session.worth_identifying());

  Session six(setup(6), {}, {});
  ipoc = 4000;
  for (int k = 0; k < 6; ++k) stroke(six, ipoc, k % 2 * 60, 60 - k % 2 * 60);
  CHECK(six.snapshot().sweeps.size() == 6);
  CHECK_FALSE(six.worth_identifying());
}

TEST_CASE("a snapshot does not change with what comes after it, and gives the same bytes again") {
  Session session(setup(), {}, {});
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 60);
  const auto snapshot = session.snapshot();
  const auto before = result_json(snapshot.identified());
  stroke(session, ipoc, 60, 0);
  session.finish();
  CHECK(result_json(snapshot.identified()) == before);
  CHECK(result_json(session.snapshot().identified()) != before);
}
