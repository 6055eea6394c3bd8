#include "daemon/results/result_files.hpp"

#include <array>
#include <exception>
#include <optional>

#include "daemon/report/html_report.hpp"
#include "daemon/results/displacement_csv.hpp"
#include "daemon/results/models.hpp"
#include "daemon/results/report.hpp"
#include "daemon/results/result_formats.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

using Content = std::optional<std::string>;  // nothing: there is no such file

struct ResultFile {
  const char* name;
  Content (*content)(const Outcome& outcome, const std::filesystem::path& folder);
  bool interim = false;   ///< while the session goes on, too
  bool of_files = false;  ///< made of the others: only once all of them are written
};

template <std::string (*text)(const Outcome&)>
Content always(const Outcome& outcome, const std::filesystem::path&) {
  return text(outcome);
}

/// What other commands made of the result before goes.
Content none(const Outcome&, const std::filesystem::path&) {
  return {};
}

const auto kFiles = std::to_array<ResultFile>({
    {file_names::kResult, always<result_json>, true},
    {file_names::kReport, always<report>, true},
    {file_names::kTable, always<dh_csv>},
    {"robot.urdf",
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       const auto models = models_of(outcome);
       return models.empty() ? Content() : urdf(models.back(), outcome);
     }},
    {"dh.tex",
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       return models_of(outcome).empty() ? Content() : dh_latex(outcome);
     }},
    {"models.csv",
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       const auto models = models_of(outcome);
       return models.empty() ? Content() : models_csv(models);
     }},
    {file_names::kSweeps, always<sweeps_csv>},
    {file_names::kPoses,
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       return outcome.identification.poses ? poses_csv(outcome) : Content();
     }},
    {file_names::kDisplacement,
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       if (!outcome.identification.poses || outcome.identification.poses->levels.empty()) return {};
       return displacement_csv(
           displacement_of(pose_predictor(poses_json(outcome)), outcome.limits));
     }},
    {file_names::kCurrents,
     [](const Outcome& outcome, const std::filesystem::path&) -> Content {
       return outcome.currents.empty() ? Content() : currents_csv(outcome);
     }},
    {file_names::kValidation, none},
    {file_names::kCorrection, none},
    {file_names::kSlices[0], none},
    {file_names::kSlices[1], none},
    {file_names::kSlices[2], none},
    // Made of the files above and of what else is in the folder.
    {file_names::kReportPage,
     [](const Outcome&, const std::filesystem::path& folder) -> Content {
       const ReportFolder read = read_report_folder(folder);
       return html_report(std::span(&read, 1));
     },
     false, true},
});

void write_or_remove(const std::filesystem::path& file, const Content& content) {
  std::error_code ignored;
  if (content)
    replace_file(file, *content);
  else
    std::filesystem::remove(file, ignored);  // an earlier result may have left it
}

}  // namespace

void make_folder(const std::filesystem::path& folder) {
  make_folder(folder, "give one that may be written with --output");
}

std::vector<std::string> result_file_names() {
  std::vector<std::string> names;
  names.reserve(kFiles.size());
  for (const auto& file : kFiles) names.emplace_back(file.name);
  return names;
}

void write_result(const std::filesystem::path& folder, const Outcome& outcome,
                  std::set<std::string>& written) {
  std::exception_ptr failure;
  for (const ResultFile& file : kFiles) {
    if (written.contains(file.name) || (file.of_files && failure)) continue;
    try {
      write_or_remove(folder / file.name, file.content(outcome, folder));
      written.insert(file.name);
    } catch (const std::exception&) {
      if (!failure) failure = std::current_exception();
    }
  }
  sync_folder(folder);
  if (failure) std::rethrow_exception(failure);
}

void write_result(const std::filesystem::path& folder, const Outcome& outcome) {
  std::set<std::string> written;
  write_result(folder, outcome, written);
}

void write_interim_result(const std::filesystem::path& folder, const Outcome& outcome) {
  std::set<std::string> written;
  for (const auto& file : kFiles)
    if (!file.interim) written.insert(file.name);
  write_result(folder, outcome, written);
}

}  // namespace sweepd
