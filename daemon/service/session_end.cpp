#include "daemon/service/session_end.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/record/recording_files.hpp"
#include "daemon/results/result_files.hpp"
#include "daemon/results/run_json.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/utc.hpp"
#include "rsi/capture/capture_reader.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;

/// How many telegrams a file was made of that is there already, by what stands at `place` of it; 0:
/// none is.
std::uint64_t telegrams_of(const fs::path& file, const char* place) {
  std::ifstream stream(file, std::ios::binary);
  const auto told = nlohmann::json::parse(stream, nullptr, false);
  const nlohmann::json::json_pointer pointer(place);
  if (!told.is_object() || !told.contains(pointer)) return 0;
  const auto& telegrams = told[pointer];
  return telegrams.is_number_unsigned() ? telegrams.get<std::uint64_t>() : 0;
}

/// Before which files of a recording others are missing, that were deleted or moved.
std::vector<std::string> holes_in(const std::vector<fs::path>& traces) {
  std::vector<std::string> holes;
  unsigned next = 1;
  for (const auto& trace : traces) {
    const auto name = trace.filename().string();
    const auto part =
        sweepd::part_of(name, file_names::kTraceStem, file_names::kTraceEnding).value_or(next);
    if (part != next)
      holes.push_back("files of the recording before " + name +
                      " are not there, perhaps deleted as keep_bytes and keep_days say: the result "
                      "lacks what they held");
    next = part + 1;
  }
  return holes;
}

/// A trace has a head from its beginning: one of no bytes was cut later.
bool holds_nothing(const fs::path& trace) {
  std::error_code error;
  return fs::file_size(trace, error) == 0 && !error;
}

}  // namespace

bool has_trace(const fs::path& folder) {
  const auto traces = traces_of(folder);
  return !std::all_of(traces.begin(), traces.end(), holds_nothing);
}

std::size_t SessionEnd::samples() const {
  std::size_t samples = 0;
  for (const auto& sweep : snapshot.sweeps) samples += sweep.samples->size();
  return samples;
}

bool SessionEnd::has_usable_sweeps() const {
  return std::any_of(snapshot.sweeps.begin(), snapshot.sweeps.end(),
                     [](const auto& sweep) { return sweep.defect == identify::SweepDefect::none; });
}

void SessionEnd::write() {
  if (recording && !recording->folder().empty()) folder = recording->folder();
  if (folder.empty()) folder = make_session_folder(robot_folder, started);
  if (!std::filesystem::exists(folder)) {  // deleted meanwhile
    make_folder(folder);
    written.clear();
    link_written = false;
  }
  std::exception_ptr failure;
  const auto attempt = [&](const auto& write) {
    try {
      write();
    } catch (const std::exception&) {
      if (!failure) failure = std::current_exception();
    }
  };
  const bool all = has_usable_sweeps();
  if (!all)
    for (const auto& name : result_file_names())
      if (name != file_names::kResult) written.insert(name);
  attempt([&] {
    // The trace tells the rest. What was written by SIGUSR1 has to become final.
    const bool worth_it = link && (all || !link->good || !link->bad_end.empty() ||
                                   std::filesystem::exists(folder / file_names::kLinkText));
    if (worth_it && !link_written) write_link(folder, *link);
    link_written = true;
  });
  attempt([&] { write_result(folder, *outcome, written); });
  if (failure) std::rethrow_exception(failure);
  write_atomically(folder / file_names::kRun, run(folder));
}

SessionReplay::SessionReplay(fs::path folder, FolderLock lock, const RobotSetup& setup)
    : folder_(std::move(folder)), lock_(std::move(lock)), device_(setup) {
  traces_ = traces_of(folder_);
  damage_ = holes_in(traces_);
  std::erase_if(traces_, [this](const fs::path& trace) {
    const bool empty = holds_nothing(trace);
    if (empty)
      damage_.push_back(trace.filename().string() +
                        " is empty, somebody or a damaged disk took what it held: the result "
                        "lacks it");
    return empty;
  });
  has_gaps_ = !damage_.empty();
  const auto search = rsi::find_conversation(traces_);
  if (search.chosen) conversation_ = *search.chosen;
  std::reverse(traces_.begin(), traces_.end());
  session_ = std::make_unique<Session>(setup, "trace", static_cast<StreamSink&>(*this));
}

