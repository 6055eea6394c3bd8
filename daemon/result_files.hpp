#pragma once

#include <filesystem>

#include "daemon/outcome.hpp"

namespace sweepd {

/// Writes result.json, dh.csv, sweeps.csv and report.txt into `folder`, which must exist, and where
/// the chain is complete robot.urdf, dh.tex and models.csv. Each file appears whole, and
/// result.json last: who sees it finds the others too. Throws std::runtime_error.
void write_result(const std::filesystem::path& folder, const Outcome& outcome);

}  // namespace sweepd
