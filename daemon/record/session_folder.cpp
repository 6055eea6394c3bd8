#include "daemon/record/session_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <map>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/record/recording_files.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

bool is_unfinished(const fs::path& folder) {
  std::ifstream stream(folder / file_names::kRun, std::ios::binary);
  const auto run = nlohmann::json::parse(stream, nullptr, false);
  // Without it, or of a damaged one, nobody knows whose results these are.
  std::error_code error;
  if (!run.is_object())
    return !traces_of(folder).empty() && !fs::exists(folder / file_names::kResult, error);
  const auto command = run.value("command", nlohmann::json());
  return command.is_string() && records_sessions(command.get<std::string>()) &&
         !run.contains("ended");
}

}  // namespace

std::optional<SessionName> session_name(std::string_view name) {
  constexpr std::size_t kLength = 16;
  if (name.size() < kLength || name[8] != 'T' || name[15] != 'Z' ||
      !rsi::all_digits(name.substr(0, 8)) || !rsi::all_digits(name.substr(9, 6)))
    return std::nullopt;
  const auto start = std::string(name.substr(0, kLength));
  if (name.size() == kLength) return SessionName{start, 1};
  const auto number = name.substr(std::min(kLength + 1, name.size()));
  unsigned again = 0;
  const auto end = std::from_chars(number.data(), number.data() + number.size(), again);
  if (!rsi::all_digits(number) || end.ec != std::errc{} || again < 2 ||
      name != start + '-' + std::to_string(again))
    return std::nullopt;
  return SessionName{start, again};
}

fs::path make_session_folder(const fs::path& robot_folder, const std::string& start) {
  std::error_code error;
  fs::create_directories(robot_folder, error);
  auto folder = robot_folder / start;
  for (int again = 2; !error && mkdir(folder.c_str(), 0777) != 0; ++again) {
    if (errno != EEXIST) error.assign(errno, std::generic_category());
    folder = robot_folder / (start + '-' + std::to_string(again));
  }
  if (error)
    throw std::runtime_error("cannot make a folder in " + robot_folder.string() + " (" +
                             error.message() + "): check its permissions and the free space");
  sync_folder(robot_folder);
  return folder;
}

FolderLock::FolderLock(const fs::path& folder)
    : folder_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0 || flock(folder_, LOCK_EX | LOCK_NB) == 0) return;
  close(folder_);
  folder_ = -1;
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) close(folder_);
}

std::vector<fs::path> unfinished_sessions(const fs::path& robot_folder) {
  std::map<SessionName, fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(robot_folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const auto name = session_name(entry->path().filename().string());
    if (name && !entry->is_symlink(error) && is_unfinished(entry->path()))
      found.emplace(*name, entry->path());
  }
  std::vector<fs::path> folders;
  folders.reserve(found.size());
  for (const auto& [name, folder] : found) folders.push_back(folder);
  std::reverse(folders.begin(), folders.end());
  return folders;
}

}  // namespace sweepd
