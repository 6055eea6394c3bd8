#include "daemon/record/retention.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/record/recording_files.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/text/file_names.hpp"

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
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread has this folder's entries
    const dirent* const entry = readdir(entries_);
    return entry == nullptr ? std::nullopt : std::optional<std::string>(entry->d_name);
  }

 private:
  DIR* entries_;
};

/// What of a session is not in numbered parts goes with the last one.
constexpr unsigned kAfterAllParts = std::numeric_limits<unsigned>::max();

std::optional<unsigned> part_of(std::string_view name) {
  for (const auto& [stem, ending] :
       {std::pair(file_names::kTraceStem, file_names::kTraceEnding),
        std::pair(file_names::kSamplesStem, file_names::kSamplesEnding)}) {
    if (const auto part = sweepd::part_of(name, stem, ending)) return part;
  }
  constexpr std::array<std::string_view, 4> kBesideResults{
      file_names::kSweeps, file_names::kLinkText, file_names::kLink, file_names::kLastCycles};
  if (std::count(kBesideResults.begin(), kBesideResults.end(), name) > 0) return kAfterAllParts;
  return std::nullopt;
}

/// Whether a session left a table of its own, that stays.
bool is_table(std::string_view name) {
  return name == file_names::kTable || name == file_names::kReport;
}

/// Of a session without a table not even these stay.
bool is_about_session(std::string_view name) {
  return name == file_names::kRun || name == file_names::kResult;
}

/// What of one number lies in a session's folder.
struct Part {
  std::string session;
  std::vector<std::string> files;
  std::uint64_t bytes = 0;
  Time written{};
  bool whole_folder = false;  // goes with it

  void add(const std::string& name, const struct stat& status, Time now) {
    files.push_back(name);
    bytes += static_cast<std::uint64_t>(status.st_size);
    const auto time = std::chrono::system_clock::from_time_t(status.st_mtim.tv_sec);
    written = std::max(written, std::min(time, now));
  }
};
using Parts = std::map<std::pair<SessionName, unsigned>, Part>;  // oldest first

struct Sweeping {
  Deleted deleted;

  void trouble(const std::string& what) {
    if (deleted.trouble.empty())
      deleted.trouble = what + " (" + std::generic_category().message(errno) + ")";
  }
};

void look_into(int robot, const std::string& session, const SessionName& start, Time now,
               Parts& parts) {
  Folder folder(openat(robot, session.c_str(), kFolder | O_NOFOLLOW));
  if (!folder) return;  // no folder, or a link to one
  bool has_table = false;
  Part rest;  // of a session without a table
  while (const auto name = folder.next()) {
    has_table = has_table || is_table(*name);
    const auto part = part_of(*name);
    struct stat status {};
    if ((!part && !is_about_session(*name)) ||
        fstatat(folder.descriptor(), name->c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 ||
        !S_ISREG(status.st_mode))
      continue;
    Part& found = part ? parts[{start, *part}] : rest;
    found.session = session;
    found.add(*name, status, now);
  }
  if (has_table || rest.files.empty()) return;
  Part& last = parts[{start, kAfterAllParts}];
  last.session = session;
  last.files.insert(last.files.end(), rest.files.begin(), rest.files.end());
  last.bytes += rest.bytes;
  last.written = std::max(last.written, rest.written);
  last.whole_folder = true;
}

/// From when the days of what was written before `gap` are counted, and that gap. Where nothing was
/// written for longer than a recording is kept, robots stood still or the clock jumped; until more
/// was written after the gap than before, the clock is not believed to have passed it.
struct Clock {
  Time gap;
  Time before_gap;
};

Clock believed_clock(const Parts& parts, Time now, std::chrono::seconds keep) {
  std::vector<Time> times;
  for (const auto& [key, part] : parts) times.push_back(part.written);
  std::sort(times.begin(), times.end(), std::greater<>());
  Time later = now;
  for (std::size_t after = 0; after < times.size(); later = times[after++])
    if (later - times[after] > keep && 2 * after <= times.size()) return {later, times[after]};
  return {Time::min(), now};
}

void remove(int robot, const Part& part, bool is_own, Sweeping& sweeping) {
  const Folder folder(openat(robot, part.session.c_str(), kFolder | O_NOFOLLOW));
  if (!folder) return sweeping.trouble("cannot open " + part.session);
  // Somebody else writes there, or makes its last result: another sweepd with the same output, too.
  // A file system without locks tells nothing of that.
  if (!is_own && flock(folder.descriptor(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return;
  for (const auto& name : part.files) {
    if (unlinkat(folder.descriptor(), name.c_str(), 0) == 0)
      ++sweeping.deleted.files;
    else
      return sweeping.trouble("cannot delete " + part.session + '/' + name);
  }
  sweeping.deleted.bytes += part.bytes;
  if (part.whole_folder) unlinkat(robot, part.session.c_str(), AT_REMOVEDIR);  // if it is empty
}

void sweep(const std::filesystem::path& robot_folder, const RecordingSettings& settings, Time now,
           const InUse& in_use, Sweeping& sweeping) {
  Folder robot(open(robot_folder.c_str(), kFolder));
  if (!robot) return sweeping.trouble("cannot open " + robot_folder.string());
  Parts parts;
  while (const auto name = robot.next())
    if (const auto start = session_name(*name))
      look_into(robot.descriptor(), *name, *start, now, parts);

  const Clock clock = believed_clock(parts, now, settings.keep);
  std::uint64_t bytes = 0;
  for (const auto& [key, part] : parts) bytes += part.bytes;
  for (const auto& [key, part] : parts) {
    const Time until = part.written < clock.gap ? clock.before_gap : now;
    const bool old = settings.keep.count() > 0 && until - part.written > settings.keep;
    const bool beyond = settings.keep_bytes > 0 && bytes > settings.keep_bytes;
    if (!old && !beyond) continue;
    if (part.session == in_use.session && key.second >= in_use.part) continue;
    const bool is_own = part.session == in_use.session;
    const auto before = sweeping.deleted.files;
    remove(robot.descriptor(), part, is_own, sweeping);
    if (sweeping.deleted.files == before) continue;
    if (is_own) sweeping.deleted.of_session += sweeping.deleted.files - before;
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