bool SessionReplay::step() {
  constexpr int kDatagrams = 20'000;
  for (int i = 0; i < kDatagrams; ++i) {
    if (!trace_) {
      if (traces_.empty()) return false;
      trace_.emplace(traces_.back());
      traces_.pop_back();
    }
    const auto datagram = trace_->next();
    if (!datagram) {
      for (auto& note : trace_->notes()) {
        damage_.push_back(std::move(note));
        has_gaps_ = has_gaps_ || !traces_.empty();
      }
      trace_.reset();
      continue;
    }
    newest_ = std::max(newest_, datagram->time);
    if (device_.is_device(*datagram)) {
      device_.device(*datagram);
      continue;
    }
    const auto direction = conversation_.direction(*datagram);
    if (direction == rsi::Direction::to_controller) session_->reply(*datagram);
    if (direction != rsi::Direction::from_controller) continue;
    device_.telegram(*datagram);
    session_->telegram(*datagram);
  }
  return true;
}

std::optional<LinkFiles> SessionReplay::link() const {
  const auto& told = session_->link();
  const auto telegrams = told.statistics().counts().telegrams;
  // Of gaps it would say that the link had them. One that sweepd itself wrote knew more.
  if (has_gaps_ || recording_paused(folder_) || recording_deleted(folder_) ||
      telegrams_of(folder_ / file_names::kLink, "/telegrams/received") >= telegrams)
    return std::nullopt;
  LinkWatch watch;
  watch.conversation = conversation_;
  watch.from_recording = true;
  return watch.files(told, false);
}

SessionEnd SessionReplay::end(std::vector<FileHash> inputs, Log log) {
  session_->finish();
  const auto started = folder_.filename().string();
  log.about(started, {});
  const auto snapshot = device_.with_device(session_->snapshot());
  const bool better = telegrams_of(folder_ / file_names::kResult, "/source/telegrams") <=
                      snapshot.counts.link.telegrams;
  if (recording_paused(folder_))
    damage_.emplace_back(
        "the recording paused, as the disk had no room or refused: what came then may be missing");
  if (recording_deleted(folder_))
    damage_.emplace_back(
        "somebody deleted, moved or cut a folder or file of this session while it was written: the "
        "recording lacks what was in it");
  CutSession cut{utc_name(newest_), std::nullopt, damage_};
  if (better) cut.made_of = std::move(inputs);
  SessionEnd end{folder_.parent_path(),
                 started,
                 nullptr,
                 folder_,
                 snapshot,
                 link(),
                 [cut = std::move(cut)](const fs::path& folder) {
                   return run_json_of_cut_session(folder, cut);
                 },
                 std::move(log)};
  for (const std::string& what : damage_) end.log.warning("{}", what);
  end.lock = std::move(lock_);
  if (!better) {
    end.old_result_stays = true;
    end.log.note("the result in {} stays: it knew more than is in the recording", folder_.string());
    for (auto& name : result_file_names()) end.written.insert(std::move(name));
  }
  return end;
}

void end_without_trace(const fs::path& folder) {
  fs::file_time_type newest = fs::file_time_type::min();
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto name = entry.path().filename().string();
    if (name == file_names::kRun || name == file_names::kResult ||
        part_of(name, file_names::kSamplesStem, file_names::kSamplesEnding))
      newest = std::max(newest, entry.last_write_time());
  }
  const auto ended = std::chrono::file_clock::to_sys(newest).time_since_epoch();
  write_atomically(
      folder / file_names::kRun,
      run_json_of_cut_session(
          folder, {utc_name(ended), std::nullopt, {"there is no trace to make a last result of"}}));
}

}  // namespace sweepd
