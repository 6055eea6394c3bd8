#include "daemon/stream/session.hpp"

#include <algorithm>

#include "daemon/results/report.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/settings/robot_setup.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/telegrams.hpp"
#include "tests/identify/simulated_campaign.hpp"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using sweepd::PlannedTurns;
using sweepd::Session;
using namespace sweepd::test;
using sweepd::test::kConfig;

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

struct Heard : sweepd::StreamSink {
  void sample(const identify::Sample&, std::string_view row) override { rows.emplace_back(row); }
  void sweep(const identify::Sweep&) override { ++sweeps; }

  std::vector<std::string> rows;
  int sweeps = 0;
};

}  // namespace

TEST_CASE("signals that the settings name and telegrams do not have are told", "[session]") {
  const std::string text =
      "<Rob Type=\"KUKA\"><RIst X=\"1\" Y=\"2\" Z=\"3\"/><AIPos A1=\"1\" "
      "A2=\"2\"/><IPOC>1</IPOC></Rob>";
  sweepd::SignalNames names;
  const auto missing = [&](std::size_t joints) {
    return sweepd::missing_signals(names, joints, text);
  };
  CHECK(missing(2).empty());  // nobody asked for A, B, C
  CHECK(missing(3).starts_with("the telegrams have no AIPos.A3: correct `signals`"));
  names.angles = {"AIPos.A1", "AIPos.A7"};
  CHECK(missing(6).starts_with("the telegrams have no AIPos.A7:"));
  names.angles = {"Joint.A"};
  CHECK(missing(6).starts_with("the telegrams have no Joint.A:"));
  CHECK(sweepd::missing_signals(names, 6, "<Rob>").empty());
}

TEST_CASE("signals that are no numbers are told, with what stood there", "[session]") {
  const auto told = [](std::string text) {
    return sweepd::missing_signals({}, 2, "<Rob Type=\"KUKA\">" + text + "<IPOC>1</IPOC></Rob>");
  };
  CHECK(told(R"(<RIst X="1,5" Y="2,5" Z="3"/><AIPos A1="1" A2="0,25"/>)") ==
        "the first telegram's RIst.X, RIst.Y, AIPos.A2 cannot be read as numbers, as \"1,5\": "
        "numbers have a decimal point, no comma: correct what sends them");
  CHECK(told(R"(<RIst X="" Y="2" Z="3"/><AIPos A1="1" />)") ==
        "the first telegram's RIst.X cannot be read as numbers, as \"\": see what sends them; the "
        "telegrams have no AIPos.A2: correct `signals` in the settings, or SEND in the Ethernet "
        "file");
}

TEST_CASE("without positions it is told what to correct", "[session]") {
  // A stroke of joint 1 by its angles alone, with `pose` in each telegram.
  const auto reason = [](const std::string& pose, const sweepd::SignalNames& names = {}) {
    auto with_names = setup();
    with_names.signals = names;
    std::optional<Session> session;
    sweepd::StreamSink nobody;
    std::uint64_t ipoc = 4000;
    for (const double angle : stroke_deg(0, 60)) {
      auto text = telegram(ipoc, joint_1_at(angle));
      const auto from = text.find("<RIst"), to = text.find("/>", from);
      text.replace(from, to + 2 - from, pose);
      if (!session) session.emplace(with_names, "trace", nobody, text);
      session->telegram(from_controller(text, std::chrono::milliseconds(ipoc)));
      ipoc += 4;
    }
    session->finish();
    const auto found = outcome_of(session->snapshot()).identification;
    CHECK(identify::test::find_warning(found, "no_positions")->message == found.reason);
    return found.reason;
  };
  CHECK(reason("") ==
        "the data carry no positions: on a KUKA controller, add DEF_RIst to the SEND list of the "
        "Ethernet file");
  CHECK(reason(R"(<RIst X="1,5" Y="2,5" Z="3,5"/>)") ==
        "the data carry no positions: the first telegram's RIst.X, RIst.Y, RIst.Z cannot be read "
        "as numbers, as \"1,5\": numbers have a decimal point, no comma: correct what sends them");
  sweepd::SignalNames names;
  names.position = {"RIst.X", "RIst.Y", "RIst.z"};
  CHECK(reason(R"(<RIst X="1" Y="2" Z="3"/>)", names) ==
        "the data carry no positions: the telegrams have no RIst.z: correct `signals` in the "
        "settings, or SEND in the Ethernet file");
}

