#include "daemon/plant/campaign_store.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/record/session_folder.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/file_hash.hpp"
#include "daemon/text/utc.hpp"
#include "identify/dh/dh_extraction.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using Names = std::map<std::string, std::string>;
using Column = std::vector<std::optional<std::string>>;

std::optional<std::string> number_or_null(double value) {
  if (!std::isfinite(value)) return std::nullopt;
  return number_text(value);
}

std::string name_in(const Names& names, const std::string& key) {
  const auto found = names.find(key);
  return found == names.end() ? std::string() : found->second;
}

/// The folder's name: the key of a campaign.
std::string session_in(const Names& names) {
  std::string session = name_in(names, "session");
  if (!session_name(session))
    throw std::invalid_argument("its user property `session` is no name of a session's folder");
  return session;
}

/// Null for what is no time: PostgreSQL would take "yesterday" for one.
SqlValue started_in(const Names& names) {
  const auto started = parse_utc(name_in(names, "started"));
  return started ? SqlValue(utc_text(*started)) : SqlValue(std::nullopt);
}

/// Of the bytes themselves: what was told of them is no proof.
std::string checked_hash(std::string_view bytes, const Names& names) {
  const std::string told = name_in(names, "sha256");
  std::string is = sha256_of(bytes);
  if (!told.empty() && told != is)
    throw std::invalid_argument("its SHA-256 is not the one that was told with it");
  return is;
}

/// The numbers of the table, as columns of their own.
struct Numbers {
  Column name, joint, value, sigma;
};

Numbers numbers_in(const Json& result) {
  Numbers numbers;
  std::size_t joint = 0;
  for (const Json& row : list_of(result, "dh")) {
    const std::string number = std::to_string(++joint);
    for (const auto& of : identify::kDhNumbers) {
      const auto value = number_or_null(number_of(row, fmt::format("{}_{}", of.name, of.unit())));
      if (!value) continue;
      numbers.name.emplace_back(fmt::format("{}{}_{}", of.name, number, of.unit()));
      numbers.joint.emplace_back(number);
      numbers.value.push_back(value);
      numbers.sigma.push_back(
          number_or_null(number_of(row, fmt::format("{}_sigma_{}", of.name, of.unit()))));
    }
  }
  return numbers;
}

/// A list of lists; nothing where there is no covariance.
std::optional<std::string> covariance_in(const Json& covariance) {
  std::string lists;
  for (const Json& row : list_of(covariance, "rows")) {
    Column column;
    for (const Json& value : row)
      column.push_back(number_or_null(value.is_number() ? value.get<double>() : kNothing));
    lists += (lists.empty() ? "" : ",") + sql_list(column);
  }
  if (lists.empty()) return std::nullopt;
  return '{' + lists + '}';
}

std::optional<std::string> names_in(const Json& covariance) {
  Column names;
  for (const Json& name : list_of(covariance, "names"))
    names.emplace_back(name.is_string() ? name.get<std::string>() : "");
  if (names.empty()) return std::nullopt;
  return sql_list(names);
}

std::string list_text(const LinkCounters& counters) {
  Column column;
  for (const auto count : counters.counts) column.emplace_back(std::to_string(count));
  return sql_list(column);
}

}  // namespace

CampaignStore::CampaignStore(Database& database) : database_(database) {
  migrate(database_);
}

std::string CampaignStore::robot(const RobotPlace& place) {
  const std::vector<SqlValue> key{place.site, place.cell, place.robot};
  const std::string look = "select id from robots where site = $1 and cell = $2 and name = $3";
  auto rows = database_.run(look, key);
  if (rows.empty()) {
    database_.run(
        "insert into robots (site, cell, name) values ($1, $2, $3) on conflict do nothing", key);
    rows = database_.run(look, key);
  }
  return rows.at(0).at(0);
}

bool CampaignStore::add_result(const RobotPlace& place, std::string_view bytes,
                               const Names& names) {
  const Json result = Json::parse(bytes, nullptr, false);
  if (!text_of(result, "schema").starts_with("sweepd.result/"))
    throw std::invalid_argument("it is no result of sweepd");
  const std::string hash = checked_hash(bytes, names);
  const std::string session = session_in(names);
  const Json& covariance = part_of(result, "covariance");
  bool is_new = false;
  database_.at_once([&] {
    const auto added = database_.run(
        "insert into campaigns (robot, session, sha256, started, status, describes, result, "
        "covariance_names, covariance) values ($1, $2, $3, $4, $5, $6, $7, $8, $9) "
        "on conflict (robot, session, sha256) do nothing returning id",
        {robot(place), session, hash, started_in(names), text_of(result, "status"),
         text_of(result, "describes"), SqlValue::of_bytes(bytes), names_in(covariance),
         covariance_in(covariance)});
    is_new = !added.empty();
    if (!is_new) return;
    const Numbers numbers = numbers_in(result);
    database_.run(
        "insert into numbers (campaign, name, joint, value, sigma) select $1::bigint, * from "
        "unnest($2::text[], $3::integer[], $4::double precision[], $5::double precision[])",
        {added.at(0).at(0), sql_list(numbers.name), sql_list(numbers.joint),
         sql_list(numbers.value), sql_list(numbers.sigma)});
  });
  return is_new;
}

