#pragma once

#include <string>
#include <string_view>

#include "rsi/capture/conversation.hpp"
#include "rsi/link/link_report.hpp"

namespace sweepd {

/// What every link_json() begins with.
inline constexpr std::string_view kLinkJsonBegins = "{\n  \"schema\": \"sweepd.link/1\"";

/// The report on a link, schema sweepd.link/1. Units stand in the names; `at_s` is the time since
/// the first telegram. "replies" and "latency" are absent where no reply was seen, "cycle_ms" and
/// "jitter" before two telegrams came; what only the controller's Delay tells is null where it
/// sends none. Fields may be added.
[[nodiscard]] std::string link_json(const rsi::Conversation& conversation,
                                    const rsi::LinkReport& report);

}  // namespace sweepd
