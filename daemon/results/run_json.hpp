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
};

[[nodiscard]] std::string run_json(const RunFacts& facts);

/// The same of a command that ends with its result: what it was given, how it was called (without
/// the program's name), and what it read.
[[nodiscard]] std::string run_json(std::string_view command, const nlohmann::ordered_json& given,
                                   const std::vector<std::string>& arguments,
                                   const std::vector<FileHash>& inputs);

/// What run.json of `folder` becomes once the files of a session that was cut are final: as it is,
/// with "ended" and, where the result was made from the recording, "from_recording", and what is
/// wrong with the recording as "damage". Made anew where it cannot be read.
[[nodiscard]] std::string run_json_of_cut_session(const std::filesystem::path& folder,
                                                  const std::string& ended, bool from_recording,
                                                  const std::vector<std::string>& damage);

}  // namespace sweepd
