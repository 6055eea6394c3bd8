
#include "daemon/report/file_parts.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

double value(const Json& json) {
  return json.is_number() ? json.get<double>() : kNothing;
}

}  // namespace

const Json& part_of(const Json& json, const std::string& key) {
  static const Json kNull;
  if (!json.is_object()) return kNull;
  const auto found = json.find(key);
  return found == json.end() ? kNull : *found;
}

const Json& list_of(const Json& json, const std::string& key) {
  static const Json kEmpty = Json::array();
  const Json& found = part_of(json, key);
  return found.is_array() ? found : kEmpty;
}

double number_of(const Json& json, const std::string& key) {
  return value(part_of(json, key));
}

std::string text_of(const Json& json, const std::string& key) {
  const Json& found = part_of(json, key);
  return found.is_string() ? found.get<std::string>() : std::string();
}

bool flag_of(const Json& json, const std::string& key) {
  const Json& found = part_of(json, key);
  return found.is_boolean() && found.get<bool>();
}

bool is_linear(const Json& joint) {
  return text_of(joint, "type") == "linear";
}

Eigen::Vector3d vector_of(const Json& json) {
  Eigen::Vector3d vector = Eigen::Vector3d::Constant(kNothing);
  if (!json.is_array() || json.size() != 3) return vector;
  Eigen::Index k = 0;
  for (const Json& item : json) vector(k++) = value(item);
  return vector;
}

}  // namespace sweepd
