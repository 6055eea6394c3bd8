#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/drawing/markup.hpp"
#include "daemon/report/report_folder.hpp"

namespace sweepd {

/// One number of the DH table, in mm or degrees.
struct DhLine {
  std::size_t joint = 0;  ///< from 1
  std::string symbol;     ///< of the paper: b, θ, a, α; and β where axes are parallel
  std::string unit;
  std::optional<double> identified;
  std::optional<double> sigma;  ///< standard uncertainty
  std::optional<double> specified;
  std::optional<double> difference;
  bool by_convention = false;
  std::string relation = {};  ///< of the joint's axis to the next one
};

/// All numbers of the result, joint by joint; identified angles in the turn of the specified ones.
[[nodiscard]] std::vector<DhLine> dh_lines(const ReportFolder& folder);

/// How many identified numbers differ from the specification by more than U, and how many could.
struct Departures {
  std::size_t numbers = 0;
  std::size_t beyond = 0;
  std::optional<DhLine> largest;  ///< by its own uncertainty, of those beyond
};
[[nodiscard]] Departures departures(const std::vector<DhLine>& lines);

/// A value with decimals enough for the second digit of its expanded uncertainty.
[[nodiscard]] std::string told(double value, const DhLine& line);

/// The table of the first page, each difference drawn as an interval against zero.
void add_dh_table(Markup parent, const std::vector<DhLine>& lines);

}  // namespace sweepd
