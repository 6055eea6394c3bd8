#include "daemon/plant/database.hpp"

#include <array>
#include <utility>

#include <libpq-fe.h>

namespace sweepd {
namespace {

using Result = std::unique_ptr<PGresult, void (*)(PGresult*)>;

/// PostgreSQL's own words, in one line.
std::string words(const char* message) {
  std::string text = message == nullptr ? "" : message;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  return text;
}

}  // namespace

SqlValue SqlValue::of_bytes(std::string_view bytes) {
  SqlValue value{std::string(bytes)};
  value.bytes = true;
  return value;
}

Database::Database(std::string connection)
    : connection_(std::move(connection)), server_(nullptr, PQfinish) {}

Database::~Database() = default;

void Database::connect() {
  if (server_ && PQstatus(server_.get()) == CONNECTION_OK) return;
  // A machine that has lost its power does not say so: without these a query waits for it for
  // hours. What stands in the connection string goes first.
  constexpr std::array<const char*, 7> kKeys{"connect_timeout",
                                             "keepalives_idle",
                                             "keepalives_interval",
                                             "keepalives_count",
                                             "tcp_user_timeout",
                                             "dbname",
                                             nullptr};
  const std::array<const char*, 7> values{"10",   "30", "10", "3", "60000", connection_.c_str(),
                                          nullptr};
  server_.reset(PQconnectdbParams(kKeys.data(), values.data(), 1));
  if (PQstatus(server_.get()) == CONNECTION_OK) {
    // Notices of what is there already are of no use here.
    PQsetNoticeProcessor(
        server_.get(), [](void*, const char*) {}, nullptr);
    return;
  }
  const std::string why = words(PQerrorMessage(server_.get()));
  server_.reset();
  throw DatabaseError(
      "PostgreSQL cannot be reached (" + why + "): check `database`, and that it runs", false);
}

std::vector<SqlRow> Database::run(const std::string& sql, const std::vector<SqlValue>& values) {
  connect();
  std::vector<const char*> data;
  std::vector<int> sizes, formats;
  for (const SqlValue& value : values) {
    // libpq would end it there: "a\0b" would be the "a" of somebody else.
    if (!value.bytes && value.text && value.text->find('\0') != std::string::npos)
      throw DatabaseError("PostgreSQL takes no text with a zero byte in it", true);
    data.push_back(value.text ? value.text->c_str() : nullptr);
    sizes.push_back(value.text ? static_cast<int>(value.text->size()) : 0);
    formats.push_back(value.bytes ? 1 : 0);
  }
  const Result result(PQexecParams(server_.get(), sql.c_str(), static_cast<int>(values.size()),
                                   nullptr, data.data(), sizes.data(), formats.data(), 0),
                      PQclear);
  const auto status = PQresultStatus(result.get());
  if (status != PGRES_COMMAND_OK && status != PGRES_TUPLES_OK) {
    const char* const code = PQresultErrorField(result.get(), PG_DIAG_SQLSTATE);
    const std::string state = code == nullptr ? "" : code;
    const bool gone = PQstatus(server_.get()) != CONNECTION_OK;
    const std::string why = words(PQerrorMessage(server_.get()));
    if (gone) server_.reset();
    throw DatabaseError(
        state == "42P01" ? "the database has no tables of sweepd: `sweepd collect` makes them"
                         : "PostgreSQL refused (" + why + ')',
        !gone && (state.starts_with("22") || state.starts_with("23") || state.starts_with("54")));
  }
  std::vector<SqlRow> rows(static_cast<std::size_t>(PQntuples(result.get())));
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (int c = 0; c < PQnfields(result.get()); ++c) {
      const int row = static_cast<int>(r);
      rows[r].emplace_back(PQgetvalue(result.get(), row, c),
                           static_cast<std::size_t>(PQgetlength(result.get(), row, c)));
    }
  return rows;
}

void Database::roll_back() noexcept {
  try {
    if (server_) run("rollback");
  } catch (...) {  // it is gone, and the transaction with it
    server_.reset();
  }
}

std::string bytes_of_text(std::string_view text) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  if (!text.starts_with("\\x") || text.size() % 2 != 0)
    throw DatabaseError("PostgreSQL tells bytes in another form than hexadecimal", false);
  std::string bytes;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2)
    bytes += static_cast<char>(digit(text[i]) << 4 | digit(text[i + 1]));
  return bytes;
}

std::string sql_list(const std::vector<std::optional<std::string>>& items) {
  std::string list = "{";
  for (const auto& item : items) {
    if (list.size() > 1) list += ',';
    if (!item) {
      list += "NULL";
      continue;
    }
    list += '"';
    for (const char c : *item) {
      if (c == '"' || c == '\\') list += '\\';
      list += c;
    }
    list += '"';
  }
  return list + '}';
}

}  // namespace sweepd
