#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "rsi/datagram.hpp"

namespace sweepd {

/// Captures in the order in which they were recorded. Throws rsi::CaptureError, also of a pipe, as
/// they are read more than once, and of one that is given twice.
[[nodiscard]] std::vector<std::filesystem::path> traces_in_order(
    const std::vector<std::filesystem::path>& traces);

/// Reads captures one after the other, with progress for `command` on a terminal unless `quiet`;
/// what is wrong with a capture is said on `errors`. Throws rsi::CaptureError, and what
/// `on_datagram` throws.
void read_traces(const std::vector<std::filesystem::path>& traces, const std::string& command,
                 bool quiet, std::ostream& errors,
                 const std::function<void(const rsi::Datagram&)>& on_datagram);

}  // namespace sweepd
