#include "daemon/report/json_part.hpp"

#include <limits>

namespace sweepd {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double value(const Json& json) {
  return json.is_number() ? json.get<double>() : kNothing;
}

}  // namespace

const Json& part(const Json& json, const std::string& key) {
  static const Json kNull;
  if (!json.is_object()) return kNull;
  const auto found = json.find(key);
  return found == json.end() ? kNull : *found;
}

const Json& list(const Json& json, const std::string& key) {
  static const Json kEmpty = Json::array();
  const Json& found = part(json, key);
  return found.is_array() ? found : kEmpty;
}

double number(const Json& json, const std::string& key) {
  return value(part(json, key));
}

std::string words(const Json& json, const std::string& key) {
  const Json& found = part(json, key);
  return found.is_string() ? found.get<std::string>() : std::string();
}

bool flag(const Json& json, const std::string& key) {
  const Json& found = part(json, key);
  return found.is_boolean() && found.get<bool>();
}

Eigen::Vector3d vector_of(const Json& json) {
  Eigen::Vector3d vector = Eigen::Vector3d::Constant(kNothing);
  if (!json.is_array() || json.size() != 3) return vector;
  Eigen::Index k = 0;
  for (const Json& item : json) vector(k++) = value(item);
  return vector;
}

}  // namespace sweepd
