#include "daemon/commands/note_command.hpp"

#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/history/campaign_folders.hpp"
#include "daemon/history/campaign_note.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

void print_notes(const std::filesystem::path& folder, std::ostream& out) {
  std::ifstream stream(folder / kNotesFile, std::ios::binary);
  std::ostringstream bytes;
  if (stream) bytes << stream.rdbuf();
  const CampaignNotes found = parse_notes(std::move(bytes).str());
  if (found.notes.empty() && found.broken_lines.empty())
    out << "no notes in " << folder.string() << '\n';
  for (const CampaignNote& one : found.notes) {
    out << utc_text(one.time).substr(0, 16) << 'Z';
    if (one.measured) out << "  measured then";
    if (one.same_state && one.same_state->empty()) out << "  of no state";
    if (one.same_state && !one.same_state->empty())
      out << "  same state: " << rsi::printable(*one.same_state);
    if (!one.text.empty()) out << "  " << rsi::printable(one.text);
    out << '\n';
  }
  for (const std::size_t line : found.broken_lines)
    out << "line " << line << " is left out, as it is no note: correct it or delete it\n";
}

}  // namespace

int note(const NoteOptions& options, std::ostream& out) {
  if (!std::filesystem::is_directory(options.folder))
    throw std::runtime_error(options.folder.string() +
                             " is no folder: give one of results, or the one that holds them");
  CampaignNote one;
  for (const auto& word : options.words) one.text += (one.text.empty() ? "" : " ") + word;
  one.same_state = options.same_state;
  if (one.text.empty() && !one.same_state && !options.measured) {
    if (options.at)
      throw std::invalid_argument("--at dates a note, and there is none: give its text");
    print_notes(options.folder, out);
    return 0;
  }
  if (!holds_campaigns(options.folder))
    throw std::runtime_error(options.folder.string() +
                             " holds no result: give a folder of results, or the one that holds "
                             "those of a robot");
  if (options.at && options.measured)
    throw std::invalid_argument("--at and --measured are two dates of one note: make two notes");
  one.measured = options.measured.has_value();
  one.time = std::chrono::system_clock::now().time_since_epoch();
  if (options.at) one.time = date_option("--at", *options.at);
  if (options.measured) one.time = date_option("--measured", *options.measured);
  append_note(options.folder, one);
  out << "noted in " << (options.folder / kNotesFile).string() << '\n';
  return 0;
}

CLI::App* add_note(CLI::App& app, NoteOptions& options) {
  auto* command = app.add_subcommand(
      "note",
      "Write a dated note into a folder of results\n"
      "`sweepd history` shows notes beside what has changed. A note may also mark campaigns as of "
      "the same state: from these the repeatability between campaigns is known. Without a text and "
      "options it prints the notes of the folder.");
  command
      ->add_option("DIR", options.folder,
                   "Folder of results, or the one that holds those of a robot")
      ->required()
      ->type_name("");
  command->add_option("TEXT", options.words, "What is to be noted")->type_name("");
  command
      ->add_option(
          "--same-state", options.same_state,
          "Mark the campaign as of the same state of the robot as all that have this name. "
          "An empty name takes it back")
      ->type_name("NAME");
  command->add_option("--at", options.at, "Date the note, in UTC: 2026-03-01, 2026-03-01T14:30")
      ->type_name("DATE")
      ->default_str("now");
  command
      ->add_option("--measured", options.measured,
                   "Give the time of measurement (UTC), where the files do not hold it")
      ->type_name("DATE");
  command->footer(exit_status({kOk, kError, kWrongUsage}));
  return command;
}

}  // namespace sweepd
