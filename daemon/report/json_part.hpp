#pragma once

#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace sweepd {

// Parts of JSON that another program may have written or shortened: what is missing, or is
// something else, is nothing, and never an error.

using Json = nlohmann::ordered_json;

/// What `json` has under `key`; null.
[[nodiscard]] const Json& part(const Json& json, const std::string& key);
/// An array; an empty one.
[[nodiscard]] const Json& list(const Json& json, const std::string& key);
/// A number; not a number.
[[nodiscard]] double number(const Json& json, const std::string& key);
/// A string; an empty one.
[[nodiscard]] std::string words(const Json& json, const std::string& key);
/// Whether there is a true.
[[nodiscard]] bool flag(const Json& json, const std::string& key);
/// Three numbers; not numbers.
[[nodiscard]] Eigen::Vector3d vector_of(const Json& json);

}  // namespace sweepd
