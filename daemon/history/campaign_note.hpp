#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

/// The file of a folder in which its notes stand, a line of JSON each.
inline constexpr const char* kNotesFile = "notes.jsonl";

/// What a person knows of a campaign, or of the robot at some date.
struct CampaignNote {
  std::chrono::nanoseconds time{};  ///< of what it tells, since the Unix epoch
  std::string text;                 ///< may be empty
  /// The campaign is of this state of the robot, as all that have the same name; an empty name
  /// takes an earlier one back.
  std::optional<std::string> same_state = {};
  bool measured = false;  ///< `time` is when the campaign was measured
};

struct CampaignNotes {
  std::vector<CampaignNote> notes;        ///< as they stand in the file
  std::vector<std::size_t> broken_lines;  ///< counted from 1; they are passed over
};
[[nodiscard]] CampaignNotes parse_notes(std::string_view jsonl);
/// Without its end of line.
[[nodiscard]] std::string note_line(const CampaignNote& note);

/// Appends a line to the file of `folder`, and syncs it. Lines of two programs that do so at the
/// same time are both whole. Throws std::runtime_error.
void append_note(const std::filesystem::path& folder, const CampaignNote& note);

}  // namespace sweepd
