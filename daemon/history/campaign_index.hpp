#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace sweepd {

/// An SQLite file that keeps what folders of results tell, in short. It holds nothing that the
/// folders do not: who deletes it loses some seconds. One thread; other programs may have the same
/// file open. All functions throw std::runtime_error with the file and the reason.
class CampaignIndex {
 public:
  struct Entry {
    std::string stamp;  ///< changes with the folder's files
    std::vector<std::uint8_t> record;
  };
  using Entries = std::map<std::string, Entry>;  ///< by folder

  /// Opens or makes it. `anew`: with nothing in it. A file that is no index is refused.
  CampaignIndex(const std::filesystem::path& file, bool anew);
  ~CampaignIndex();
  CampaignIndex(const CampaignIndex&) = delete;
  CampaignIndex& operator=(const CampaignIndex&) = delete;

  [[nodiscard]] Entries entries();
  /// All at once, or nothing.
  void update(const Entries& changed, const std::vector<std::string>& gone);

 private:
  class Statement;
  [[noreturn]] void fail() const;
  void execute(const char* sql);
  [[nodiscard]] int number(const char* pragma);

  std::filesystem::path file_;
  sqlite3* base_ = nullptr;
};

}  // namespace sweepd