TEST_CASE("a session recognises sweeps, and identifies from them", "[session]") {
  Heard heard;
  Session session(setup(), "trace", heard);
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 60);
  session.finish();
  CHECK(heard.sweeps == 1);
  const auto outcome = outcome_of(session.snapshot());
  CHECK(outcome.robot == "kr5-arc");
  CHECK(outcome.source_kind == "trace");
  CHECK(outcome.counts.link.telegrams == 400);
  CHECK(outcome.identification.joints.at(0).circle->radius_mm == Approx(500).margin(1e-3));
}

TEST_CASE("what telegrams no longer have is told", "[session]") {
  sweepd::StreamSink nobody;
  Session session(setup(), "trace", nobody, telegram(4000, joint_1_at(0)));
  for (std::uint64_t k = 0; k < 100; ++k) {
    auto text = telegram(4000 + 4 * k, joint_1_at(0));
    if (k >= 60) text.replace(text.find("<AIPos"), 6, "<Other");
    session.telegram(from_controller(text, std::chrono::milliseconds(4000 + 4 * k)));
    if (k == 59) CHECK(session.snapshot().missing_signals.empty());
  }
  CHECK(session.snapshot().missing_signals ==
        "40 of 100 telegrams have no angles of all joints that can be read, and the others have: "
        "see what changes what is sent while the stream goes on");
}

TEST_CASE("what is wrong with a stream leads what is said of its result", "[session]") {
  sweepd::StreamSink nobody;
  Session mixed(setup(), "trace", nobody);
  for (std::uint64_t k = 0; k < 100; ++k)
    for (const std::uint16_t port : {std::uint16_t{49'153}, std::uint16_t{49'154}}) {
      const auto text = telegram(4 * k + 1'000'000ULL * port, joint_1_at(0));
      auto datagram = from_controller(text, std::chrono::milliseconds(4 * k + port % 2));
      datagram.source.port = port;
      mixed.telegram(datagram);
    }
  mixed.finish();
  const auto found = outcome_of(mixed.snapshot()).identification;
  REQUIRE(found.doubts.size() == 1);
  CHECK(found.doubts.front().code == "two_senders");
  CHECK_THAT(found.reason, StartsWith("two senders streamed at once, ") &&
                               ContainsSubstring("no sweep of a single joint was seen"));

  Session cut(setup(), "trace", nobody);
  for (int k = 0; k < 20; ++k)
    cut.telegram(from_controller(telegram(4000, joint_1_at(0)).substr(0, 60)));
  cut.finish();
  const auto nothing = outcome_of(cut.snapshot()).identification;
  CHECK_THAT(nothing.reason, StartsWith("none of 20 datagrams held a whole telegram: "));
  REQUIRE(nothing.doubts.size() == 1);
  CHECK(nothing.doubts.front().code == "malformed");
}

TEST_CASE("each sample is a row of samples.csv, a few of them held back for one that was overtaken",
          "[session]") {
  Heard heard;
  const auto& rows = heard.rows;
  Session session(setup(), "live", heard);
  CHECK_THAT(session.csv_header(), StartsWith("t_s,ipoc,x_mm,"));
  for (const auto ipoc : {4000U, 4004U, 4012U, 4008U, 4016U}) {
    const auto text = telegram(ipoc, joint_1_at(0));
    session.telegram(from_controller(text, std::chrono::milliseconds(ipoc)));
  }
  session.telegram(from_controller("junk"));
  REQUIRE(rows.size() == 1);
  CHECK_THAT(rows[0], StartsWith("0.000,4000,500.0000,0.0000,900.0000,"));
  session.finish();
  REQUIRE(rows.size() == 5);
  CHECK_THAT(rows[2], StartsWith("0.008,4008,"));
  CHECK_THAT(rows[3], StartsWith("0.012,4012,"));
  CHECK(session.snapshot().source_kind == "live");
}

TEST_CASE("it is worth identifying once every joint has a stroke", "[session]") {
  Heard heard;
  Session session(setup(1), "trace", heard);
  CHECK_FALSE(session.worth_identifying());
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 2);  // too short for a sweep
  CHECK(session.snapshot().sweeps.size() == 1);
  CHECK_FALSE(session.worth_identifying());
  stroke(session, ipoc, 2, 60);
  CHECK(session.worth_identifying());

  Session six(setup(6), "trace", heard);
  ipoc = 4000;
  for (int k = 0; k < 6; ++k) stroke(six, ipoc, k % 2 * 60, 60 - k % 2 * 60);
  CHECK(six.snapshot().sweeps.size() == 6);
  CHECK_FALSE(six.worth_identifying());
}

