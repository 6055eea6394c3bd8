#include <array>
#include <string>

#include "daemon/plant/database.hpp"

namespace sweepd {
namespace {

/// One after the other, for ever: what was released is never changed, a change is a new one at the
/// end. A statement each.
constexpr auto kMigrations = std::to_array<std::array<const char*, 7>>({
    {R"(create table robots (
          id bigint generated always as identity primary key,
          site text not null,
          cell text not null,
          name text not null,
          first_seen timestamptz not null default now(),
          unique (site, cell, name)))",
     R"(create table campaigns (
          id bigint generated always as identity primary key,
          robot bigint not null references robots,
          session text not null,
          sha256 text not null,
          started timestamptz,
          received timestamptz not null default now(),
          status text not null,
          describes text not null,
          result bytea not null,
          covariance_names text[],
          covariance double precision[],
          unique (robot, session, sha256)))",
     R"(create table numbers (
          campaign bigint not null references campaigns on delete cascade,
          name text not null,
          joint integer not null,
          value double precision not null,
          sigma double precision,
          primary key (campaign, name)))",
     R"(create table changes (
          robot bigint not null references robots,
          session text not null,
          sha256 text not null,
          since text not null,
          received timestamptz not null default now(),
          verdict text not null,
          t_squared double precision,
          p double precision,
          comparison bytea not null,
          primary key (robot, session, sha256)))",
     R"(create table link_days (
          robot bigint not null references robots,
          day date not null,
          received bigint not null default 0,
          lost bigint not null default 0,
          duplicated bigint not null default 0,
          reordered bigint not null default 0,
          malformed bigint not null default 0,
          late bigint not null default 0,
          unanswered bigint not null default 0,
          superseded bigint not null default 0,
          max_latency_us double precision not null default 0,
          primary key (robot, day)))",
     R"(create table link_counters (
          robot bigint primary key references robots,
          started text not null,
          counters bigint[] not null))",
     R"(create table refused (
          id bigint generated always as identity primary key,
          received timestamptz not null default now(),
          topic text not null,
          reason text not null,
          payload bytea not null))"},
    // A day without a reply has none.
    {"alter table link_days alter column max_latency_us drop default",
     "alter table link_days alter column max_latency_us drop not null",
     "update link_days set max_latency_us = null where max_latency_us = 0"},
});

/// A table of another program that has one of the names here; empty where there is none.
std::string table_of_others(Database& database) {
  const auto columns = database
                           .run(
                               "select string_agg(attname, ',' order by attnum) from pg_attribute "
                               "where attrelid = to_regclass('migrations') and attnum > 0 and not "
                               "attisdropped")
                           .at(0)
                           .at(0);
  if (columns == "number,applied") return {};
  if (!columns.empty()) return "migrations";
  for (const char* const name :
       {"robots", "campaigns", "numbers", "changes", "link_days", "link_counters", "refused"})
    if (!database.run("select to_regclass($1)", {name}).at(0).at(0).empty()) return name;
  return {};
}

}  // namespace

void migrate(Database& database) {
  database.at_once([&] {
    // Whoever comes second waits until the first is done.
    database.run("select pg_advisory_xact_lock(5005901)");
    if (const auto other = table_of_others(database); !other.empty())
      throw DatabaseError("the table " + other +
                              " in the database is another program's: give sweepd a database of "
                              "its own, with `database`",
                          false);
    database.run(
        "create table if not exists migrations (number integer primary key, applied timestamptz "
        "not null default now())");
    const auto newest =
        std::stoul(database.run("select coalesce(max(number), 0) from migrations").at(0).at(0));
    if (newest > kMigrations.size())
      // Not by data: what comes meanwhile must not be acknowledged.
      throw DatabaseError("the tables are those of a newer sweepd (number " +
                              std::to_string(newest) + ", this one knows " +
                              std::to_string(kMigrations.size()) + "): update this sweepd",
                          false);
    for (std::size_t i = newest; i < kMigrations.size(); ++i) {
      for (const char* const statement : kMigrations[i])
        if (statement != nullptr) database.run(statement);
      database.run("insert into migrations (number) values ($1)", {std::to_string(i + 1)});
    }
  });
}

}  // namespace sweepd
