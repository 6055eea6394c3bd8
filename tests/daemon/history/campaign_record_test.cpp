#include "daemon/history/campaign_record.hpp"

#include <cmath>

#include "daemon/text/utc.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/history/whole_result.hpp"

using namespace std::chrono_literals;
using Catch::Matchers::ContainsSubstring;
using sweepd::campaign_record;
using sweepd::CampaignRecord;
using sweepd::CampaignTexts;
using sweepd::parse_utc;
using sweepd::test::whole_result;

namespace {

CampaignTexts texts_named(const std::string& name) {
  CampaignTexts texts;
  texts.name = name;
  texts.written = 1000s;
  return texts;
}

}  // namespace

TEST_CASE("a campaign's time is that of the best that tells it", "[campaign_record]") {
  CampaignTexts texts = texts_named("out/first");
  const auto time_is = [&](const char* date, const char* from) {
    const CampaignRecord record = campaign_record(texts);
    CHECK(record.time == parse_utc(date));
    CHECK(record.time_from == from);
  };
  time_is("1970-01-01T00:16:40", "age");
  texts.name = "out/2024-03-01 after service";
  time_is("2024-03-01", "name");
  texts.name = "out/20240301T103005Z-2";
  time_is("2024-03-01T10:30:05", "name");
  texts.link = R"({"schema":"sweepd.link/1","start":"2024-03-02T10:00:00.000Z"})";
  time_is("2024-03-02T10:00", "link.json");
  texts.run = R"({"started":"2024-03-03T10:00:00.000Z"})";
  time_is("2024-03-03T10:00", "run.json");
  texts.notes = R"({"time":"2024-03-04","measured":true})";
  time_is("2024-03-04", "note");
}

TEST_CASE("what is missing or broken is told and never an error", "[campaign_record]") {
  CampaignTexts texts = texts_named("out/a");
  CHECK_THAT(campaign_record(texts).why_not, ContainsSubstring("out/a has no result.json"));
  texts.result = R"({"schema":"sweepd.result/1","dh":[{)";
  CHECK_THAT(campaign_record(texts).why_not, ContainsSubstring("holds no result of sweepd"));
  texts.result = R"({"schema":"sweepd.result/1","status":"failed","reason":"nothing moved"})";
  texts.run = texts.link = texts.notes = "nonsense";
  const CampaignRecord record = campaign_record(texts);
  CHECK_FALSE(record.arm);
  CHECK_THAT(record.why_not, ContainsSubstring("nothing moved"));
  CHECK(record.broken_notes == std::vector<std::size_t>{1});
  CHECK_FALSE(record.link);
}

TEST_CASE("a result that was edited or damaged is named, and not compared", "[campaign_record]") {
  CampaignTexts texts = texts_named("out/a");
  const auto why = [&](const auto& edit) {
    auto json = whole_result();
    edit(json);
    texts.result = json.dump();
    return campaign_record(texts).why_not;
  };
  CHECK(why([](auto&) {}).empty());
  CHECK_THAT(why([](auto& json) { json["dh"][1]["a_mm"] = "599,742025"; }),
             ContainsSubstring("out/a/result.json has \"599,742025\" for a_mm of row 2"));
  CHECK_THAT(why([](auto& json) { json["dh"][1]["a_mm"] = 1e200; }),
             ContainsSubstring("for a_mm of row 2"));
  for (const double variance : {1e308, -0.5})
    CHECK_THAT(why([&](auto& json) { json["covariance"]["rows"][0][0] = variance; }),
               ContainsSubstring("has a covariance that no numbers can have"));
  texts.problem = "Permission denied";
  CHECK_THAT(campaign_record(texts).why_not,
             ContainsSubstring("out/a/result.json cannot be read (Permission denied)"));
}

TEST_CASE("friction is that of the result, else half of what currents differ by",
          "[campaign_record]") {
  CampaignTexts texts = texts_named("out/a");
  texts.result = R"({"schema":"sweepd.result/1","status":"failed"})";
  texts.currents =
      "joint,angle_deg,rising_a,falling_a,rising_samples,falling_samples\n"
      "3,0.5,2.0,-1.0,5,5\n3,1.5,1.8,-0.8,5,5\n3,2.5,,1,0,1\n";
  auto friction = campaign_record(texts).friction;
  REQUIRE(friction.size() == 1);
  CHECK(friction[0].joint == 2);
  CHECK(friction[0].friction_a == Approx(1.4));
  CHECK(friction[0].scatter_a == Approx(0.1));
  texts.result = R"({"schema":"sweepd.result/1","currents":[{"joint":1,"friction_a":0.7}]})";
  friction = campaign_record(texts).friction;
  REQUIRE(friction.size() == 1);
  CHECK(friction[0].friction_a == 0.7);
}

TEST_CASE("a packed record is the same record", "[campaign_record][long]") {
  CampaignTexts texts = texts_named("out/2024-03-01");
  texts.result = sweepd::test::whole_result().dump();
  texts.link =
      R"({"schema":"sweepd.link/1","verdict":"good","telegrams":{"received":10,"lost":1}})";
  texts.currents = "joint\n1,0.5,2,-2\n";
  texts.notes = "{\"time\":\"2024-03-04\",\"text\":\"note\",\"same_state\":\"new\"}\nnonsense\n";
  const CampaignRecord record = campaign_record(texts);
  REQUIRE(record.arm);
  const auto bytes = packed(record);
  const CampaignRecord again = sweepd::unpacked(bytes.data(), bytes.size());
  CHECK(packed(again) == bytes);
  CHECK(again.same_state() == "new");
  CHECK(again.link->received == 10);
  CHECK(std::isnan(again.link->late_replies));
  CHECK(again.arm->arm.covariance == record.arm->arm.covariance);
  CHECK(again.arm->arm.dh[3].alpha_rad.value == record.arm->arm.dh[3].alpha_rad.value);
  CHECK(again.arm->reach.tool_mm == record.arm->reach.tool_mm);
  CHECK_THROWS(sweepd::unpacked(bytes.data(), bytes.size() / 2));
}
