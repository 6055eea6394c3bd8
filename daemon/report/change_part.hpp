#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "daemon/drawing/markup.hpp"

namespace sweepd {

/// Two results of a report beside each other.
struct Comparison {
  std::string first, second;      ///< names of their folders
  nlohmann::ordered_json change;  ///< sweepd.compare/1; null where they cannot be compared
  std::string why_not;            ///< then
};

/// What has changed from each first to its second, or why nobody can tell.
void add_changes(Markup parent, std::span<const Comparison> comparisons);

}  // namespace sweepd
