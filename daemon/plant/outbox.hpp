#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/system/log.hpp"

namespace sweepd {

/// What the broker has acknowledged, on the disk: a line for each result, its session and its
/// SHA-256. A crash costs nothing but the line that was being written. One thread.
class Ledger {
 public:
  /// Reads the file, which need not be there. Throws std::runtime_error where it cannot be written.
  explicit Ledger(const std::filesystem::path& file);
  ~Ledger();
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  [[nodiscard]] bool has(const std::string& session, const std::string& sha256) const;
  /// On the disk when this returns. Throws std::runtime_error where the disk refuses it; has() is
  /// true all the same, until the end of the program.
  void add(const std::string& session, const std::string& sha256);
  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  /// Whether a session is there that began later.
  [[nodiscard]] bool has_later(const std::string& session) const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::set<std::string> lines_;
};

/// A final result.json, as it is on the disk.
struct FinishedResult {
  std::string session;  ///< name of its folder
  std::filesystem::path folder;
  std::string bytes;
  std::string sha256;
  std::string started, ended;  ///< by run.json, in UTC; perhaps empty
};

/// The final results in a robot's folder that nobody was told of yet. Only reads. One thread.
class Outbox {
 public:
  Outbox(std::filesystem::path robot_folder, Log log);

  /// Those that the ledger does not have, oldest session first, at most so many. Each once, and
  /// again once its file is another. What is half there is told once, and left alone.
  [[nodiscard]] std::vector<FinishedResult> take(std::size_t most, const Ledger& ledger);
  /// It did not arrive: take() has it again.
  void give_back(const std::string& session) { seen_.erase(session); }
  /// The newest session before this one that has a result; empty: none.
  [[nodiscard]] std::filesystem::path before(const std::string& session) const;
  /// Sessions whose end is still to come, to be watched.
  [[nodiscard]] const std::vector<std::filesystem::path>& unfinished() const { return unfinished_; }
  /// How many times it was told that something is not published.
  [[nodiscard]] std::size_t complaints() const { return complained_.size(); }

 private:
  using Stamp = std::pair<std::int64_t, std::uint64_t>;  ///< when a file was changed; its size

  void complain(const std::string& session, const std::string& why);

  std::filesystem::path folder_;
  Log log_;
  std::map<std::string, Stamp> seen_;  ///< by session
  std::set<std::string> complained_;
  std::vector<std::filesystem::path> unfinished_;
};

}  // namespace sweepd
