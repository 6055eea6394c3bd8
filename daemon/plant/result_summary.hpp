#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "daemon/plant/outbox.hpp"
#include "daemon/plant/topics.hpp"

namespace sweepd {

/// What a dashboard wants of a result: JSON of some hundred bytes, schema sweepd.summary/1.
[[nodiscard]] std::string result_summary(const RobotPlace& place, const FinishedResult& result);

/// What `sweepd compare --json` prints of the result in a folder before and this one; nothing, and
/// why, where the two cannot be compared.
struct SummaryOfChange {
  std::optional<std::string> json;
  std::string why_not;
};
[[nodiscard]] SummaryOfChange change_since(const std::filesystem::path& before,
                                           const FinishedResult& result);

}  // namespace sweepd
