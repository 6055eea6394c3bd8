#include "daemon/report/html_report.hpp"

#include "daemon/drawing/picture.hpp"
#include "daemon/report/figures.hpp"
#include "daemon/report/report_parts.hpp"

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

/// Paper is white; a screen as its user wishes. No `>`: pugixml would escape it.
constexpr const char* kStyle =
    ":root{color-scheme:light dark}"
    "body{font:14px/1.4 sans-serif;max-width:780px;margin:1.5em auto;padding:0 16px;"
    "color:#1a1a1a;background:#fff}"
    "h1{margin:0 0 .3em;font-size:28px}h2{margin:1.6em 0 .4em;font-size:20px}"
    "h3{margin:1.2em 0 .3em;font-size:15px}"
    ".kind{margin:0;letter-spacing:.06em;text-transform:uppercase;font-size:12px;color:#555}"
    ".verdict{font-size:16px;border-left:6px solid #009e73;padding:.4em .8em;margin:.6em 0}"
    ".verdict.partial{border-color:#e69f00}.verdict.doubtful,.verdict.failed{border-color:#d55e00}"
    ".verdict b{text-transform:capitalize}"
    "table{border-collapse:collapse;margin:.6em 0 1em;font-size:12px}"
    "caption{text-align:left;caption-side:top;padding-bottom:.4em;color:#444}"
    "th,td{text-align:left;padding:1px 8px 1px 0;vertical-align:top}"
    "thead th{border-bottom:1px solid #888;font-weight:600}"
    ".number{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}"
    "td.number{white-space:pre}.vector{font-family:monospace}.dh .first th,.dh .first "
    "td{border-top:1px solid #ccc}"
    ".dh{width:100%}.dh thead th{white-space:nowrap}.interval svg{display:block}"
    ".dh td.symbol{font-style:italic}"
    ".facts{columns:2;column-gap:2em;font-size:12px}.facts p{margin:0 0 .2em;break-inside:avoid}"
    ".facts span{color:#444;margin-right:.6em}.facts bdi{overflow-wrap:anywhere}"
    ".given{font-style:italic}.missing{font-style:italic;color:#666}"
    ".note,.messages{font-size:12px}.messages ul{margin:.2em 0;padding-left:1.3em}"
    "figure{margin:1.2em 0 1.6em}figcaption{font-size:12px;margin-bottom:.6em}"
    "figure svg{display:block;margin-bottom:6px}figure table{min-width:400px}"
    ".all{font-size:9.5px}.all th,.all td{padding-right:6px}.fine{font-size:9.5px;margin:.2em 0}"
    ".hash{font:9px monospace;overflow-wrap:anywhere}"
    "pre{white-space:pre-wrap;overflow-wrap:anywhere;font-size:12px;background:#0001;padding:.6em}"
    "code{font-size:10px;color:#555}"
    "@media screen and (prefers-color-scheme:dark){body{color:#e6e6e6;background:#16181b}"
    ".kind,caption,.facts span,.missing,code{color:#b5b5b5}"
    ".dh .first th,.dh .first td{border-color:#444}}"
    "@media screen and (max-width:640px){.facts{columns:1}table{display:block;overflow-x:auto}"
    "caption{display:block;position:sticky;left:0;max-width:calc(100vw - 3em)}"
    "figure{overflow-x:auto}figure svg{max-width:none}}"
    "@page{size:A4;margin:16mm 15mm 18mm;"
    "@bottom-left{content:'sweepd measurement report';font:8pt sans-serif;color:#555}"
    "@bottom-right{content:counter(page) ' / ' counter(pages);font:8pt sans-serif;color:#555}}"
    "@media print{:root{color-scheme:light}body{margin:0;padding:0;max-width:none;font-size:10pt}"
    "h2,.front{break-before:page}main "
    ".front:first-child{break-before:auto}h2.stays{break-before:auto}h2,h3,figcaption,caption{"
    "break-after:avoid}"
    "figure,figcaption,figure svg,tr,.messages{break-inside:avoid}figure.long{break-inside:auto}"
    "thead{display:table-header-group}"
    ".dh th,.dh td{padding-top:0;padding-bottom:0}}";

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

Markup begin_page(pugi::xml_document& document, const std::string& title) {
  auto html = Markup(document.root()).add("html", {{"lang", "en"}});
  auto head = html.add("head");
  head.add("meta", {{"charset", "utf-8"}});
  head.add("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}});
  head.add("meta", {{"http-equiv", "Content-Security-Policy"},
                    {"content", "default-src 'none'; style-src 'unsafe-inline'"}});
  head.put("title", title);
  head.put("style", kStyle + drawing_style());
  return html.add("body").add("main");
}

}  // namespace sweepd
