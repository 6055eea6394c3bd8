#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/history/campaign_record.hpp"

namespace sweepd {

/// So many campaigns of one folder get an index there by themselves.
inline constexpr std::size_t kManyCampaigns = 100;
inline constexpr const char* kIndexFile = "history.sqlite";

struct IndexOptions {
  std::optional<std::filesystem::path> file;  ///< nothing: kIndexFile where there are many
  bool rebuild = false;
};

/// Campaigns of one robot, from wherever.
struct FoundCampaigns {
  std::vector<CampaignRecord> records;  ///< in any order
  std::vector<CampaignNote> notes;      ///< of no campaign alone
  std::vector<std::string> messages;    ///< sentences on what was missing, changed or broken
};

/// Files that the records were made of, whether they are there or not.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const FoundCampaigns& found);

/// Whether it is a folder of results, or has one in it, at most two levels deep.
[[nodiscard]] bool holds_campaigns(const std::filesystem::path& path);

/// Each path is a folder of results, or one with such folders in it, at most two levels deep. Says
/// what the index knew and the folders no longer have. An index that cannot be used is no error:
/// the folders are read. Throws std::runtime_error where a path is no folder.
[[nodiscard]] FoundCampaigns campaigns_in(const std::vector<std::filesystem::path>& paths,
                                          const IndexOptions& index);

}  // namespace sweepd
