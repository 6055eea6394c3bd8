#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "daemon/record/recording.hpp"
#include "daemon/record/session_folder.hpp"
#include "daemon/results/outcome.hpp"
#include "daemon/service/link_watch.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/system/log.hpp"

namespace sweepd {

/// A session that is over, until all that it leaves is written. One thread at a time.
struct SessionEnd {
  std::filesystem::path robot_folder;
  std::string started;                         ///< as its folder is named
  std::shared_ptr<const Recording> recording;  ///< null: all is in `folder` already
  std::filesystem::path folder;                ///< where it goes; empty: not known yet
  Snapshot snapshot;
  std::optional<LinkFiles> link;
  /// What run.json will be, with "ended".
  std::function<std::string(const std::filesystem::path& folder)> run;
  Log log;
  FolderLock lock = {};

  std::optional<Outcome> outcome = {};  ///< once it is identified
  std::set<std::string> written = {};
  bool link_written = false;
  bool failed_before = false;  ///< to be written

  /// Samples that are in memory for it.
  [[nodiscard]] std::size_t samples() const;
  /// Without a sweep that can be used there is little to write: no DH table, no report.
  [[nodiscard]] bool has_usable_sweeps() const;
  /// Writes what is not yet written: what matters most first, run.json last. Whatever can be
  /// written is, then std::runtime_error says what could not.
  void write();
};

}  // namespace sweepd
