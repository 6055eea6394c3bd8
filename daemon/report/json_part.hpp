#pragma once

#include <limits>
#include <string>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace sweepd {

// Parts of JSON that another program may have written or shortened: what is missing, or is
// something else, is nothing, and never an error.

/// Not a number.
inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// What `json` has under `key`; null.
[[nodiscard]] const nlohmann::ordered_json& part_of(const nlohmann::ordered_json& json,
                                                    const std::string& key);
/// An array; an empty one.
[[nodiscard]] const nlohmann::ordered_json& list_of(const nlohmann::ordered_json& json,
                                                    const std::string& key);
/// A number; not a number.
[[nodiscard]] double number_of(const nlohmann::ordered_json& json, const std::string& key);
/// A string; an empty one.
[[nodiscard]] std::string text_of(const nlohmann::ordered_json& json, const std::string& key);
/// Whether there is a true.
[[nodiscard]] bool flag_of(const nlohmann::ordered_json& json, const std::string& key);
/// Three numbers; not numbers.
[[nodiscard]] Eigen::Vector3d vector_of(const nlohmann::ordered_json& json);

}  // namespace sweepd
