#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_facts.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// What somebody reads who reads one page: a sentence of verdict, what the numbers describe, what
/// contradicts, facts, the DH table.
void add_first_page(Markup parent, const ReportFolder& folder, const ReportFacts& facts);

/// One sentence: how far the result goes.
[[nodiscard]] std::string verdict_sentence(const ReportFolder& folder);

/// What static poses told: what is left at each level of correction, drawn and as a table, and what
/// joints do beside their angles. Nothing where the result has no poses.
void add_poses(Markup parent, const ReportFolder& folder);

/// Two results of a report beside each other.
struct Comparison {
  std::string first, second;      ///< names of their folders
  nlohmann::ordered_json change;  ///< sweepd.compare/1; null where they cannot be compared
  std::string why_not;            ///< then
};

/// What has changed from each first to its second, or why nobody can tell.
void add_changes(Markup parent, std::span<const Comparison> comparisons);

/// What somebody needs who checks the report: all numbers of dh.csv as they stand there, all forms
/// of the arm, the program, the inputs with their hashes, and the command that makes it again.
void add_annex(Markup parent, const ReportFolder& folder);

}  // namespace sweepd
