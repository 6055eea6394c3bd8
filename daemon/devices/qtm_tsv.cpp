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

struct QtmHeader {
  std::size_t lines = 0;
  Fields names;         ///< of the targets
  bool bodies = false;  ///< in place of markers

  [[nodiscard]] std::size_t each() const { return bodies ? kColumnsOfBody : kColumnsOfMarker; }
  [[nodiscard]] std::size_t columns() const { return each() * names.size(); }
};

QtmHeader qtm_header(const DeviceText& text) {
  QtmHeader header;
  while (header.lines < text.lines() && is_key(key_of(text.line(header.lines)))) ++header.lines;
  const auto markers = header_values(text, header.lines, "MARKER_NAMES");
  const auto bodies = header_values(text, header.lines, "BODY_NAMES");
  const auto names = bodies ? bodies : markers;
  if (!names || names->empty())
    text.fail(header.lines > 0 ? header.lines - 1 : 0,
              "expected MARKER_NAMES or BODY_NAMES in the header, found neither: the file is cut, "
              "or holds no 3D or 6D data: export it again");
  header.names = *names;
  header.bodies = bodies.has_value();
  return header;
}

/// From `line` on, the first that is not passed over.
std::size_t next_qtm_line(const DeviceText& text, std::size_t line) {
  while (line < text.lines() && text.is_passed_over(line)) ++line;
  return line;
}

/// Where the data begin, behind a row that names the columns where there is one, and how many
/// columns they have. Returns how many of these come before the targets': frame and time.
std::size_t set_qtm_rows(const DeviceText& text, const QtmHeader& header, DeviceLayout& layout) {
  layout.begin = next_qtm_line(text, header.lines);
  layout.end = text.lines();
  auto first = fields_of(text.line(layout.begin), '\t');
  layout.has_names =
      layout.begin < text.lines() && !is_number(first.front()) && !first.front().empty();
  layout.header = layout.has_names ? layout.begin : header.lines - 1;
  if (layout.has_names) {
    layout.begin = next_qtm_line(text, layout.begin + 1);
    first = fields_of(text.line(layout.begin), '\t');
  }
  if (layout.begin >= text.lines())
    text.fail(layout.header,
              "expected lines of data behind the header, found none: the file is cut, or nothing "
              "was measured: export it again");
  if (first.back().empty() && first.size() > 1) first.pop_back();  // a tab ends each line
  std::size_t extra = first.size() - std::min(first.size(), header.columns());
  // A target that was not seen may be empty, the last one too.
  const auto heads = fields_of(text.line(layout.header), '\t');
  if (layout.has_names && heads.front() == "Frame")
    extra = heads.size() > 1 && heads[1] == "Time" ? 2 : 1;
  layout.columns = extra + header.columns();
  if (extra > 2 || first.size() > layout.columns || (extra == 0 && first.size() < layout.columns))
    text.fail(layout.begin,
              fmt::format("expected {} columns for each of {} names, perhaps with frame and time "
                          "in front, found {}: the file is cut, or was changed: export it again",
                          header.each(), header.names.size(), first.size()));
  return extra;
}

void set_qtm_times(const DeviceText& text, const QtmHeader& header, std::size_t extra,
                   DeviceLayout& layout) {
  const auto frequency = header_values(text, header.lines, "FREQUENCY");
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
}

void set_qtm_targets(const DeviceText& text, const QtmHeader& header, std::size_t extra,
                     DeviceLayout& layout) {
  WideTargets targets(text, header.lines - 1);
  for (std::size_t k = 0; k < header.names.size(); ++k) {
    const std::size_t at = extra + header.each() * k;
    WideTarget columns;
    for (std::size_t c = 0; c < 3; ++c) columns.add(std::string(1, "xyz"[c]), at + c);
    std::optional<RotationColumns> rotation;
    if (header.bodies) {
      rotation = RotationColumns{RotationColumns::Kind::matrix, {}};
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
          rotation->columns.push_back(at + 7 + 3 * column + row);
    }
    targets.add(std::string(header.names[k]), columns, rotation);
  }
  std::move(targets).into(layout);
}

}  // namespace

bool is_qtm_tsv(const DeviceText& text) {
  static constexpr std::array<std::string_view, 3> kFirst{"FILE_VERSION", "NO_OF_FRAMES",
                                                          "NO_OF_CAMERAS"};
  const auto first = key_of(text.line(0));
  return std::find(kFirst.begin(), kFirst.end(), first) != kFirst.end();
}

DeviceLayout qtm_layout(const DeviceText& text) {
  const QtmHeader header = qtm_header(text);
  DeviceLayout layout;
  layout.separator = '\t';
  layout.zero_is_missing = true;
  const std::size_t extra = set_qtm_rows(text, header, layout);
  set_qtm_times(text, header, extra, layout);
  if (const auto frames = header_values(text, header.lines, "NO_OF_FRAMES");
      frames && !frames->empty())
    if (const auto count = printed_number(frames->front());
        count && count->value > 0 && count->value < 1e9)
      layout.frames = static_cast<std::size_t>(count->value);
  set_qtm_targets(text, header, extra, layout);
  return layout;
}

}  // namespace sweepd
