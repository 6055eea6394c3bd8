#include "daemon/report/html_report.hpp"

#include "daemon/report/annex.hpp"
#include "daemon/report/axes_figure.hpp"
#include "daemon/report/circle_figures.hpp"
#include "daemon/report/currents_figure.hpp"
#include "daemon/report/curve_figures.hpp"
#include "daemon/report/displacement_figure.hpp"
#include "daemon/report/first_page.hpp"
#include "daemon/report/poses_part.hpp"
#include "daemon/report/range_figure.hpp"
#include "daemon/report/report_page.hpp"

namespace sweepd {
namespace {

/// A part of the report, if there is anything in it.
template <typename Fill>
void add_part(Markup body, const char* id, const char* title, const Fill& fill) {
  auto part = body.add("section", {{"id", id}});
  part.put("h2", title);
  fill(part);
  if (part.size() == 1) body.drop(part);
}

void add_folder(Markup body, const ReportFolder& folder, const ReportFacts& facts, bool alone) {
  add_first_page(body, folder, facts);
  add_part(body, "motions", "The motions", [&](Markup part) {
    add_axes_figure(part, folder);
    if (alone) add_range_figure(part, std::span(&folder, 1));
  });
  add_part(body, "circles", "The circles", [&](Markup part) { add_circle_figures(part, folder); });
  add_part(body, "poses", "The static poses", [&](Markup part) {
    add_poses(part, folder);
    add_displacement(part, folder);
  });
  add_part(body, "residuals", "What is left",
           [&](Markup part) { add_residual_figures(part, folder); });
  add_part(body, "currents", "The motors", [&](Markup part) { add_currents(part, folder); });
  add_part(body, "uncertainty", "Uncertainty, link and time", [&](Markup part) {
    add_budget_figure(part, folder);
    add_link_figure(part, folder);
    add_time_figure(part, folder);
  });
  add_part(body, "annex", "Annex", [&](Markup part) { add_annex(part, folder); });
}

}  // namespace

std::string html_report(std::span<const ReportFolder> folders, const ReportFacts& facts,
                        std::span<const Comparison> comparisons) {
  pugi::xml_document document;
  std::string title = "Measurement report";
  if (!folders.empty()) title += ": " + text_of(folders.front().result, "robot");
  auto body = begin_page(document, title);
  if (folders.size() > 1) {
    body.put("h2", "Side by side", {{"class", "stays"}});
    add_range_figure(body, folders);
    add_part(body, "changes", "What has changed",
             [&](Markup part) { add_changes(part, comparisons); });
  }
  for (const ReportFolder& folder : folders) add_folder(body, folder, facts, folders.size() == 1);
  return std::string(kHtmlBegin) + html_text(document);
}

}  // namespace sweepd
