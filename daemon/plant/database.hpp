#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct pg_conn;

namespace sweepd {

/// PostgreSQL refused something. The text ends with what to do.
class DatabaseError : public std::runtime_error {
 public:
  DatabaseError(const std::string& what, bool by_data)
      : std::runtime_error(what), by_data_(by_data) {}
  /// The data are what it refuses (SQLSTATE 22…, 23…, 54…): the same again would change nothing.
  /// Else it is away, full, restarted or not permitted, and the same may succeed later.
  [[nodiscard]] bool by_data() const { return by_data_; }

 private:
  bool by_data_;
};

/// What stands for $1, $2, … in a statement.
struct SqlValue {
  std::optional<std::string> text;  ///< nothing: null
  bool bytes = false;               ///< as they are, of bytea

  SqlValue(std::string value) : text(std::move(value)) {}         // NOLINT: so that lists are short
  SqlValue(const char* value) : text(value) {}                    // NOLINT
  SqlValue(std::optional<std::string> v) : text(std::move(v)) {}  // NOLINT
  [[nodiscard]] static SqlValue of_bytes(std::string_view bytes);
};

using SqlRow = std::vector<std::string>;  ///< null is empty

/// One connection to PostgreSQL. One thread.
class Database {
 public:
  /// libpq's connection string. Connects with the first statement.
  explicit Database(std::string connection);
  ~Database();

  /// Throws DatabaseError. Where the connection is gone it is made anew with the next statement.
  std::vector<SqlRow> run(const std::string& sql, const std::vector<SqlValue>& values = {});
  /// All that `work` does or nothing. Throws what it throws.
  template <typename Work>
  void at_once(const Work& work) {
    run("begin");
    try {
      work();
      run("commit");
    } catch (...) {
      roll_back();
      throw;
    }
  }

 private:
  void connect();
  void roll_back() noexcept;

  std::string connection_;
  std::unique_ptr<pg_conn, void (*)(pg_conn*)> server_;
};

/// From the hexadecimal text of a bytea.
[[nodiscard]] std::string bytes_of_text(std::string_view text);
/// A list of PostgreSQL, "{1,\"a b\",NULL}".
[[nodiscard]] std::string sql_list(const std::vector<std::optional<std::string>>& items);

/// Brings the tables to what this sweepd knows (migrations.cpp). Any number of programs at once.
/// Throws DatabaseError, and std::runtime_error where the tables are of a newer sweepd.
void migrate(Database& database);

}  // namespace sweepd
