#include "daemon/retention.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/recording_files.hpp"

namespace sweepd {
namespace {

using Time = std::chrono::system_clock::time_point;
constexpr int kFolder = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

class Folder {
 public:
  explicit Folder(int descriptor) : entries_(descriptor < 0 ? nullptr : fdopendir(descriptor)) {
    if (entries_ == nullptr && descriptor >= 0) close(descriptor);
  }
  ~Folder() {
    if (entries_ != nullptr) closedir(entries_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  explicit operator bool() const { return entries_ != nullptr; }
  [[nodiscard]] int descriptor() const { return dirfd(entries_); }
  /// The next name; nothing at the end.
  std::optional<std::string> next() {
    const dirent* const entry = readdir(entries_);
    return entry == nullptr ? std::nullopt : std::optional<std::string>(entry->d_name);
  }

 private:
  DIR* entries_;
};

bool digits(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::optional<unsigned> number(std::string_view text) {
  unsigned value = 0;
  if (!digits(text)) return std::nullopt;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  return end.ec == std::errc{} ? std::optional(value) : std::nullopt;
}

/// Sessions in the order in which they began: the start, and the number of those of one second.
using Start = std::pair<std::string, unsigned>;

/// Of a folder named 20130704T120000Z or 20130704T120000Z-2; nothing for any other name.
std::optional<Start> start_of(std::string_view name) {
  constexpr std::size_t kLength = 16;
  if (name.size() < kLength || name[8] != 'T' || name[15] != 'Z' || !digits(name.substr(0, 8)) ||
      !digits(name.substr(9, 6)))
    return std::nullopt;
  const auto start = std::string(name.substr(0, kLength));
  if (name.size() == kLength) return Start{start, 1};
  const auto again = number(name.substr(std::min(kLength + 1, name.size())));
  if (!again || *again < 2 || name != start + '-' + std::to_string(*again)) return std::nullopt;
  return Start{start, *again};
}

std::optional<unsigned> part_of(std::string_view name) {
  for (const auto& [stem, ending] :
       {std::pair<std::string_view, std::string_view>{"trace", ".pcap"}, {"samples", ".csv"}}) {
    if (!name.starts_with(stem) || !name.ends_with(ending)) continue;
    unsigned part = 1;
    if (name.size() > stem.size() + ending.size())
      part = number(name.substr(stem.size() + 1, name.size() - stem.size() - ending.size() - 1))
                 .value_or(1);
    if (name == part_name(stem, ending, part)) return part;
  }
  return std::nullopt;
}

/// What of one number lies in a session's folder.
struct Part {
  std::string session;
  std::vector<std::string> files;
  std::uint64_t bytes = 0;
  Time written{};
};
using Parts = std::map<std::pair<Start, unsigned>, Part>;  // oldest first

struct Sweeping {
  Deleted deleted;

  void trouble(const std::string& what) {
    if (deleted.trouble.empty())
      deleted.trouble = what + " (" + std::generic_category().message(errno) + ")";
  }
};

void look_into(int robot, const std::string& session, const Start& start, Parts& parts) {
  Folder folder(openat(robot, session.c_str(), kFolder | O_NOFOLLOW));
  if (!folder) return;  // no folder, or a link to one
  while (const auto name = folder.next()) {
    const auto part = part_of(*name);
    struct stat status {};
    if (!part || fstatat(folder.descriptor(), name->c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 ||
        !S_ISREG(status.st_mode))
      continue;
    auto& found = parts[{start, *part}];
    found.session = session;
    found.files.push_back(*name);
    found.bytes += static_cast<std::uint64_t>(status.st_size);
    found.written =
        std::max(found.written, std::chrono::system_clock::from_time_t(status.st_mtim.tv_sec));
  }
}

void remove(int robot, const Part& part, Sweeping& sweeping) {
  const Folder folder(openat(robot, part.session.c_str(), kFolder | O_NOFOLLOW));
  if (!folder) return sweeping.trouble("cannot open " + part.session);
  for (const auto& name : part.files) {
    if (unlinkat(folder.descriptor(), name.c_str(), 0) == 0)
      ++sweeping.deleted.files;
    else
      return sweeping.trouble("cannot delete " + part.session + '/' + name);
  }
  sweeping.deleted.bytes += part.bytes;
}

void sweep(const std::filesystem::path& robot_folder, const RecordingSettings& settings, Time now,
           const InUse& in_use, Sweeping& sweeping) {
  Folder robot(open(robot_folder.c_str(), kFolder));
  if (!robot) return sweeping.trouble("cannot open " + robot_folder.string());
  Parts parts;
  while (const auto name = robot.next())
    if (const auto start = start_of(*name)) look_into(robot.descriptor(), *name, *start, parts);

  std::uint64_t bytes = 0;
  for (const auto& [key, part] : parts) bytes += part.bytes;
  for (const auto& [key, part] : parts) {
    const bool old = settings.keep.count() > 0 && now - part.written > settings.keep;
    const bool beyond = settings.keep_bytes > 0 && bytes > settings.keep_bytes;
    if (!old && !beyond) continue;
    if (part.session == in_use.session && key.second >= in_use.part) continue;
    remove(robot.descriptor(), part, sweeping);
    bytes -= part.bytes;
  }
}

}  // namespace

Deleted delete_old_recordings(const std::filesystem::path& robot_folder,
                              const RecordingSettings& settings, Time now,
                              const InUse& in_use) noexcept {
  if (settings.keep.count() == 0 && settings.keep_bytes == 0) return {};
  Sweeping sweeping;
  try {
    sweep(robot_folder, settings, now, in_use, sweeping);
  } catch (const std::exception& error) {  // no memory
    sweeping.deleted.trouble = error.what();
  }
  return sweeping.deleted;
}

}  // namespace sweepd
