#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace sweepd {

/// Prints a page of HTML into a PDF by Debian's Chromium, which is no part of sweepd: fonts are
/// embedded, and pages have numbers. Throws std::runtime_error where there is no Chromium, or where
/// it does not do it in `patience`.
void write_pdf(const std::string& html, const std::filesystem::path& pdf,
               std::chrono::seconds patience = std::chrono::seconds(120));

}  // namespace sweepd
