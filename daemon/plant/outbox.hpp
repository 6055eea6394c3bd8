#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "daemon/plant/ledger.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

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
