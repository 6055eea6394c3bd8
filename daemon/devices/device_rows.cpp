#include "daemon/devices/device_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/device_words.hpp"
#include "daemon/text/units.hpp"
#include "identify/sweeps/sample.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

/// NDI writes less where nothing was measured.
constexpr double kNotMeasured = -1e20;
/// A quaternion or matrix is printed to three decimals at least.
constexpr double kFarFromRotation = 0.02;

bool is_missing(std::string_view text) {
  if (text.empty()) return true;
  if (text.size() > 9) return false;
  static constexpr std::array<std::string_view, 10> kNothing{
      {"nan", "-nan", "null", "na", "n/a", "none", "-nan(ind)", "nan(ind)", "1.#qnan", "-1.#ind"}};
  return text.find_first_not_of('-') == std::string_view::npos ||
         std::any_of(kNothing.begin(), kNothing.end(),
                     [&](std::string_view word) { return rsi::equal_ignoring_case(text, word); });
}

std::optional<std::int64_t> whole(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  // The difference of two of them is one too.
  constexpr std::int64_t kMost = 4'000'000'000'000'000'000;
  if (error != std::errc() || end != text.data() + text.size() || value < -kMost || value > kMost)
    return std::nullopt;
  return value;
}

}  // namespace

DeviceRows::DeviceRows(const DeviceText& text, const DeviceLayout& layout, std::size_t joints)
    : text_(text),
      layout_(layout),
      joints_(joints),
      header_(layout.has_names ? fields_of(text.line(layout.header), layout.separator) : Fields()),
      line_(layout.begin),
      next_(layout.begin) {}

bool DeviceRows::next() {
  for (; next_ < layout_.end && text_.is_passed_over(next_); ++next_) pass_over(text_.line(next_));
  if (next_ >= layout_.end) {
    check_thousands();
    return false;
  }
  line_ = next_++;
  fields_ = fields_of(text_.line(line_), layout_.separator);
  while (fields_.size() > layout_.columns && fields_.back().empty()) fields_.pop_back();
  const bool is_last = line_ + 1 == text_.lines() && text_.is_open();
  if (fields_.size() > layout_.columns ||
      (fields_.size() < layout_.columns && (is_last || !layout_.lines_may_be_short)))
    text_.fail(line_, fmt::format("expected {}, as line {} tells, found {}: {}",
                                  rsi::counted(layout_.columns, "column"), layout_.header + 1,
                                  fields_.size(),
                                  is_last ? "the file is cut, copy or export it again"
                                          : "correct the line, or export the file again"));
  if (is_last) check_end();
  read_time();
  if (!(std::abs(time_s_) <= kLargestMeasured))
    fail_time("expected a measured time, found one that is too far from the first: correct it");
  read_joint();
  seen_.clear();
  for (const TargetColumns& target : layout_.targets)
    if (auto one = measured(target)) seen_.push_back(std::move(*one));
  ++rows_;
  return true;
}

void DeviceRows::pass_over(std::string_view line) {
  if (line.empty()) return;
  // Where lines tell the time, a frame in which no target was seen is one.
  const bool is_row = line.find_first_not_of(",;\t ") == std::string_view::npos;
  if (!is_row) ++comments_;
  if (is_row && layout_.time.kind == TimeColumns::Kind::lines) ++rows_;
}

/// A file that was cut may end within a number, which is another number then.
void DeviceRows::check_end() const {
  const auto last = fields_.size() - 1;
  if (rows_ == 0)
    fail(last,
         "expected the end of the line, found the end of the file: the file is cut, copy or "
         "export it again");
  std::size_t before = line_ - 1;
  while (text_.is_passed_over(before)) --before;
  const auto fields = fields_of(text_.line(before), layout_.separator);
  if (fields.size() <= last) return;
  const auto decimals = [](std::string_view field) {
    const auto mark = field.find_last_of(".,");
    return mark == std::string_view::npos ? 0 : field.size() - mark - 1;
  };
  const auto is_number = [](std::string_view field) {
    return !field.empty() && rsi::is_digit(field.back());
  };
  if (is_number(fields[last]) && decimals(fields_[last]) < decimals(fields[last]))
    fail(last, fmt::format("expected {} decimals and the end of the line, found {} and the end of "
                           "the file: the file is cut, copy or export it again",
                           decimals(fields[last]), as_found(fields_[last])));
}

/// 1,234 is a number with three decimals, or a whole one above a thousand. Where every number with
/// a sign may be one above a thousand, and positions below it have no sign, nothing tells which.
void DeviceRows::check_thousands() {
  if (!grouped_ || is_decimal_ || !is_whole_) return;
  line_ = grouped_->line;
  fail(
      grouped_->column,
      fmt::format("expected decimals or whole numbers, found {}, which may be either, as positions "
                  "without a sign stand beside it: export the file with the same decimals in all "
                  "numbers, and nothing between thousands",
                  as_found(grouped_->text)));
}

