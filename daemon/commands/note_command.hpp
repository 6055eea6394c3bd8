#pragma once

#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct NoteOptions {
  std::filesystem::path folder;
  std::vector<std::string> words;
  std::optional<std::string> same_state;
  std::optional<std::string> at;        ///< a date; nothing: now
  std::optional<std::string> measured;  ///< a date
};

/// Appends a note to a folder, or prints those that it has where there is nothing to append.
/// Returns the exit code. Throws std::invalid_argument and std::runtime_error.
[[nodiscard]] int note(const NoteOptions& options, std::ostream& out = std::cout);

CLI::App* add_note(CLI::App& app, NoteOptions& options);

}  // namespace sweepd
