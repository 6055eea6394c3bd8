#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/record/recording.hpp"
#include "daemon/system/file_hash.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// What run.json tells of a live session: when and where, and how the link and the recording went.
struct RunFacts {
  std::string robot;
  std::string started;  ///< UTC, ISO 8601
  std::string ended;    ///< empty: it goes on
  std::filesystem::path folder;
  std::filesystem::path description;
  std::optional<std::filesystem::path> ethernet_config;
  std::vector<FileHash> inputs;  ///< description, plan, Ethernet file, as they were read
  rsi::Endpoint listen;
  std::string watched_on;    ///< the interface, where another program answers; else empty
  rsi::Server::Counts link;  ///< since the start of sweepd
  std::optional<Recording::Counts> recording;  ///< once it ended
  std::uint64_t queue_full =
      0;  ///< datagrams of the session that the server's queue had no room for
};

/// As all that sweepd tells of recordings has it.
[[nodiscard]] nlohmann::ordered_json records_json(const RecordCount& count);

[[nodiscard]] std::string run_json(const RunFacts& facts);

/// The same of a command that ends with its result: what it was given, how it was called (without
/// the program's name), and what it read.
[[nodiscard]] std::string run_json(std::string_view command, const nlohmann::ordered_json& given,
                                   const std::vector<std::string>& arguments,
                                   const std::vector<FileHash>& inputs);

/// Of a session that was cut.
struct CutSession {
  std::string ended;
  /// Where the result was made from the recording: of which files, too. Nothing: it stays.
  std::optional<std::vector<FileHash>> made_of;
  std::vector<std::string> damage;  ///< what is wrong with the recording, sentences
};

/// What run.json of `folder` becomes once all files of that session are final: as it is, but for
/// counts that were those of its beginning. Made anew where it cannot be read.
[[nodiscard]] std::string run_json_of_cut_session(const std::filesystem::path& folder,
                                                  const CutSession& cut);

/// Says in run.json of a session under way that its recording paused. In place: a full disk takes
/// nothing else. Where that cannot be, nothing happens.
void mark_recording_paused(const std::filesystem::path& folder);
/// Whether it says so.
[[nodiscard]] bool recording_paused(const std::filesystem::path& folder);

/// The same of what somebody deleted, moved or cut of the recording. Not in place: this folder is
/// new, on a disk that has just taken it.
void mark_recording_deleted(const std::filesystem::path& folder);
[[nodiscard]] bool recording_deleted(const std::filesystem::path& folder);

}  // namespace sweepd
