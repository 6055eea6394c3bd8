#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace sweepd {

/// What the data cannot know and a report states all the same, as it was given: a name for people
/// and the text, which is empty where nothing was stated.
using ReportFacts = std::vector<std::pair<std::string, std::string>>;

/// All known facts, none of them stated.
[[nodiscard]] ReportFacts no_facts();

/// Those of a TOML file. Throws ConfigError.
[[nodiscard]] ReportFacts read_facts(const std::filesystem::path& file);

}  // namespace sweepd
