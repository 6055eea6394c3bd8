#pragma once

#include <filesystem>
#include <vector>

namespace rsi {

/// The captures of one stream in the order of their first datagrams, however a shell has put their
/// names: "trace*.pcap" has trace-0002.pcap before trace.pcap. One alone is not opened, and one
/// without datagrams goes to the end. Throws CaptureError.
[[nodiscard]] std::vector<std::filesystem::path> in_order_of_time(
    const std::vector<std::filesystem::path>& captures);

}  // namespace rsi