void DeviceRows::note_sign(std::size_t column, std::string_view text) {
  const bool has_sign = text.find_first_of(".,") != std::string_view::npos;
  if (has_sign && !may_be_thousands(text)) is_decimal_ = true;
  if (!has_sign && text != "0") is_whole_ = true;
  if (has_sign && !grouped_) grouped_ = Grouped{line_, column, std::string(text)};
}

std::string_view DeviceRows::field(std::size_t column) const {
  return column < fields_.size() ? fields_[column] : std::string_view();
}

std::optional<rsi::Decimal> DeviceRows::decimal(std::size_t column) {
  return number(column, field(column));
}

std::optional<rsi::Decimal> DeviceRows::number(std::size_t column, std::string_view text) {
  if (is_missing(text)) return std::nullopt;
  std::string with_point;
  const auto at = text.find_first_of(".,");
  if (at != std::string_view::npos) {
    const char mark = text[at];
    if (text.find_first_of(".,", at + 1) != std::string_view::npos)
      fail(column, fmt::format("expected a number, found {}: export the file with one decimal sign "
                               "and nothing between thousands",
                               as_found(text)));
    if (mark_ == 0) {
      mark_ = mark;
      mark_line_ = line_;
    }
    if (mark != mark_)
      fail(column, fmt::format("expected a decimal {}, as in line {}, found {}: export the file "
                               "with one decimal sign and nothing between thousands",
                               mark_ == '.' ? "point" : "comma", mark_line_ + 1, as_found(text)));
    if (mark == ',') {
      with_point = text;
      with_point[at] = '.';
      text = with_point;
    }
  }
  const auto value = printed_number(text.starts_with('+') ? text.substr(1) : text);
  if (!value)
    fail(column, "expected a number, found " + as_found(field(column)) +
                     (may_be_thousands(field(column))
                          ? ": export the file with nothing between thousands"
                          : ": correct it, or leave it empty if the value is missing"));
  if (layout_.minus_huge_is_missing && value->value < kNotMeasured) return std::nullopt;
  if (std::abs(value->value) > kLargestMeasured)
    fail(column, "expected a measured number, found " + as_found(field(column)) + ": correct it");
  return value;
}

std::optional<DeviceRows::Seen> DeviceRows::measured(const TargetColumns& target) {
  constexpr int kFullPrecision = 10;
  if (target.state && !rsi::equal_ignoring_case(field(*target.state), "OK")) return std::nullopt;
  Seen seen;
  int decimals = 0;
  bool is_complete = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = decimal(target.position[k]);
    is_complete = is_complete && value;
    if (!value) continue;
    if (!is_decimal_) note_sign(target.position[k], field(target.position[k]));
    seen.position_mm(static_cast<Eigen::Index>(k)) = value->value * layout_.unit_mm;
    decimals = std::max(decimals, value->decimals);
  }
  if (!is_complete || (layout_.zero_is_missing && seen.position_mm.isZero(0))) return std::nullopt;
  seen.step_mm = decimals >= kFullPrecision ? 0 : layout_.unit_mm * std::pow(10.0, -decimals);
  seen.target = static_cast<std::size_t>(&target - layout_.targets.data());
  seen.name = target_name(target);
  if (target.rotation) seen.rotation = rotation(*target.rotation);
  return seen;
}

std::optional<Eigen::Matrix3d> DeviceRows::rotation(const RotationColumns& columns) {
  std::vector<double> values;
  for (const std::size_t column : columns.columns)
    if (const auto value = decimal(column)) values.push_back(value->value * columns.unit_rad);
  if (values.size() < columns.columns.size()) return std::nullopt;
  // A body that was not seen.
  if (std::all_of(values.begin(), values.end(), [](double value) { return value == 0; }) &&
      columns.kind != RotationColumns::Kind::euler)
    return std::nullopt;
  const auto check = [&](double off) {
    if (!(off < kFarFromRotation))
      fail(columns.columns.front(),
           "expected a rotation, found numbers that are none: correct them, or leave them empty");
  };
  switch (columns.kind) {
    case RotationColumns::Kind::quaternion: {
      const Eigen::Quaterniond turned(values[3], values[0], values[1], values[2]);
      check(std::abs(turned.norm() - 1));
      return turned.normalized().toRotationMatrix();
    }
    case RotationColumns::Kind::matrix: {
      const Eigen::Matrix3d found =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
      check((found * found.transpose() - Eigen::Matrix3d::Identity()).norm());
      check(std::abs(found.determinant() - 1));
      return Eigen::Quaterniond(found).normalized().toRotationMatrix();
    }
    case RotationColumns::Kind::euler:
      break;
  }
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  for (std::size_t k = 0; k < 3; ++k)
    turned =
        turned * Eigen::AngleAxisd(values[k], Eigen::Vector3d::Unit(columns.order[k])).matrix();
  return turned;
}

