#include "daemon/devices/device_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "rsi/ascii.hpp"

namespace sweepd {
namespace {

void append_utf8(std::string& text, char32_t c) {
  const auto tail = [&](int shift) { text += static_cast<char>(0x80 | ((c >> shift) & 0x3f)); };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xc0 | (c >> 6));
    tail(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xe0 | (c >> 12));
    tail(6);
    tail(0);
  } else {
    text += static_cast<char>(0xf0 | (c >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

/// A character that is cut at the end may be one.
bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t k) -> unsigned { return static_cast<unsigned char>(text[k]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i);
    const std::size_t size = first < 0x80                     ? 1
                             : first >= 0xc2 && first < 0xe0  ? 2
                             : first >= 0xe0 && first < 0xf0  ? 3
                             : first >= 0xf0 && first <= 0xf4 ? 4
                                                              : 0;
    if (size == 0) return false;
    for (std::size_t k = 1; k < size && i + k < text.size(); ++k)
      if ((byte(i + k) & 0xc0U) != 0x80) return false;
    i += size;
  }
  return true;
}

/// Each byte is the character of its number.
std::string from_latin1(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 64);
  for (const char c : bytes) append_utf8(text, static_cast<unsigned char>(c));
  return text;
}

/// From the bytes behind the byte order mark. Throws CsvError at half a character.
std::string from_utf16(const std::filesystem::path& path, std::string_view bytes, bool big) {
  std::string text;
  text.reserve(bytes.size() / 2);
  const auto fail = [&](const char* found) {
    throw CsvError(fmt::format(
        "{}: line {}: expected UTF-16 text, found {}: the file is cut or damaged, export it again",
        path.string(), 1 + std::count(text.begin(), text.end(), '\n'), found));
  };
  const auto unit = [&](std::size_t i) {
    const auto byte = [&](std::size_t k) {
      return static_cast<char32_t>(static_cast<unsigned char>(bytes[k]));
    };
    return big ? (byte(i) << 8) | byte(i + 1) : byte(i) | (byte(i + 1) << 8);
  };
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    if (i + 1 == bytes.size()) fail("half a character at the end");
    char32_t c = unit(i);
    if (c >= 0xd800 && c < 0xe000) {
      const char32_t low = c < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
      if (low < 0xdc00 || low >= 0xe000) fail("half of a surrogate pair");
      c = 0x10000 + ((c - 0xd800) << 10) + (low - 0xdc00);
      i += 2;
    }
    append_utf8(text, c);
  }
  return text;
}

/// Digits after the point, were the number written without an exponent.
int decimals_of(std::string_view text, int decimals) {
  // A zero may be written with any exponent; no number that is taken has more digits than these.
  constexpr int kLeastExponent = -400;
  constexpr int kMostExponent = 12;
  const auto e = text.find_first_of("eE");
  if (e == std::string_view::npos) return decimals;
  const auto digits = text.substr(e + 1 + (text.substr(e + 1).starts_with('+') ? 1 : 0));
  int exponent = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  return decimals - std::clamp(exponent, kLeastExponent, kMostExponent);
}

}  // namespace

std::string as_utf8(const std::filesystem::path& path, std::string bytes) {
  const std::string_view all = bytes;
  if (all.starts_with("\xff\xfe")) return from_utf16(path, all.substr(2), false);
  if (all.starts_with("\xfe\xff")) return from_utf16(path, all.substr(2), true);
  constexpr std::size_t kHead = 4096;
  if (all.substr(0, kHead).find('\0') != std::string_view::npos)
    throw CsvError(path.string() +
                   ": expected text, found binary data: give what the device's program exports as "
                   "text, and captures of telegrams to `sweepd replay`");
  if (all.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);
  return is_utf8(bytes) ? std::move(bytes) : from_latin1(bytes);
}

DeviceText::DeviceText(std::filesystem::path path, std::string bytes)
    : path_(std::move(path)), content_(as_utf8(path_, std::move(bytes))) {
  const std::string_view all = content_;
  for (std::size_t at = 0; at < all.size();) {
    const auto end = all.find('\n', at);
    auto line = all.substr(at, end == std::string_view::npos ? end : end - at);
    // A tab at the end separates an empty field.
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    lines_.push_back(line);
    is_open_ = end == std::string_view::npos;
    at = is_open_ ? all.size() : end + 1;
  }
}

