#include "rsi/telegram/correction_gate.hpp"

namespace rsi {
namespace {

bool is_zero(std::string_view value) {
  return value.find_first_not_of('0') == value.npos || value == "0.0";
}

/// Takes all of `rest` up to `end`, and `end` itself; false if that does not come.
bool take_until(std::string_view& rest, char end, std::string_view& before) {
  const auto at = rest.find(end);
  if (at == rest.npos) return false;
  before = rest.substr(0, at);
  rest.remove_prefix(at + 1);
  return true;
}

bool take(std::string_view& rest, std::string_view wanted) {
  if (!rest.starts_with(wanted)) return false;
  rest.remove_prefix(wanted.size());
  return true;
}

/// The attributes of a tag, ` name="0.0" other="0"`, are all zero.
bool zero_attributes(std::string_view attributes) {
  while (!attributes.empty()) {
    std::string_view name;
    std::string_view value;
    if (!take(attributes, " ")) return false;
    if (!take_until(attributes, '=', name) || name.empty() || !take(attributes, "\"") ||
        !take_until(attributes, '"', value) || !is_zero(value))
      return false;
  }
  return true;
}

}  // namespace

bool moves_nothing(std::string_view reply) noexcept {
  constexpr std::string_view kNoName = " \t\r\n=\"'<>/&";
  std::string_view ignored;
  if (!take(reply, "<Sen Type=\"") || !take_until(reply, '"', ignored) ||
      ignored.find_first_of("<>") != ignored.npos || !take(reply, ">"))
    return false;
  // The oldest RSI wraps all into an element of its own.
  const bool wrapped = take(reply, "<Dat TaskType=\"b\">");
  while (!take(reply, wrapped ? "</Dat></Sen>" : "</Sen>")) {
    std::string_view tag;
    if (!take(reply, "<") || !take_until(reply, '>', tag)) return false;
    const bool closed = tag.ends_with('/');
    if (closed) tag.remove_suffix(1);
    const auto name = tag.substr(0, tag.find(' '));
    if (name.empty() || name.find_first_of(kNoName) != name.npos ||
        !zero_attributes(tag.substr(name.size())))
      return false;
    if (closed) continue;
    std::string_view value;
    if (!take_until(reply, '<', value) || !take(reply, "/") || !take(reply, name) ||
        !take(reply, ">"))
      return false;
    const bool digits = !value.empty() && value.find_first_not_of("0123456789") == value.npos;
    if (!(name == "IPOC" ? digits : is_zero(value))) return false;
  }
  return reply.empty();
}

}  // namespace rsi
