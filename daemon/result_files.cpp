#include "daemon/result_files.hpp"

#include "daemon/atomic_file.hpp"
#include "daemon/report.hpp"
#include "daemon/result_csv.hpp"
#include "daemon/result_json.hpp"

namespace sweepd {

void write_result(const std::filesystem::path& folder, const Outcome& outcome) {
  write_atomically(folder / "sweeps.csv", sweeps_csv(outcome));
  write_atomically(folder / "dh.csv", dh_csv(outcome));
  write_atomically(folder / "report.txt", report(outcome));
  write_atomically(folder / "result.json", result_json(outcome));
}

}  // namespace sweepd