std::string DeviceRows::target_name(const TargetColumns& target) const {
  std::string name = target.name;
  for (const std::size_t column : layout_.name)
    name.append(name.empty() ? "" : "::").append(field(column));
  return name;
}

void DeviceRows::read_time() {
  const TimeColumns& time = layout_.time;
  const auto fail_here = [&](std::size_t column, const char* expected) {
    fail(column, fmt::format("expected {}, found {}: correct it, or export the file again",
                             expected, as_found(field(column))));
  };
  double now_s = 0;
  switch (time.kind) {
    case TimeColumns::Kind::none:
    case TimeColumns::Kind::lines:
      time_s_ = static_cast<double>(rows_) * time.unit_s;
      return;
    case TimeColumns::Kind::number: {
      const auto found = std::find_if(time.columns.begin(), time.columns.end(),
                                      [&](std::size_t c) { return !is_missing(field(c)); });
      const std::size_t column = found == time.columns.end() ? time.columns.front() : *found;
      // Nanoseconds since 1970 have more digits than a double.
      if (const auto count = whole(field(column)); count && !first_s_) {
        if (!first_whole_) first_whole_ = count;
        time_s_ = static_cast<double>(*count - *first_whole_) * time.unit_s;
        return;
      }
      const auto value = number(column, field(column));
      if (!value) fail_here(column, "a time");
      now_s = value->value * time.unit_s;
      if (first_whole_) first_s_ = static_cast<double>(*first_whole_) * time.unit_s;
      break;
    }
    case TimeColumns::Kind::nanoseconds: {
      const auto seconds = whole(field(time.columns[0]));
      const auto parts = whole(field(time.columns[1]));
      if (!seconds) fail_here(time.columns[0], "whole seconds");
      if (!parts || *parts < 0 || *parts >= 1'000'000'000)
        fail_here(time.columns[1], "nanoseconds from 0 to 999999999");
      if (!first_whole_) first_whole_ = seconds;
      now_s = static_cast<double>(*seconds - *first_whole_) + static_cast<double>(*parts) * 1e-9;
      break;
    }
    case TimeColumns::Kind::date: {
      std::string text;
      for (const std::size_t column : time.columns) text += std::string(field(column)) + ' ';
      const auto date = seconds_of_date(text);
      if (!date) fail_here(time.columns.front(), "a date and a time of day");
      now_s = *date;
      break;
    }
  }
  if (!first_s_) first_s_ = now_s;
  time_s_ = now_s - *first_s_;
}

void DeviceRows::read_joint() {
  if (!layout_.joint) return;
  joint_ = joint_in(field(*layout_.joint));
  if (joint_ == 0 || joint_ > joints_)
    fail(*layout_.joint,
         fmt::format("expected the name of a joint from 1 to {}, found {}: correct it, or say with "
                     "--joints how many the arm has",
                     joints_, as_found(field(*layout_.joint))));
}

void DeviceRows::fail_time(const std::string& problem) const {
  if (layout_.time.columns.empty()) text_.fail(line_, problem);
  fail(layout_.time.columns.front(), problem);
}

void DeviceRows::fail(std::size_t column, const std::string& problem) const {
  std::string name(column < header_.size() ? header_[column] : std::string_view());
  for (const TargetColumns& target : layout_.targets)
    if (!target.name.empty() && std::count(target.position.begin(), target.position.end(), column))
      name = name.empty() || contains(name, lower(target.name))
                 ? target.name
                 : fmt::format("{} {}", target.name, name);
  text_.fail(line_, fmt::format("column {}{}: {}", column + 1,
                                name.empty() ? "" : " (" + rsi::in_short(name) + ")", problem));
}

std::size_t joint_in(std::string_view name) {
  const std::string text = lower(rsi::trimmed(name));
  const auto digits = text.find_first_of("0123456789");
  if (digits == std::string::npos) return 0;
  std::string_view word = std::string_view(text).substr(0, digits);
  while (!word.empty() && (word.back() == ' ' || word.back() == '_' || word.back() == '-'))
    word.remove_suffix(1);
  if (word != "joint" && word != "axis" && word != "j" && word != "a") return 0;
  const auto number = whole(std::string_view(text).substr(digits));
  const bool is_joint =
      number && *number >= 1 && *number <= static_cast<std::int64_t>(identify::kMostJoints);
  return is_joint ? static_cast<std::size_t>(*number) : 0;
}

}  // namespace sweepd
