#pragma once

#include <filesystem>

#include "daemon/outcome.hpp"

namespace sweepd {

/// For results, with all folders above it; it may be there already. Throws std::runtime_error.
void make_folder(const std::filesystem::path& folder);

/// Writes result.json, dh.csv, sweeps.csv and report.txt into `folder`, which must exist, and where
/// the chain is complete robot.urdf, dh.tex and models.csv. Each file appears whole, and
/// result.json last: who sees it finds the others too. Throws std::runtime_error.
void write_result(const std::filesystem::path& folder, const Outcome& outcome);

}  // namespace sweepd