void CampaignStore::add_change(const RobotPlace& place, std::string_view bytes,
                               const Names& names) {
  const Json change = Json::parse(bytes, nullptr, false);
  if (!text_of(change, "schema").starts_with("sweepd.compare/"))
    throw std::invalid_argument("it is no comparison of sweepd");
  const std::string session = session_in(names);
  database_.at_once([&] {
    database_.run(
        "insert into changes (robot, session, sha256, since, verdict, t_squared, p, comparison) "
        "values ($1, $2, $3, $4, $5, $6, $7, $8) on conflict do nothing",
        {robot(place), session, name_in(names, "sha256"), name_in(names, "since"),
         text_of(change, "verdict"), number_or_null(number_of(change, "t_squared")),
         number_or_null(number_of(change, "p")), SqlValue::of_bytes(bytes)});
  });
}

void CampaignStore::add_links(const std::map<std::string, std::pair<RobotPlace, ToldLink>>& links) {
  std::string columns, sums;
  for (std::size_t i = 0; i < kLinkColumns.size(); ++i) {
    columns += fmt::format("{}, ", kLinkColumns[i]);
    sums += fmt::format("{0} = link_days.{0} + excluded.{0}, ", kLinkColumns[i]);
  }
  // A stream tells the longest of all its days: one that an earlier day had is not this day's.
  const std::string add =
      "insert into link_days (robot, day, " + columns +
      "max_latency_us) values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, case when not exists "
      "(select from link_days where robot = $1 and day >= $12 and day < $2 and max_latency_us >= "
      "$11) then $11::double precision end) on conflict (robot, day) do update set " +
      sums + "max_latency_us = greatest(link_days.max_latency_us, excluded.max_latency_us)";
  database_.at_once([&] {
    for (const auto& [topic, link] : links) {
      const auto& [place, told] = link;
      const std::string id = robot(place);
      std::optional<LinkCounters> before;
      const auto rows = database_.run(
          "select started, array_to_string(counters, ' ') from link_counters where robot = $1 for "
          "update",
          {id});
      if (!rows.empty()) {
        before.emplace().started = rows.at(0).at(0);
        std::size_t at = 0;
        for (auto& count : before->counts) {
          std::size_t length = 0;
          count = std::stoll(rows[0][1].substr(at), &length);
          at += length;
        }
      }
      const auto counted = counted_since(before, told);
      if (!counted) continue;
      std::vector<SqlValue> values{id, told.day};
      for (const auto count : counted->counts) values.emplace_back(std::to_string(count));
      values.emplace_back(number_or_null(told.max_latency_us.value_or(NAN)));
      values.emplace_back(told.max_latency_us ? std::optional(told.stream_since) : std::nullopt);
      database_.run(add, values);
      database_.run(
          "insert into link_counters (robot, started, counters) values ($1, $2, $3) on conflict "
          "(robot) do update set started = excluded.started, counters = excluded.counters",
          {id, told.counters.started, list_text(told.counters)});
    }
  });
}

void CampaignStore::add_refused(const std::string& topic, std::string_view bytes,
                                const std::string& why) {
  database_.run(
      "insert into refused (topic, reason, payload) select $1::text, $2::text, $3::bytea where not "
      "exists (select from refused where topic = $1 and payload = $3)",
      {topic, why, SqlValue::of_bytes(bytes)});
}

std::vector<StoredCampaign> stored_campaigns(Database& database, const RobotPlace& place,
                                             const std::string& session) {
  const auto rows = database.run(
      "select distinct on (session) session, result from campaigns join robots on robots.id = "
      "campaigns.robot where site = $1 and cell = $2 and name = $3 and ($4 = '' or session = $4) "
      "order by session, campaigns.id desc",
      {place.site, place.cell, place.robot, session});
  std::vector<StoredCampaign> campaigns;
  campaigns.reserve(rows.size());
  for (const SqlRow& row : rows) campaigns.push_back({row.at(0), bytes_of_text(row.at(1))});
  return campaigns;
}

}  // namespace sweepd
