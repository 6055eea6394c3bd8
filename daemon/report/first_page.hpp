#pragma once

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_facts.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// What somebody reads who reads one page: a sentence of verdict, what the numbers describe, what
/// contradicts, facts, the DH table.
void add_first_page(Markup parent, const ReportFolder& folder, const ReportFacts& facts);

/// One sentence: how far the result goes.
[[nodiscard]] std::string verdict_sentence(const ReportFolder& folder);

}  // namespace sweepd
