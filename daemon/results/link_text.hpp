#pragma once

#include <string>

#include "rsi/capture/conversation.hpp"
#include "rsi/link/link_report.hpp"

namespace sweepd {

/// The report on a link for a person in a terminal: the verdict with its reasons, then the figures,
/// lined up, with units, at most 80 columns.
[[nodiscard]] std::string link_text(const rsi::Conversation& conversation,
                                    const rsi::LinkReport& report);

}  // namespace sweepd
