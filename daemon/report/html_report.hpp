#pragma once

#include <span>
#include <string>
#include <string_view>

#include <pugixml.hpp>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_facts.hpp"
#include "daemon/report/report_folder.hpp"
#include "daemon/report/report_parts.hpp"

namespace sweepd {

/// The measurement report as one file of HTML: pictures and style within, no script, nothing from
/// elsewhere. Of several folders the ranges stand beside each other first, then what has changed
/// from one to the next, then each has its part.
/// The same files give the same bytes.
[[nodiscard]] std::string html_report(std::span<const ReportFolder> folders,
                                      const ReportFacts& facts = no_facts(),
                                      std::span<const Comparison> comparisons = {});

/// What it begins with.
inline constexpr std::string_view kHtmlBegin =
    "<!DOCTYPE html>\n<!-- sweepd measurement report -->\n";

/// The head of a page in the style of the reports, and its main part, to be filled. Pictures and
/// style are within, no script, nothing from elsewhere.
[[nodiscard]] Markup begin_page(pugi::xml_document& document, const std::string& title);

}  // namespace sweepd
