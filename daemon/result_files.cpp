#include "daemon/result_files.hpp"

#include <stdexcept>

#include "daemon/atomic_file.hpp"
#include "daemon/dh_latex.hpp"
#include "daemon/models.hpp"
#include "daemon/models_csv.hpp"
#include "daemon/report.hpp"
#include "daemon/result_csv.hpp"
#include "daemon/result_json.hpp"
#include "daemon/urdf.hpp"

namespace sweepd {
namespace {

void write_models(const std::filesystem::path& folder, const Outcome& outcome) {
  const auto models = models_of(outcome);
  if (models.empty()) {
    // An interim result may have left them.
    std::error_code ignored;
    for (const char* name : {"robot.urdf", "dh.tex", "models.csv"})
      std::filesystem::remove(folder / name, ignored);
    return;
  }
  write_atomically(folder / "robot.urdf", urdf(models.back(), outcome));
  write_atomically(folder / "dh.tex", dh_latex(outcome));
  write_atomically(folder / "models.csv", models_csv(models));
}

}  // namespace

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error)
    throw std::runtime_error("cannot make the folder " + folder.string() + " (" + error.message() +
                             "): give one that may be written with --output");
}

void write_result(const std::filesystem::path& folder, const Outcome& outcome) {
  write_atomically(folder / "sweeps.csv", sweeps_csv(outcome));
  write_atomically(folder / "dh.csv", dh_csv(outcome));
  write_models(folder, outcome);
  write_atomically(folder / "report.txt", report(outcome));
  write_atomically(folder / "result.json", result_json(outcome));
}

}  // namespace sweepd