std::string_view DeviceText::line(std::size_t number) const {
  return number < lines_.size() ? lines_[number] : std::string_view();
}

bool DeviceText::is_passed_over(std::size_t number) const {
  const auto text = rsi::trimmed(line(number));
  return text.empty() || text.starts_with('#') || text.starts_with("//") ||
         text.find_first_not_of(",;\t ") == std::string_view::npos;
}

void DeviceText::fail(std::size_t line, const std::string& problem) const {
  throw CsvError(fmt::format("{}: line {}: {}", path_.string(), line + 1, problem));
}

void DeviceText::fail(const std::string& problem) const {
  throw CsvError(path_.string() + ": " + problem);
}

Fields fields_of(std::string_view line, char separator) {
  Fields fields;
  const auto is_blank = [&](char c) { return c == ' ' || (c == '\t' && separator != '\t'); };
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (separator == ' ' && at == line.size()) return fields;
    std::size_t begin = at;
    std::size_t end = 0;
    if (at < line.size() && line[at] == '"') {
      end = std::min(line.find('"', ++begin), line.size());
      at = std::min(end + 1, line.size());
      while (at < line.size() && is_blank(line[at])) ++at;
      if (separator != ' ') at = std::min(line.find(separator, at), line.size());
    } else {
      at = separator == ' ' ? line.find_first_of(" \t", at) : line.find(separator, at);
      at = end = std::min(at, line.size());
    }
    fields.push_back(rsi::trimmed(line.substr(begin, end - begin)));
    if (at == line.size()) return fields;
    if (separator != ' ') ++at;
  }
}

char separator_in(std::string_view line) {
  for (const char separator : {'\t', ';', ','})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ' ';
}

std::string lower(std::string_view text) {
  std::string small(text);
  std::transform(small.begin(), small.end(), small.begin(), rsi::lower);
  return small;
}

bool contains(std::string_view text, std::string_view lower_case_word) {
  return std::search(text.begin(), text.end(), lower_case_word.begin(), lower_case_word.end(),
                     [](char a, char b) { return rsi::lower(a) == b; }) != text.end();
}

double length_unit_mm(std::string_view name) {
  struct Unit {
    std::string_view name;
    double mm;
  };
  static constexpr std::array<Unit, 27> kUnits{{{"mm", 1},
                                                {"millimeter", 1},
                                                {"millimetre", 1},
                                                {"millimeters", 1},
                                                {"millimetres", 1},
                                                {"cm", 10},
                                                {"centimeters", 10},
                                                {"centimetres", 10},
                                                {"m", 1000},
                                                {"meter", 1000},
                                                {"metre", 1000},
                                                {"meters", 1000},
                                                {"metres", 1000},
                                                {"in", 25.4},
                                                {"inch", 25.4},
                                                {"inches", 25.4},
                                                {"ft", 304.8},
                                                {"foot", 304.8},
                                                {"feet", 304.8},
                                                {"um", 1e-3},
                                                {"\xc2\xb5m", 1e-3},  // the micro sign
                                                {"\xce\xbcm", 1e-3},  // the Greek letter
                                                {"\xb5m", 1e-3},      // of Latin-1
                                                {"micrometers", 1e-3},
                                                {"micrometres", 1e-3},
                                                {"microns", 1e-3},
                                                {"mils", 0.0254}}};
  for (const auto& unit : kUnits)
    if (rsi::equal_ignoring_case(name, unit.name)) return unit.mm;
  return 0;
}

std::optional<rsi::Decimal> printed_number(std::string_view text) {
  auto number = rsi::decimal(text);
  if (number) number->decimals = decimals_of(text, number->decimals);
  return number;
}

bool may_be_thousands(std::string_view text) {
  constexpr std::string_view kMarks = ",.' ";
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  const auto digits_from = [&](std::size_t at) {
    return std::min(text.find_first_not_of("0123456789", at), text.size());
  };
  const std::size_t mark = digits_from(0);
  if (mark == 0 || mark > 3 || mark == text.size() || text.front() == '0') return false;
  const std::size_t end = digits_from(mark + 1);
  const auto is_mark = [&](std::size_t at) { return kMarks.find(text[at]) != kMarks.npos; };
  return is_mark(mark) && end - mark - 1 == 3 && (end == text.size() || is_mark(end));
}

std::string as_found(std::string_view text) {
  return text.empty() ? "nothing" : '"' + rsi::in_short(text) + '"';
}

}  // namespace sweepd
