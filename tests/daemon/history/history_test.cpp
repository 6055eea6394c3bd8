#include "daemon/history/history.hpp"

#include <algorithm>
#include <cmath>

#include "daemon/history/history_words.hpp"
#include "daemon/results/change.hpp"
#include "daemon/text/units.hpp"
#include "daemon/text/utc.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/history/drawn_campaigns.hpp"
#include "tests/daemon/history/whole_result.hpp"

using Catch::Matchers::ContainsSubstring;
using sweepd::CampaignRecord;
using sweepd::ChangeKind;
using sweepd::FoundCampaigns;
using sweepd::History;
using sweepd::history_of;
using sweepd::test::DrawnCampaigns;

namespace {

std::chrono::nanoseconds month(int campaign) {
  return *sweepd::parse_utc("2020-01-01") + std::chrono::hours(730 * campaign);
}

const DrawnCampaigns& drawn() {
  static const DrawnCampaigns once(sweepd::test::whole_result().dump());
  return once;
}

/// One a month; zero 4 is off by `jump_deg` from `crash` on. The first `marked` are marked. Summers
/// are warmer than winters by twice `season_K`: lengths grow.
std::vector<CampaignRecord> campaigns(int count, int marked, int crash = 1000, double jump_deg = 0,
                                      double season_K = 0, std::uint32_t seed = 11) {
  std::mt19937 random(seed);
  std::vector<CampaignRecord> all;
  for (int i = 0; i < count; ++i) {
    auto rows = drawn().rows();
    for (auto& row : rows) {
      const double grown = 1 + 11.5e-6 * season_K * std::sin(2 * sweepd::kPi * i / 12);
      row.a_mm *= grown;
      row.b_mm *= grown;
    }
    if (i >= crash)
      rows[3].theta_rad += drawn().record().arm->arm.positive[3] * sweepd::radians(jump_deg);
    all.push_back(drawn().draw(rows, random));
    all.back().name = "campaign" + std::to_string(i);
    all.back().time = month(i);
    all.back().time_from = "run.json";
    if (i < marked) all.back().notes.push_back({month(i), "", std::string("new"), false});
  }
  return all;
}

double sigma_of_zero4() {
  return sweepd::degrees(std::sqrt(drawn().record().arm->arm.covariance(16, 16)));
}

}  // namespace

TEST_CASE("a crash is dated and named, with the note of it", "[history][long]") {
  FoundCampaigns found{campaigns(30, 10, 20, 20 * sigma_of_zero4()), {}, {}};
  found.notes.push_back({month(20) - std::chrono::hours(100), "collision, A4", {}, false});
  const History history = history_of(std::move(found), {});
  REQUIRE(history.changes.size() == 1);
  CHECK(history.changes[0].kind == ChangeKind::jump);
  CHECK(history.changes[0].at == 20);
  CHECK(sweepd::name_of(history.numbers[history.changes[0].number]) == "zero4");
  CHECK(history.basis == sweepd::Basis::marked);
  CHECK(history.basis_campaigns == 10);
  CHECK(history.reference_state.size() == 10);
  for (std::size_t i = 20; i < 30; ++i) CHECK(history.campaigns[i].changed);
  const std::string text = history_text(history);
  CHECK_THAT(text, ContainsSubstring("* zero4 jumped by +") &&
                       ContainsSubstring("note of 2021-08-27: collision, A4") &&
                       ContainsSubstring("from 10 campaigns that are marked"));
  const std::string page = history_page(history);
  CHECK_THAT(page, ContainsSubstring("collision, A4") && ContainsSubstring("<svg"));
  CHECK(page == history_page(history));
}

TEST_CASE("copies of a result are one campaign, and named", "[history]") {
  FoundCampaigns found{campaigns(2, 0), {}, {}};
  for (int i = 2; i < 7; ++i) {  // they "repeat" perfectly
    found.records.push_back(found.records.front());
    found.records.back().name = "copy" + std::to_string(i);
    found.records.back().time = month(i);
    found.records.back().notes.push_back({month(i), "", std::string("new"), false});
  }
  sweepd::HistoryOptions options;
  const History history = history_of(found, options);
  REQUIRE(history.campaigns.size() == 2);
  CHECK(history.campaigns[0].record.name == "campaign0");
  CHECK(history.campaigns[0].state == "new");
  CHECK_FALSE(history.campaigns[1].changed);
  CHECK(history.basis == sweepd::Basis::nothing);
  CHECK_THAT(history_text(history),
             ContainsSubstring("copy2 and campaign0 are the same result: it counts once"));

  options.reference = "copy3";
  const History of_copy = history_of(found, options);
  CHECK(of_copy.campaigns.size() == 2);
  CHECK(of_copy.campaigns[of_copy.reference].record.name == "copy3");
}

