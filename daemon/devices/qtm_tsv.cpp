#include <algorithm>
#include <array>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "daemon/devices/device_text.hpp"
#include "daemon/devices/maker_formats.hpp"
#include "daemon/devices/wide_columns.hpp"
#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

constexpr std::size_t kColumnsOfMarker = 3;
constexpr std::size_t kColumnsOfBody = 16;  // X Y Z, roll pitch yaw, residual, nine of the matrix

bool is_key(std::string_view word) {
  return word.size() > 3 &&
         word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") ==
             std::string_view::npos &&
         !rsi::is_digit(word.front());
}

std::string_view key_of(std::string_view line) {
  return rsi::trimmed(line.substr(0, line.find('\t')));
}

/// The values behind a name of the header; nothing where it is not there. Empty ones at the end
/// are no values.
std::optional<Fields> header_values(const DeviceText& text, std::size_t end, std::string_view key) {
  for (std::size_t line = 0; line < end; ++line) {
    if (key_of(text.line(line)) != key) continue;
    auto fields = fields_of(text.line(line), '\t');
    fields.erase(fields.begin());
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
    return fields;
  }
  return std::nullopt;
}

bool is_number(std::string_view field) {
  std::string text(field);
  std::replace(text.begin(), text.end(), ',', '.');
  return printed_number(text).has_value();
}

}  // namespace

bool is_qtm_tsv(const DeviceText& text) {
  static constexpr std::array<std::string_view, 3> kFirst{"FILE_VERSION", "NO_OF_FRAMES",
                                                          "NO_OF_CAMERAS"};
  const auto first = key_of(text.line(0));
  return std::find(kFirst.begin(), kFirst.end(), first) != kFirst.end();
}

DeviceLayout qtm_layout(const DeviceText& text) {
  DeviceLayout layout;
  layout.separator = '\t';
  std::size_t header = 0;
  while (header < text.lines() && is_key(key_of(text.line(header)))) ++header;
  const auto markers = header_values(text, header, "MARKER_NAMES");
  const auto bodies = header_values(text, header, "BODY_NAMES");
  const auto names = bodies ? bodies : markers;
  if (!names || names->empty())
    text.fail(header > 0 ? header - 1 : 0,
              "expected MARKER_NAMES or BODY_NAMES in the header, found neither: the file is cut, "
              "or holds no 3D or 6D data: export it again");
  std::size_t begin = header;
  while (begin < text.lines() && text.is_passed_over(begin)) ++begin;
  auto first = fields_of(text.line(begin), '\t');
  bool has_row = false;  // that names the columns
  if (begin < text.lines() && !is_number(first.front()) && !first.front().empty()) {
    has_row = true;
    layout.header = begin++;
    while (begin < text.lines() && text.is_passed_over(begin)) ++begin;
    first = fields_of(text.line(begin), '\t');
  } else {
    layout.header = header - 1;
  }
  if (begin >= text.lines())
    text.fail(layout.header,
              "expected lines of data behind the header, found none: the file is cut, or nothing "
              "was measured: export it again");
  if (first.back().empty() && first.size() > 1) first.pop_back();  // a tab ends each line
  const std::size_t each = bodies ? kColumnsOfBody : kColumnsOfMarker;
  std::size_t extra = first.size() - std::min(first.size(), each * names->size());
  // A target that was not seen may be empty, the last one too.
  const auto heads = fields_of(text.line(layout.header), '\t');
  if (has_row && heads.front() == "Frame") extra = heads.size() > 1 && heads[1] == "Time" ? 2 : 1;
  layout.columns = extra + each * names->size();
  if (extra > 2 || first.size() > layout.columns || (extra == 0 && first.size() < layout.columns))
    text.fail(begin, fmt::format(
                         "expected {} columns for each of {} names, perhaps with frame and time in "
                         "front, found {}: the file is cut, or was changed: export it again",
                         each, names->size(), first.size()));
  layout.has_names = has_row;
  layout.begin = begin;
  layout.end = text.lines();
  layout.zero_is_missing = true;

  const auto frequency = header_values(text, header, "FREQUENCY");
  const auto rate = frequency && !frequency->empty() ? printed_number(frequency->front())
                                                     : std::optional<rsi::Decimal>();
  if (extra == 2) {
    layout.time = {TimeColumns::Kind::number, {1}, 1};
  } else if (!rate || !(rate->value > 0)) {
    text.fail(
        "expected FREQUENCY in Hz in the header or a column of times, found neither: export "
        "the file again with its header, or with the time of each frame");
  } else {
    layout.time = {
        extra == 1 ? TimeColumns::Kind::number : TimeColumns::Kind::lines, {}, 1 / rate->value};
    if (extra == 1) layout.time.columns = {0};
  }
  if (const auto frames = header_values(text, header, "NO_OF_FRAMES"); frames && !frames->empty())
    if (const auto count = printed_number(frames->front());
        count && count->value > 0 && count->value < 1e9)
      layout.frames = static_cast<std::size_t>(count->value);

  WideTargets targets(text, header - 1);
  for (std::size_t k = 0; k < names->size(); ++k) {
    const std::size_t at = extra + each * k;
    WideTarget columns;
    for (std::size_t c = 0; c < 3; ++c) columns.add(std::string(1, "xyz"[c]), at + c);
    std::optional<RotationColumns> rotation;
    if (bodies) {
      rotation = RotationColumns{RotationColumns::Kind::matrix, {}};
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
          rotation->columns.push_back(at + 7 + 3 * column + row);
    }
    targets.add(std::string((*names)[k]), columns, rotation);
  }
  std::move(targets).into(layout);
  return layout;
}

}  // namespace sweepd
