#include "daemon/history/campaign_index.hpp"

#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include <sqlite3.h>

namespace sweepd {
namespace {

// In the file's head, see https://www.sqlite.org/fileformat.html
constexpr std::string_view kApplication = "swph";
constexpr int kApplicationNumber = 0x73777068;
constexpr std::streamoff kApplicationPlace = 68;
constexpr int kFormat = 1;  // of the records; another one is made anew
constexpr int kBusy_ms = 2000;

/// An index, whole or damaged, or nothing yet.
bool is_ours(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::file_size(file, error) == 0 || error) return true;
  std::string application(kApplication.size(), ' ');
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(kApplicationPlace);
  return stream.read(application.data(), static_cast<std::streamsize>(application.size())) &&
         application == kApplication;
}

}  // namespace

/// A statement for as long as it is needed.
class CampaignIndex::Statement {
 public:
  Statement(CampaignIndex& index, const char* sql) : index_(index) {
    if (sqlite3_prepare_v2(index.base_, sql, -1, &statement_, nullptr) != SQLITE_OK) index.fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void set(int place, const std::string& text) {
    sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()), nullptr);
  }
  void set(int place, const std::vector<std::uint8_t>& bytes) {
    sqlite3_bind_blob(statement_, place, bytes.data(), static_cast<int>(bytes.size()), nullptr);
  }
  /// Whether there is a row; without one the statement is ready to be run again.
  [[nodiscard]] bool step() {
    const int found = sqlite3_step(statement_);
    if (found == SQLITE_ROW) return true;
    if (found != SQLITE_DONE) index_.fail();
    sqlite3_reset(statement_);
    return false;
  }
  void run() { static_cast<void>(step()); }
  [[nodiscard]] int number(int column) const { return sqlite3_column_int(statement_, column); }
  /// Bytes of a text or a blob.
  template <typename Bytes>
  [[nodiscard]] Bytes bytes(int column) const {
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return data == nullptr ? Bytes() : Bytes(data, data + size);
  }

 private:
  CampaignIndex& index_;
  sqlite3_stmt* statement_ = nullptr;
};

CampaignIndex::CampaignIndex(const std::filesystem::path& file, bool anew) : file_(file) {
  if (!is_ours(file))
    throw std::runtime_error("The index " + file_.string() +
                             " is a file of another program. Name another file with --index.");
  std::error_code ignored;
  if (anew) std::filesystem::remove(file, ignored);
  if (sqlite3_open_v2(file.c_str(), &base_,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX,
                      nullptr) != SQLITE_OK) {
    const std::string why = sqlite3_errmsg(base_);
    sqlite3_close(base_);
    throw std::runtime_error(
        "The index " + file_.string() + " cannot be opened (" + why +
        "). Check the path and the permissions, or name another file with --index.");
  }
  sqlite3_busy_timeout(base_, kBusy_ms);
  try {
    if (number("PRAGMA user_version") == kFormat) return;
    execute("BEGIN IMMEDIATE");
    execute("DROP TABLE IF EXISTS campaign");
    execute(
        "CREATE TABLE campaign (folder TEXT PRIMARY KEY, stamp TEXT NOT NULL, "
        "record BLOB NOT NULL)");
    execute(("PRAGMA application_id = " + std::to_string(kApplicationNumber)).c_str());
    execute(("PRAGMA user_version = " + std::to_string(kFormat)).c_str());
    execute("COMMIT");
  } catch (...) {
    sqlite3_close(base_);
    throw;
  }
}

CampaignIndex::~CampaignIndex() {
  sqlite3_close(base_);
}

CampaignIndex::Entries CampaignIndex::entries() {
  Entries all;
  Statement rows(*this, "SELECT folder, stamp, record FROM campaign");
  while (rows.step())
    all[rows.bytes<std::string>(0)] = {rows.bytes<std::string>(1),
                                       rows.bytes<std::vector<std::uint8_t>>(2)};
  return all;
}

void CampaignIndex::update(const Entries& changed, const std::vector<std::string>& gone) {
  if (changed.empty() && gone.empty()) return;
  execute("BEGIN IMMEDIATE");
  try {
    Statement put(*this, "INSERT OR REPLACE INTO campaign VALUES (?, ?, ?)");
    for (const auto& [folder, entry] : changed) {
      put.set(1, folder);
      put.set(2, entry.stamp);
      put.set(3, entry.record);
      put.run();
    }
    Statement remove(*this, "DELETE FROM campaign WHERE folder = ?");
    for (const auto& folder : gone) {
      remove.set(1, folder);
      remove.run();
    }
    execute("COMMIT");
  } catch (...) {
    sqlite3_exec(base_, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

void CampaignIndex::fail() const {
  throw std::runtime_error("The index " + file_.string() + " cannot be used (" +
                           sqlite3_errmsg(base_) +
                           "). Make it anew with --rebuild, or name another file with --index.");
}

void CampaignIndex::execute(const char* sql) {
  if (sqlite3_exec(base_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

int CampaignIndex::number(const char* pragma) {
  Statement row(*this, pragma);
  return row.step() ? row.number(0) : 0;
}

}  // namespace sweepd