TEST_CASE("the table has a line a campaign, and a bar for each number", "[history][long]") {
  FoundCampaigns found{campaigns(8, 8), {}, {}};
  found.records[3].name = "a,\"b";
  found.records[5].friction = {{2, 0.7, 0.1, 20}};
  const History history = history_of(std::move(found), {});
  const std::string csv = history_csv(history);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 9);
  CHECK_THAT(csv, ContainsSubstring("time,campaign,status,state,t_squared,") &&
                      ContainsSubstring("zero4_deg,zero4_low_deg,zero4_high_deg") &&
                      ContainsSubstring(",friction3_a,") && ContainsSubstring("\"a,\"\"b\"") &&
                      ContainsSubstring(",0.7000,"));
}

TEST_CASE("without marks it is said what is assumed", "[history][long]") {
  const History many = history_of({campaigns(8, 0), {}, {}}, {});
  CHECK(many.basis == sweepd::Basis::successive);
  CHECK(many.changes.empty());
  CHECK_THAT(history_text(many), ContainsSubstring("No change is seen that can be dated.") &&
                                     ContainsSubstring("none are marked as the same"));
  const History few = history_of({campaigns(3, 0), {}, {}}, {});
  CHECK(few.basis == sweepd::Basis::nothing);
  CHECK_FALSE(few.campaigns[0].tested);  // the reference, alone
  CHECK_THAT(sweepd::repeatability_words(few), ContainsSubstring("alarms may be false"));
  const History one = history_of({campaigns(1, 0), {}, {}}, {});
  CHECK_THAT(history_text(one), ContainsSubstring("too few campaigns"));
  CHECK_THAT(sweepd::alarms_words(few), ContainsSubstring(" campaigns called changed; 5 % of "
                                                          "unchanged ones would be."));
}

TEST_CASE("marks of one season do not make an alarm of the others", "[history][long]") {
  int histories = 0, dated = 0;
  for (const int marked : {0, 3, 6})
    for (std::uint32_t seed = 1; seed <= 8; ++seed, ++histories) {
      CAPTURE(marked, seed);
      const History history = history_of({campaigns(60, marked, 1000, 0, 20, seed), {}, {}}, {});
      CHECK(history.basis == (marked > 0 ? sweepd::Basis::marked_and_years : sweepd::Basis::years));
      std::size_t alarms = 0;
      for (const auto& campaign : history.campaigns) alarms += campaign.changed;
      CHECK(alarms <= 5);
      dated += !history.changes.empty();
      CHECK_THAT(sweepd::repeatability_words(history), ContainsSubstring("from all years without"));
    }
  // So few years tell little of how years scatter: of 240 histories 8 % had a change that was none.
  CHECK(6 * dated <= histories);
  // A year in which the arm jumped tells nothing of how campaigns repeat.
  const History crashed = history_of({campaigns(60, 3, 30, 40 * sigma_of_zero4(), 20), {}, {}}, {});
  REQUIRE(crashed.changes.size() == 1);
  CHECK(crashed.changes[0].at == 30);
  for (std::size_t i = 30; i < 60; ++i) CHECK(crashed.campaigns[i].changed);
}

TEST_CASE("a jump that is dated stays so as the years go by", "[history][long]") {
  for (const int count : {9, 12, 18, 30}) {
    int dated = 0;
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      const History history =
          history_of({campaigns(count, 0, 6, 7 * sigma_of_zero4(), 0, seed), {}, {}}, {});
      dated += history.changes.size() == 1 && history.changes[0].at == 6;
    }
    INFO(count << " campaigns, dated in " << dated << " of 10 histories");
    CHECK(dated >= 9);
  }
}

TEST_CASE("what changed in the last campaign but one does not hide itself", "[history][long]") {
  // Ten months are a year that tells how campaigns repeat, and the change is in it.
  constexpr int kCampaigns = 10, kHistories = 10;
  int told = 0;
  for (std::uint32_t seed = 1; seed <= kHistories; ++seed) {
    const auto all = campaigns(kCampaigns, 4, kCampaigns - 2, 8 * sigma_of_zero4(), 0, seed);
    const History history = history_of({all, {}, {}}, {});
    if (history.campaigns[kCampaigns - 1].changed) ++told;
  }
  CHECK(told >= kHistories - 1);
}

TEST_CASE("a period of one state is as good as marks", "[history][long]") {
  sweepd::HistoryOptions options;
  options.same_state = std::pair(month(0), month(9));
  const History history = history_of({campaigns(20, 0), {}, {}}, options);
  CHECK(history.basis == sweepd::Basis::marked);
  CHECK(history.basis_campaigns == 10);
}