TEST_CASE("of a stream without end sweeps of all of it are used, and how many is said",
          "[session][long]") {
  sweepd::StreamSink nobody;
  Session session(setup(1), "trace", nobody);
  std::uint64_t ipoc = 4000;
  constexpr std::size_t kSweeps = 500;
  for (std::size_t k = 0; k < kSweeps; ++k) {
    stroke(session, ipoc, k % 2 == 0 ? 0 : 60, k % 2 == 0 ? 60 : 0);
    // No matter how many are left out.
    if (k % 50 == 0) CHECK(session.worth_identifying());
  }
  session.finish();
  const auto snapshot = session.snapshot();
  std::size_t samples = 0;
  for (const auto& sweep : snapshot.sweeps) samples += sweep.samples->size();
  CHECK(samples <= Session::kMostSamples);
  CHECK(samples > Session::kMostSamples / 3);
  CHECK(snapshot.sweeps.size() + snapshot.left_out.sweeps == kSweeps);
  CHECK(snapshot.sweeps.back().last().time_s > 0.95 * kSweeps * 1.6);  // seconds of a stroke
  const auto warnings = outcome_of(snapshot).identification.warnings;
  const auto warning = std::find_if(warnings.begin(), warnings.end(),
                                    [](const auto& one) { return one.code == "memory_limit"; });
  REQUIRE(warning != warnings.end());
  CHECK_THAT(warning->message,
             StartsWith(std::to_string(snapshot.sweeps.size()) +
                        " of 500 sweeps are kept, spread over the whole stream; " +
                        std::to_string(snapshot.left_out.sweeps) +
                        " others count in the chain's estimate by their sums"));
}

TEST_CASE("a snapshot does not change with what comes after it, and gives the same bytes again",
          "[session]") {
  Heard heard;
  Session session(setup(), "trace", heard);
  std::uint64_t ipoc = 4000;
  stroke(session, ipoc, 0, 60);
  const auto snapshot = session.snapshot();
  const auto before = result_json(outcome_of(snapshot));
  stroke(session, ipoc, 60, 0);
  session.finish();
  CHECK(result_json(outcome_of(snapshot)) == before);
  CHECK(result_json(outcome_of(session.snapshot())) != before);
}

TEST_CASE("the plan names the joint of a sweep without angles as it happens",
          "[session][issue11][point_20]") {
  const auto setup =
      sweepd::load_setup(kConfig / "robots/kr5_arc.toml", kConfig / "plans/kr5_arc_90deg.toml");
  identify::test::Campaign run(*sweepd::campaign(setup, {}).specified, {.position_mm = 0.002});
  run.rest();
  for (int repeat = 0; repeat < 2; ++repeat)
    for (const auto& sweep : setup.plan->sweeps)
      run.sweep(sweep.joint - 1, sweep.start_deg, sweep.end_deg);
  auto strokes = identify::test::segment(run.samples());
  REQUIRE(strokes.size() > 24);

  PlannedTurns turns(sweepd::campaign(setup, {}).order);
  for (auto& stroke : strokes) {
    const auto joint = stroke.joint;
    stroke.joint.reset();
    CHECK(turns.joint_of(stroke) == joint);
  }
  CHECK(sweepd::sweep_line(strokes.back(), 5).starts_with("joint 6 by the plan: sweep of "));

  strokes.front().defect = identify::SweepDefect::not_an_arc;
  CHECK_FALSE(turns.joint_of(strokes.front()));
  CHECK_FALSE(PlannedTurns().joint_of(strokes.back()));
}

TEST_CASE("of a robot with more joints than signals name, it is told which to name", "[session]") {
  const auto told = [](const std::string& text, const sweepd::SignalNames& names = {}) {
    return sweepd::missing_signals(names, 7, "<Rob Type=\"KUKA\">" + text + "<IPOC>1</IPOC></Rob>");
  };
  const std::string pose = R"(<RIst X="1" Y="2" Z="3" A="1" B="2" C="3"/>)";
  const std::string six = pose + R"(<AIPos A1="1" A2="2" A3="3" A4="4" A5="5" A6="6"/>)";
  const std::string external = R"(<EIPos E1="1" E2="0" E3="0" E4="0" E5="0" E6="0"/>)";
  const std::string said =
      "the robot has 7 joints, and `signals` names angles of 6: name all with `angles` of "
      "[robot.signals], or the others are not seen";
  CHECK(told(six) == said);
  CHECK(told(six + external) == said + "; the telegrams have EIPos.E1, which may be the next one");
  sweepd::SignalNames names;
  names.angles.emplace_back("EIPos.E1");
  CHECK(told(six + external, names).empty());
  CHECK(told(pose).empty());  // joints are known by their axes
}
