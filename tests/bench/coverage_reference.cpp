#include "tests/bench/coverage_reference.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>

#include "daemon/text/numbers.hpp"

namespace coverage {
namespace {

constexpr std::string_view kBefore = "# Errors of the estimator of commit ";
constexpr std::string_view kColumns = "case,arm,arc_deg,samples,runs,a_mm,b_mm,alpha_deg,theta_deg";

}  // namespace

const Reference::Line* Reference::find(const Cell& cell) const {
  const auto line = std::find_if(lines.begin(), lines.end(),
                                 [&](const Line& known) { return known.cell == cell; });
  return line == lines.end() ? nullptr : &*line;
}

Reference read_reference(const std::string& path) {
  Reference reference;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    if (text.starts_with(kBefore))
      reference.commit = text.substr(kBefore.size(), text.find(':') - kBefore.size());
    if (text.starts_with('#') || text == kColumns) continue;
    std::istringstream words(text);
    std::vector<std::string> fields;
    for (std::string field; std::getline(words, field, ',');) fields.push_back(field);
    fields.resize(9);
    Reference::Line line{{fields[0], fields[1], std::stoi(fields[2]), std::stoi(fields[3])},
                         std::stoul(fields[4]),
                         {}};
    for (std::size_t k = 0; k < line.errors.rms.size(); ++k)
      if (!fields[5 + k].empty()) line.errors.rms[k] = std::stod(fields[5 + k]);
    reference.lines.push_back(line);
  }
  return reference;
}

bool write_reference(const std::string& path, const Reference& reference) {
  std::ofstream file(path);
  file << kBefore << reference.commit
       << ":\n# scripts/bench coverage --record COMMIT. Root mean squares over the runs, medians "
          "over "
          "the arm's numbers.\n"
       << kColumns << "\n";
  for (const Reference::Line& line : reference.lines) {
    file << line.cell.what << ',' << line.cell.arm << ',' << line.cell.arc_deg << ','
         << line.cell.samples << ',' << line.runs;
    for (const auto& rms : line.errors.rms) file << ',' << (rms ? sweepd::fixed(*rms, 9) : "");
    file << '\n';
  }
  return file.flush().good();
}

}  // namespace coverage