TEST_CASE("a model and an arm are never mixed", "[history][long]") {
  auto records = campaigns(6, 0);
  records[2].arm->describes = records[4].arm->describes = "controller_model";
  const History arm = history_of({records, {}, {}}, {});
  CHECK(arm.campaigns.size() == 4);
  CHECK(arm.left_out.size() == 2);
  CHECK_THAT(history_text(arm), ContainsSubstring("campaign2 is of the controller's model"));
  sweepd::HistoryOptions options;
  options.describes = "controller_model";
  CHECK(history_of({records, {}, {}}, options).campaigns.size() == 2);
}

TEST_CASE("what cannot be compared is named", "[history][long]") {
  auto records = campaigns(5, 0);
  records[1].arm.reset();
  records[1].why_not = "campaign1 has no result.json";
  records[3].arm->all_joints = 7;
  const History history = history_of({records, {}, {}}, {});
  CHECK(history.campaigns.size() == 3);
  CHECK_THAT(history_text(history), ContainsSubstring("campaign1 has no result.json") &&
                                        ContainsSubstring("campaign3 is of a robot with other"));
  sweepd::HistoryOptions options;
  options.reference = "elsewhere";
  CHECK_THROWS_WITH(history_of({records, {}, {}}, options),
                    ContainsSubstring("none of the campaigns"));
  CHECK_THROWS_WITH(history_of({{records[1]}, {}, {}}, {}), ContainsSubstring("no result.json"));
  CHECK_THROWS_WITH(history_of({}, {}), ContainsSubstring("there are no results"));
}

TEST_CASE("a campaign of a clock that was not set is left out, with its date", "[history][long]") {
  for (const char* date : {"1970-01-01", "2099-01-01"}) {
    auto records = campaigns(5, 0);
    records[2].time = *sweepd::parse_utc(date);
    const History history = history_of({records, {}, {}}, {});
    CHECK(history.campaigns.size() == 4);
    REQUIRE(history.left_out.size() == 1);
    CHECK_THAT(history.left_out.front().why_not,
               ContainsSubstring("campaign2 is dated " + std::string(date)) &&
                   ContainsSubstring("sweepd note campaign2 --measured DATE"));
  }
}

TEST_CASE("a campaign that leaves the last axis open tells the numbers before it",
          "[history][long]") {
  auto records = campaigns(8, 6);
  records[7].arm->cut(5);
  const History history = history_of({records, {}, {}}, {});
  REQUIRE(history.campaigns.size() == 8);
  CHECK(history.campaigns[7].told < history.numbers.size());
  CHECK(history.campaigns[7].told > 5);
  CHECK(history.campaigns[7].tested);
}

TEST_CASE("campaigns before a date only tell what is compared with", "[history][long]") {
  sweepd::HistoryOptions options;
  options.since = month(12);
  const History history = history_of({campaigns(20, 6), {}, {}}, options);
  CHECK(history.campaigns.size() == 6 + 8);
  CHECK(history.changes.empty());
  options.since = month(1200);
  CHECK_THROWS_WITH(history_of({campaigns(20, 6), {}, {}}, options),
                    Catch::Matchers::StartsWith("no campaign is from --since ") &&
                        Catch::Matchers::ContainsSubstring(" on: the newest is of "));
}

TEST_CASE("a crash after the first campaign since a date is a jump", "[history][long]") {
  sweepd::HistoryOptions options;
  options.since = month(12);
  const History history =
      history_of({campaigns(18, 6, 13, 20 * sigma_of_zero4()), {}, {}}, options);
  REQUIRE(history.changes.size() == 1);
  CHECK(history.changes[0].kind == ChangeKind::jump);
  CHECK(history.campaigns[history.changes[0].at].record.name == "campaign13");
}

TEST_CASE("friction that rises is told as a drift of its joint", "[history][long]") {
  auto records = campaigns(40, 10);
  std::mt19937 random(3);
  std::normal_distribution<> normal;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const double worn = i > 15 ? 0.02 * static_cast<double>(i - 15) : 0;
    records[i].friction = {{0, 1 + 0.02 * normal(random), 0, 20},
                           {2, 1 + worn + 0.02 * normal(random), 0, 20}};
  }
  const History history = history_of({records, {}, {}}, {});
  REQUIRE(history.friction_changes.size() == 1);
  CHECK(history.friction_changes[0].kind == ChangeKind::drift);
  CHECK_THAT(history_text(history), ContainsSubstring("friction of joint 3 drifts by +0.2"));
}
