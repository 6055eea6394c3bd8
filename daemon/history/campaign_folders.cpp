#include "daemon/history/campaign_folders.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include <sys/stat.h>

#include "daemon/history/campaign_index.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/counted.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

constexpr std::array kRecordFiles = {file_names::kResult, file_names::kRun, file_names::kLink,
                                     file_names::kCurrents, kNotesFile};
constexpr int kDeepest = 2;
constexpr std::size_t kMostNamed = 3;

std::string bytes_of(const fs::path& file) {
  return rsi::readable_bytes(file).value_or("");
}

/// Of the files that a record is made of: sizes, and when each was written last.
std::string stamp_of(const fs::path& folder) {
  std::string stamp;
  for (const char* name : kRecordFiles) {
    struct stat status {};
    if (stat((folder / name).c_str(), &status) == 0)
      stamp += std::to_string(status.st_size) + ' ' + std::to_string(status.st_mtim.tv_sec) + '.' +
               std::to_string(status.st_mtim.tv_nsec);
    stamp += ';';
  }
  return stamp;
}

CampaignRecord read_record(const fs::path& folder) {
  CampaignTexts texts;
  texts.name = folder.string();
  std::error_code why;
  texts.result = rsi::file_bytes(folder / file_names::kResult, rsi::kLargestFile, why);
  if (why && why != std::errc::no_such_file_or_directory) texts.problem = why.message();
  texts.run = bytes_of(folder / file_names::kRun);
  texts.link = bytes_of(folder / file_names::kLink);
  if (texts.result.find("\"currents\"") == texts.result.npos)
    texts.currents = bytes_of(folder / file_names::kCurrents);
  texts.notes = bytes_of(folder / kNotesFile);
  struct stat status {};
  if (stat((folder / file_names::kResult).c_str(), &status) == 0 ||
      stat(folder.c_str(), &status) == 0)
    texts.written = std::chrono::seconds(status.st_mtim.tv_sec);
  return campaign_record(texts);
}

bool holds_results(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / file_names::kResult, error) ||
         fs::exists(folder / file_names::kRun, error);
}

/// Where a folder really is, so that two ways to it are one folder.
fs::path place_of(const fs::path& folder) {
  std::error_code error;
  auto place = fs::canonical(folder, error);
  return error ? folder : place;
}

/// Folders of results in `path`, sorted; notes of the folders above them. What is in `seen` was
/// looked at on another way.
void look(const fs::path& path, int depth, std::set<fs::path>& seen, std::vector<fs::path>& folders,
          FoundCampaigns& found) {
  if (!seen.insert(place_of(path)).second) return;
  if (holds_results(path) || session_name(path.filename().string())) {
    folders.push_back(path);
    return;
  }
  CampaignNotes notes = parse_notes(bytes_of(path / kNotesFile));
  found.notes.insert(found.notes.end(), notes.notes.begin(), notes.notes.end());
  for (const std::size_t line : notes.broken_lines)
    found.messages.push_back("Line " + std::to_string(line) + " of " +
                             (path / kNotesFile).string() +
                             " is left out, as it is no note: correct it or delete it.");
  if (depth == kDeepest) return;
  std::vector<fs::path> below;
  std::error_code error, ignored;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_directory(ignored)) below.push_back(entry->path());
  if (error)
    found.messages.push_back(path.string() + " is left out, as it cannot be read (" +
                             error.message() + "): check its permissions.");
  std::sort(below.begin(), below.end());
  for (const fs::path& folder : below) look(folder, depth + 1, seen, folders, found);
}

/// "a, b, c and 5 more".
std::string named(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), kMostNamed); ++k)
    text += (k == 0 ? "" : ", ") + names[k];
  return names.size() > kMostNamed
             ? text + " and " + std::to_string(names.size() - kMostNamed) + " more"
             : text;
}

/// Records of an index as far as the folders are as it knew them; what is not is read and written.
std::vector<CampaignRecord> indexed(const fs::path& file, bool rebuild,
                                    const std::vector<fs::path>& folders,
                                    std::vector<std::string>& messages) {
  CampaignIndex index(file, rebuild);
  auto known = index.entries();
  const fs::path beside = fs::absolute(file).parent_path();
  CampaignIndex::Entries changed;
  std::vector<CampaignRecord> records;
  records.reserve(folders.size());
  for (const fs::path& folder : folders) {
    const std::string key =
        fs::absolute(folder).lexically_normal().lexically_proximate(beside).string();
    const std::string stamp = stamp_of(folder);
    const auto entry = known.find(key);
    bool as_before = entry != known.end() && entry->second.stamp == stamp;
    if (as_before) try {
        CampaignRecord record = unpacked(entry->second.record.data(), entry->second.record.size());
        record.name = folder.string();
        if (record.arm) record.arm->file = folder / file_names::kResult;
        records.push_back(std::move(record));
      } catch (const std::exception&) {
        as_before = false;
      }
    if (!as_before) {
      records.push_back(read_record(folder));
      changed[key] = {stamp, packed(records.back())};
    }
    if (entry != known.end()) known.erase(entry);
  }
  std::vector<std::string> gone;
  for (const auto& [folder, entry] : known) {
    std::error_code error;
    if (!fs::exists(beside / folder, error)) gone.push_back(folder);  // else it was not asked for
  }
  if (!gone.empty())
    messages.push_back("Gone since the index was written: " +
                       rsi::counted(gone.size(), "campaign") + " (" + named(gone) + ").");
  try {
    index.update(changed, gone);
  } catch (const std::runtime_error& problem) {
    messages.push_back(std::string(problem.what()) + " It is as old as it was.");
  }
  return records;
}

}  // namespace

std::vector<fs::path> files_of(const FoundCampaigns& found) {
  std::vector<fs::path> files;
  for (const CampaignRecord& record : found.records)
    for (const char* name : kRecordFiles) files.push_back(fs::path(record.name) / name);
  return files;
}

bool holds_campaigns(const fs::path& path) {
  FoundCampaigns ignored;
  std::vector<fs::path> folders;
  std::set<fs::path> seen;
  look(path.lexically_normal(), 0, seen, folders, ignored);
  return !folders.empty();
}

FoundCampaigns campaigns_in(const std::vector<fs::path>& paths, const IndexOptions& options) {
  FoundCampaigns found;
  std::vector<fs::path> folders;
  std::set<fs::path> seen;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path))
      throw std::runtime_error(path.string() +
                               " is no folder: give folders of results, or one that has them");
    look(path.lexically_normal(), 0, seen, folders, found);
  }
  std::sort(folders.begin(), folders.end());

  std::optional<fs::path> index = options.file;
  const bool alone = paths.size() == 1 && folders.size() >= kManyCampaigns;
  if (!index && (alone || (options.rebuild && paths.size() == 1)))
    index = paths.front() / kIndexFile;
  if (index) try {
      found.records = indexed(*index, options.rebuild, folders, found.messages);
      return found;
    } catch (const std::runtime_error& problem) {
      found.messages.push_back(std::string(problem.what()) + " All folders were read.");
    }
  found.records.clear();
  for (const fs::path& folder : folders) found.records.push_back(read_record(folder));
  return found;
}

}  // namespace sweepd
