#include <algorithm>
#include <array>
#include <utility>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/device_words.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

/// What stands in a name beside X, Y or Z and says nothing more.
constexpr std::array<std::string_view, 10> kBesideAxis{
    "coordinates", "coordinate", "coord", "position", "translation",
    "measured",    "actual",     "pos",   "meas",     "value"};

constexpr std::array<Words, 41> kWords{{
    {"q0", "rw"},
    {"q1", "rx"},
    {"q2", "ry"},
    {"q3", "rz"},
    {"qw", "rw"},
    {"qx", "rx"},
    {"qy", "ry"},
    {"qz", "rz"},
    {"time", "time"},
    {"date", "time"},
    {"datetime", "time"},
    {"timeofday", "time"},
    {"measurementtime", "time"},
    {"seconds", "time"},
    {"elapsedtime", "time"},
    {"name", "name"},
    {"point", "name"},
    {"pointname", "name"},
    {"pointid", "name"},
    {"pointnumber", "name"},
    {"id", "name"},
    {"target", "name"},
    {"targetname", "name"},
    {"label", "name"},
    {"feature", "name"},
    {"featurename", "name"},
    {"object", "name"},
    {"objectname", "name"},
    {"no", "name"},
    {"nr", "name"},
    {"number", "name"},
    {"index", "name"},
    {"measurement", "name"},
    {"group", "group"},
    {"groupname", "group"},
    {"pointgroup", "group"},
    {"pointgroupname", "group"},
    {"collection", "collection"},
    {"collectionname", "collection"},
    {"reflector", "target"},
    {"probe", "target"},
}};

bool is_unit(std::string_view text) {
  return length_unit_mm(text) > 0 || time_unit_s(text) > 0;
}

/// Takes what stands in brackets off a name, the first of them.
std::string take_brackets(std::string& name) {
  const auto bracket = name.find_first_of("([");
  if (bracket == std::string::npos) return {};
  const auto end = std::min(name.find_first_of(")]", bracket), name.size());
  std::string inside(rsi::trimmed(std::string_view(name).substr(bracket + 1, end - bracket - 1)));
  name.erase(bracket, end + 1 - bracket);
  return inside;
}

/// Takes the unit off a name in lower case: in brackets, or the last word. What stands behind
/// brackets is of the name: "x [mm] nominal" is no measured one.
std::string take_unit(std::string& name) {
  if (name.find_first_of("([") != std::string::npos) {
    std::string unit = take_brackets(name);
    while (name.find_first_of("([") != std::string::npos) take_brackets(name);
    return unit;
  }
  const auto last = name.find_last_of(" _/");
  if (last == std::string::npos || !is_unit(std::string_view(name).substr(last + 1))) return {};
  std::string unit = name.substr(last + 1);
  name.erase(last);
  return unit;
}

bool take_word(std::string& name, std::string_view word) {
  const auto at = name.find(word);
  if (at == std::string::npos) return false;
  name.erase(at, word.size());
  return true;
}

}  // namespace

ColumnName column_name(std::string_view text) {
  std::string name = lower(rsi::trimmed(text));
  std::string unit = take_unit(name);
  std::erase_if(
      name, [](char c) { return std::string_view(" _-.:/#").find(c) != std::string_view::npos; });
  if (take_word(name, "quaternion") || take_word(name, "quat")) name = "q" + name;
  for (const auto& [word, value] : kWords)
    if (name == word) return {std::string(value), unit};
  if (name.find("timestamp") != std::string::npos) return {"time", unit};
  for (const auto word : kBesideAxis) take_word(name, word);
  if (name == "x" || name == "y" || name == "z") return {name, unit};
  return {{}, unit};
}

bool names_joint(std::string_view text) {
  const std::string name = lower(rsi::trimmed(text));
  if (name == "joint") return true;
  if (!name.starts_with('a')) return false;
  const auto unit = std::min(name.find_first_of("_ [("), name.size());
  if (!rsi::all_digits(std::string_view(name).substr(1, unit - 1))) return false;
  const auto told = name.substr(unit);
  return told.empty() || std::ranges::any_of(std::array{"deg", "rad", "mm"}, [&](auto one) {
           return told.find(one) != std::string::npos;
         });
}

double time_unit_s(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, double>, 10> kUnits{
      {{"s", 1},
       {"sec", 1},
       {"second", 1},
       {"seconds", 1},
       {"ms", 1e-3},
       {"msec", 1e-3},
       {"us", 1e-6},
       {"\xc2\xb5s", 1e-6},  // the micro sign
       {"\xce\xbcs", 1e-6},  // the Greek letter
       {"ns", 1e-9}}};
  for (const auto& [unit, seconds] : kUnits)
    if (rsi::equal_ignoring_case(name, unit)) return seconds;
  return 0;
}

double time_unit_of_count_s(double first) {
  return first > 1e17 ? 1e-9 : first > 1e14 ? 1e-6 : first > 1e11 ? 1e-3 : 1;
}

}  // namespace sweepd
