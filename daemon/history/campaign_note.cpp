#include "daemon/history/campaign_note.hpp"

#include <cerrno>
#include <stdexcept>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "daemon/report/file_parts.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/json_text.hpp"
#include "daemon/text/utc.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

std::optional<CampaignNote> parse_note(std::string_view line) {
  const Json json = Json::parse(line, nullptr, false);
  const auto time = parse_utc(text_of(json, "time"));
  if (!time) return std::nullopt;
  CampaignNote note{*time, text_of(json, "text"), {}, flag_of(json, "measured")};
  if (part_of(json, "same_state").is_string()) note.same_state = text_of(json, "same_state");
  return note;
}

}  // namespace

CampaignNotes parse_notes(std::string_view jsonl) {
  CampaignNotes found;
  for (std::size_t number = 1; !jsonl.empty(); ++number) {
    const std::string_view line = take_line(jsonl);
    if (line.empty()) continue;
    if (const auto note = parse_note(line))
      found.notes.push_back(*note);
    else
      found.broken_lines.push_back(number);
  }
  return found;
}

std::string note_line(const CampaignNote& note) {
  Json json = {{"time", utc_text(note.time)}};
  if (!note.text.empty()) json["text"] = note.text;
  if (note.same_state) json["same_state"] = *note.same_state;
  if (note.measured) json["measured"] = true;
  return json_line(json);
}

void append_note(const std::filesystem::path& folder, const CampaignNote& note) {
  const auto path = folder / kNotesFile;
  const auto fail = [&](int reason) { throw std::runtime_error(cannot_write(path, reason)); };
  const int file = open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) fail(errno);
  const off_t size = lseek(file, 0, SEEK_END);
  char last = '\n';
  // What another program left unfinished ends here.
  if (size > 0 && pread(file, &last, 1, size - 1) != 1) last = '\n';
  const std::string line = (last == '\n' ? "" : "\n") + note_line(note) + '\n';
  const auto written = write(file, line.data(), line.size());
  const int reason = written == static_cast<ssize_t>(line.size()) && fsync(file) == 0 ? 0
                     : written < 0                                                    ? errno
                                                                                      : ENOSPC;
  close(file);
  if (reason != 0) fail(reason);
}

}  // namespace sweepd
