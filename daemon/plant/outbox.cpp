#include "daemon/plant/outbox.hpp"

#include <algorithm>
#include <cerrno>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "daemon/record/session_folder.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/system/file_hash.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/file_bytes.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw std::runtime_error("cannot write " + path.string() + " (" +
                           std::generic_category().message(errno) +
                           "): check its folder's permissions and the free space");
}

constexpr const char* kUnreadable =
    "cannot be read by the user of `sweepd publish`: change its permissions";

/// Folders named by a start, in their order.
std::map<SessionName, fs::path> sessions_in(const fs::path& folder) {
  std::map<SessionName, fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (const auto name = session_name(entry->path().filename().string()))
      found.emplace(*name, entry->path());
  return found;
}

/// Null where there is none.
Json run_of(const fs::path& folder) {
  const auto text = rsi::readable_bytes(folder / file_names::kRun);
  return text ? Json::parse(*text, nullptr, false) : Json();
}

/// "ended" is written last: what is read of a result after it is final. Other commands write theirs
/// at once.
bool is_final(const Json& run) {
  return run.is_object() &&
         (!records_sessions(text_of(run, "command")) || !text_of(run, "ended").empty());
}

}  // namespace

Ledger::Ledger(const std::filesystem::path& file) : path_(file) {
  std::string text = rsi::readable_bytes(file).value_or("");
  // A crash may have left half a line.
  text.resize(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) lines_.insert(line);
  file_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0640);
  if (file_ < 0) refuse(path_);
  const auto end = static_cast<off_t>(text.size());
  if (::ftruncate(file_, end) != 0 || ::lseek(file_, end, SEEK_SET) < 0) {
    ::close(file_);
    refuse(path_);
  }
}

Ledger::~Ledger() {
  ::close(file_);
}

bool Ledger::has(const std::string& session, const std::string& sha256) const {
  return lines_.contains(session + ' ' + sha256);
}

bool Ledger::has_later(const std::string& session) const {
  const auto name = session_name(session);
  return std::any_of(lines_.begin(), lines_.end(), [&](const std::string& line) {
    return session_name(line.substr(0, line.find(' '))) > name;
  });
}

void Ledger::add(const std::string& session, const std::string& sha256) {
  const auto [line, is_new] = lines_.insert(session + ' ' + sha256);
  if (!is_new) return;
  const std::string text = *line + '\n';
  const off_t begin = ::lseek(file_, 0, SEEK_CUR);
  if (::write(file_, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      ::fsync(file_) == 0)
    return;
  const int problem = errno;
  // No half line: what follows would stand in it.
  if (::ftruncate(file_, begin) == 0) ::lseek(file_, begin, SEEK_SET);
  errno = problem;
  refuse(path_);
}

Outbox::Outbox(fs::path robot_folder, Log log)
    : folder_(std::move(robot_folder)), log_(std::move(log)) {}

std::vector<FinishedResult> Outbox::take(std::size_t most, const Ledger& ledger) {
  std::vector<FinishedResult> found;
  unfinished_.clear();
  for (const auto& [order, folder] : sessions_in(folder_)) {
    const std::string session = folder.filename().string();
    const fs::path file = folder / file_names::kResult;
    std::error_code error;
    const Stamp stamp{fs::last_write_time(file, error).time_since_epoch().count(),
                      error ? 0 : fs::file_size(file, error)};
    if (error) {  // not yet, or not any more
      if (error == std::errc::permission_denied) complain(session, kUnreadable);
      if (!is_final(run_of(folder))) unfinished_.push_back(folder);
      continue;
    }
    const auto seen = seen_.find(session);
    if (seen != seen_.end() && seen->second == stamp) continue;

    if (found.size() == most) break;  // who takes these asks again
    const Json run = run_of(folder);
    if (run.is_null() && fs::exists(folder / file_names::kRun, error))
      complain(session, kUnreadable);
    else if (run.is_null())
      complain(session, "has a result.json and no run.json, it is half deleted or half copied");
    if (!is_final(run)) {
      unfinished_.push_back(folder);
      continue;
    }
    auto bytes = rsi::readable_bytes(file);
    if (!bytes) {
      if (fs::exists(file, error)) complain(session, kUnreadable);
      continue;
    }
    if (text_of(Json::parse(*bytes, nullptr, false), "schema").empty()) {
      complain(session, "has a result.json that is no result of sweepd");
      seen_[session] = stamp;
      continue;
    }
    const std::string sha256 = sha256_of(*bytes);
    if (ledger.has(session, sha256)) {
      seen_[session] = stamp;
      continue;
    }
    seen_[session] = stamp;
    found.push_back({session, folder, std::move(*bytes), sha256, text_of(run, "started"),
                     text_of(run, "ended")});
  }
  return found;
}

fs::path Outbox::before(const std::string& session) const {
  const auto sessions = sessions_in(folder_);
  const auto name = session_name(session);
  fs::path newest;
  for (const auto& [order, folder] : sessions) {
    if (!name || order >= *name) break;
    std::error_code error;
    if (fs::exists(folder / file_names::kResult, error) && is_final(run_of(folder)))
      newest = folder;
  }
  return newest;
}

void Outbox::complain(const std::string& session, const std::string& why) {
  if (complained_.insert(session + why).second)
    log_.warning("{} {}: it is not published", (folder_ / session).string(), why);
}

}  // namespace sweepd
