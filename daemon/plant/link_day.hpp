#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace sweepd {

/// The columns of link_days that are counted, in the order of LinkCounters.
inline constexpr std::array<std::string_view, 8> kLinkColumns = {
    "received", "lost", "duplicated", "reordered", "malformed", "late", "unanswered", "superseded"};

/// What one sweepd counted of a robot's link since it was started.
struct LinkCounters {
  std::string started;  ///< of sweepd, in UTC: others count from zero
  std::array<std::int64_t, kLinkColumns.size()> counts{};
};

/// What a robot's `state` topic tells of its link.
struct ToldLink {
  std::string at;   ///< in UTC, by the publisher's clock
  std::string day;  ///< of that, 2026-11-23
  LinkCounters counters;
  std::string stream_since = {};              ///< its first day; empty: none streams
  std::optional<double> max_latency_us = {};  ///< of the stream, over all of its days
};
[[nodiscard]] std::optional<ToldLink> link_told(const nlohmann::ordered_json& state);

/// What was counted between two states; nothing where the second is no later one: told twice, or
/// come late. A sweepd that started anew has counted all of it; one that started earlier is told
/// late, unless the clock was wrong then: what started before is in the future of this state.
[[nodiscard]] std::optional<LinkCounters> counted_since(const std::optional<LinkCounters>& before,
                                                        const ToldLink& told);

}  // namespace sweepd
