#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace sweepd {

// JSON as it is written. Bytes that are no UTF-8, as names of files may have, are replaced.

/// A file of its own.
[[nodiscard]] inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}
/// One line, without its end.
[[nodiscard]] inline std::string json_line(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sweepd
