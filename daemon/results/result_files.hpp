#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "daemon/results/outcome.hpp"

namespace sweepd {

/// For results, with all folders above it; it may be there already. Throws std::runtime_error.
void make_folder(const std::filesystem::path& folder);

/// Names of the files that write_result() writes, in its order: what matters most first, then what
/// is largest, what it takes away, and last the report, which is made of them.
[[nodiscard]] std::vector<std::string> result_file_names();

/// Writes the files of an outcome into `folder`, which must exist; robot.urdf, dh.tex and
/// models.csv only where the chain is complete. What other commands made of the result before is
/// removed. Each file appears whole. Those in `written` are
/// there already, and what is written now is added. A file that cannot be written keeps no other
/// from being written; at the end the first failure is thrown, a std::runtime_error.
void write_result(const std::filesystem::path& folder, const Outcome& outcome,
                  std::set<std::string>& written);
void write_result(const std::filesystem::path& folder, const Outcome& outcome);
/// What is of use while the session goes on: result.json and report.txt. The others cost more than
/// the identification, and grow with the session.
void write_interim_result(const std::filesystem::path& folder, const Outcome& outcome);

}  // namespace sweepd
