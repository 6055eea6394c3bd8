#include "daemon/commands/report_command.hpp"

#include "daemon/commands/outputs.hpp"
#include "daemon/report/html_report.hpp"
#include "daemon/report/pdf.hpp"

namespace sweepd {

int make_report(const ReportOptions& options, std::ostream& out) {
  const auto facts = options.facts ? read_facts(*options.facts) : no_facts();
  std::vector<ReportFolder> folders;
  for (const auto& folder : options.folders) folders.push_back(read_report_folder(folder));
  const auto html_file = options.output.value_or(
      folders.size() == 1 ? options.folders.front() / kHtmlReport : kHtmlReport);
  std::vector<std::filesystem::path> inputs;
  if (options.facts) inputs.push_back(*options.facts);
  const Outputs outputs(std::move(inputs), options.force);
  outputs.check_made_again(html_file, kHtmlBegin);
  auto pdf_file = html_file;
  pdf_file.replace_extension("pdf");
  if (options.pdf) outputs.check_made_again(pdf_file, "%PDF");
  const std::string html = html_report(folders, facts);
  write_output(html_file, html);
  out << html_file.string() << '\n';
  if (!options.pdf) return 0;
  write_pdf(html, pdf_file);
  out << pdf_file.string() << '\n';
  return 0;
}

}  // namespace sweepd
