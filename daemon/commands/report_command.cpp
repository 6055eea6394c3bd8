#include "daemon/commands/report_command.hpp"

#include <stdexcept>

#include <CLI/CLI.hpp>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/commands/outputs.hpp"
#include "daemon/report/html_report.hpp"
#include "daemon/report/pdf.hpp"
#include "daemon/results/change.hpp"
#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

/// Each folder with the one before it.
std::vector<Comparison> comparisons_of(const std::vector<std::filesystem::path>& paths,
                                       const std::vector<ReportFolder>& folders) {
  std::vector<Comparison> all;
  for (std::size_t k = 1; k < paths.size(); ++k) {
    all.push_back({folders[k - 1].name, folders[k].name, {}, {}});
    try {
      all.back().change = nlohmann::ordered_json::parse(change_json(
          change_between(read_told_arm(paths[k - 1]), read_told_arm(paths[k]), kUsualLevel)));
    } catch (const std::runtime_error& error) {
      all.back().why_not = error.what();
    }
  }
  return all;
}

}  // namespace

int make_report(const ReportOptions& options, std::ostream& out) {
  const auto facts = options.facts ? read_facts(*options.facts) : no_facts();
  std::vector<ReportFolder> folders;
  for (const auto& folder : options.folders) folders.push_back(read_report_folder(folder));
  const auto html_file = options.output.value_or(folders.size() == 1 ? options.folders.front() /
                                                                           file_names::kReportPage
                                                                     : file_names::kReportPage);
  std::vector<std::filesystem::path> inputs;
  if (options.facts) inputs.push_back(*options.facts);
  for (const auto& folder : folders)
    inputs.insert(inputs.end(), folder.files.begin(), folder.files.end());
  const Outputs outputs(std::move(inputs), options.force);
  outputs.check_made_again(html_file, kHtmlBegin);
  auto pdf_file = html_file;
  pdf_file.replace_extension("pdf");
  if (options.pdf) outputs.check_made_again(pdf_file, "%PDF");
  const std::string html = html_report(folders, facts, comparisons_of(options.folders, folders));
  write_output(html_file, html);
  out << html_file.string() << '\n';
  if (!options.pdf) return 0;
  write_pdf(html, pdf_file);
  out << pdf_file.string() << '\n';
  return 0;
}

CLI::App* add_report(CLI::App& app, ReportOptions& options) {
  auto* command =
      app.add_subcommand("report",
                         "Make the measurement report of result folders, with pictures\n"
                         "Every run writes one by itself, as report.html. This command makes it "
                         "again: with facts that "
                         "data cannot know, as a PDF, or of several folders side by side.");
  command->add_option("DIR", options.folders, "Folders that run, replay or identify has written")
      ->required()
      ->type_name("");
  command
      ->add_option("--facts", options.facts,
                   "Print what this file states: serial_number, controller, payload, temperature, "
                   "device, certificate, place, date, operator, customer, remarks. Each is a text")
      ->type_name("FILE");
  command->add_option("--output", options.output, "Write the report to this file")
      ->type_name("FILE")
      ->default_str("report.html in DIR, or here where there are several");
  command->add_flag("--pdf", options.pdf,
                    "Print it as a PDF, too, beside it. This needs Debian's package chromium");
  add_force(*command, options.force);
  command->footer(exit_status(
      {kOk,
       kError,
       kWrongUsage,
       {kConfigError, "The file of --facts is wrong. Standard error names the line."}}));
  return command;
}

}  // namespace sweepd
