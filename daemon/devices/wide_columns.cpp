#include "daemon/devices/wide_columns.hpp"

#include <algorithm>
#include <utility>

#include "daemon/devices/device_text.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {

std::optional<std::size_t> WideTarget::column(std::string_view value) const {
  const auto found = columns_.find(value);
  return found == columns_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::vector<std::size_t>> WideTarget::all(
    std::initializer_list<std::string_view> values) const {
  std::vector<std::size_t> columns;
  for (const auto value : values) {
    const auto one = column(value);
    if (!one) return std::nullopt;
    columns.push_back(*one);
  }
  return columns;
}

std::optional<RotationColumns> WideTarget::quaternion() const {
  const auto columns = all({"rx", "ry", "rz", "rw"});
  if (!columns) return std::nullopt;
  return RotationColumns{RotationColumns::Kind::quaternion, *columns};
}

std::optional<RotationColumns> WideTarget::euler(std::string_view order, double unit_rad) const {
  if (order.size() != 3 || order.find_first_not_of("XYZ") != std::string_view::npos)
    return std::nullopt;
  RotationColumns rotation{RotationColumns::Kind::euler, {}, unit_rad};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto one = column(std::string("r") + rsi::lower(order[k]));
    if (!one) return std::nullopt;
    rotation.columns.push_back(*one);
    rotation.order[k] = order[k] - 'X';
  }
  return rotation;
}

void WideTargets::add(const std::string& name, const WideTarget& columns,
                      std::optional<RotationColumns> rotation, std::optional<std::size_t> state) {
  if (std::any_of(targets_.begin(), targets_.end(),
                  [&](const TargetColumns& other) { return other.name == name; }))
    text_.fail(header_, "expected each target once, found " + as_found(name) +
                            " a second time: rename one of the two in the device's program");
  const auto position = columns.all({"x", "y", "z"});
  if (!position)
    text_.fail(header_, "expected columns X, Y and Z of " + as_found(name) +
                            ", found not all of them: export the file again");
  targets_.push_back(
      {name, {(*position)[0], (*position)[1], (*position)[2]}, std::move(rotation), state});
}

void WideTargets::leave_out(const std::string& what, const std::string& why) {
  auto& all = left_out_[why];
  if (std::find(all.begin(), all.end(), what) == all.end()) all.push_back(what);
}

void WideTargets::into(DeviceLayout& layout) && {
  if (targets_.empty())
    text_.fail(header_,
               "expected columns with the position of a marker or a body, found none: export the "
               "file again with markers or rigid bodies");
  layout.targets = std::move(targets_);
  constexpr std::size_t kMostNamed = 4;
  for (const auto& [why, all] : left_out_) {
    std::string note = "left out: ";
    for (std::size_t k = 0; k < std::min(all.size(), kMostNamed); ++k)
      note.append(k > 0 ? ", " : "").append(rsi::in_short(all[k]));
    if (all.size() > kMostNamed)
      note.append(" and ").append(std::to_string(all.size() - kMostNamed)).append(" more");
    layout.notes.push_back(why.empty() ? note : note.append(" (").append(why).append(")"));
  }
}

}  // namespace sweepd
