#include "daemon/service/session_end.hpp"

#include <algorithm>
#include <exception>

#include "daemon/results/result_files.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"

namespace sweepd {

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

}  // namespace sweepd
