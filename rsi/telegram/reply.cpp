#include "rsi/telegram/reply.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "rsi/ascii.hpp"
#include "rsi/telegram/decimal.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/telegram.hpp"
#include "rsi/telegram/wire_layout.hpp"

namespace rsi {
namespace {

using Type = EthernetConfig::Element::Type;

constexpr std::size_t kLongestIpoc = 20;  // digits of 2^64 - 1

/// As the correction gate lets it pass: a zero that is written otherwise is withheld, and with it
/// every reply.
std::string_view zero(Type type) {
  if (type == Type::STRING) return "";
  return type == Type::DOUBLE ? "0.0" : "0";
}

/// Walks through XML-like text whose names may begin with a digit.
class Scan {
 public:
  explicit Scan(std::string_view text) : rest_(text) {}

  /// Calls `found(element, attribute, value)` for each attribute, and with an empty attribute for
  /// each element's end with the text since the last tag. Returns why it stopped; nothing if all
  /// is one element, in which all that was opened was closed.
  template <typename Found>
  std::string_view run(Found found) {
    while (!rest_.empty() && (!done_ || rest_.find_first_not_of(std::string_view(" \t\r\n\0", 5)) !=
                                            std::string_view::npos)) {
      const auto content = until("<");
      if (!content) return done_ ? "text after the end" : "text outside of the element";
      if (depth_ == 0 && (done_ || !trimmed(*content).empty()))
        return "more than the element <Sen>";
      // Of "5<!-- -->0" and "5<a/>0" nobody can be sure what a controller reads.
      if (depth_ > 0 && !rest_.starts_with("/") && !trimmed(*content).empty())
        return "a value that is interrupted";
      const bool is_comment = take("!--");
      if (is_comment || take("?")) {
        if (!until(is_comment ? "-->" : "?>")) return "a comment that does not end";
      } else if (rest_.starts_with("/")) {
        rest_.remove_prefix(1);
        const auto name = until(">");
        if (!name || depth_ == 0 || trimmed(*name) != open_[depth_ - 1]) return "a wrong end tag";
        found(open_[depth_ - 1], "", trimmed(*content));
        close();
      } else if (const auto wrong = start_tag(found); !wrong.empty()) {
        return wrong;
      }
    }
    return done_ ? "" : "it ends too early";
  }

 private:
  template <typename Found>
  std::string_view start_tag(Found& found) {
    const auto element = name();
    if (element.empty() || depth_ == open_.size()) return "a wrong tag";
    open_[depth_++] = element;
    for (;;) {
      skip_blanks();
      if (take(">")) return "";
      if (take("/>")) {
        found(element, "", "");
        close();
        return "";
      }
      const auto attribute = name();
      skip_blanks();
      if (attribute.empty() || !take("=")) return "a wrong attribute";
      skip_blanks();
      const std::string_view quote = rest_.substr(0, 1);
      if (!take("\"") && !take("'")) return "an attribute without quotation marks";
      const auto value = until(quote);
      if (!value) return "an attribute that does not end";
      found(element, attribute, trimmed(*value));
    }
  }

  void close() { done_ = --depth_ == 0; }

  std::string_view name() {
    const auto length = std::min(rest_.find_first_of(" \t\r\n=/<>\"'"), rest_.size());
    const auto name = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return name;
  }

  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
  }

  bool take(std::string_view wanted) {
    if (!rest_.starts_with(wanted)) return false;
    rest_.remove_prefix(wanted.size());
    return true;
  }

  /// What stands before `end`, and moves behind that.
  std::optional<std::string_view> until(std::string_view end) {
    const auto at = rest_.find(end);
    if (at == std::string_view::npos) return std::nullopt;
    const auto before = rest_.substr(0, at);
    rest_.remove_prefix(at + end.size());
    return before;
  }

  std::string_view rest_;
  std::array<std::string_view, 16> open_{};
  std::size_t depth_ = 0;
  bool done_ = false;
};

}  // namespace

Reply::Reply(const EthernetConfig& config) : Reply(config.sentype, config.receive) {}

Reply::Reply(std::string_view sentype) : Reply(sentype, {}) {}

Reply::Reply(std::string_view sentype, const std::vector<EthernetConfig::Element>& receive) {
  std::string values;
  for (const auto& element : wire_layout(receive)) {
    std::string content;
    values += "<" + element.name;
    for (const auto& [attribute, tag, component] : element.fields)
      if (attribute.empty())
        content = zero(receive[tag].type);
      else
        values.append(" ").append(attribute).append("=\"").append(zero(receive[tag].type)) += '"';
    values += element.has_text() ? ">" + content + "</" + element.name + ">" : "/>";
  }
  const std::string sen = "<Sen Type=\"" + xml_escaped(sentype) + "\">";
  templates_ = {
      Template{sen + values + "<IPOC>", 0, "</IPOC></Sen>"},
      Template{sen + "<Dat TaskType=\"b\">" + values + "<IPOC>", 0, "</IPOC></Dat></Sen>"}};
  for (auto& [buffer, ipoc_at, end] : templates_) {
    ipoc_at = buffer.size();
    buffer.resize(ipoc_at + kLongestIpoc + end.size());
  }
}

std::string_view Reply::with_ipoc(std::string_view ipoc_digits, Form form) noexcept {
  if (ipoc_digits.empty() || ipoc_digits.size() > kLongestIpoc) return {};
  auto& [buffer, ipoc_at, rest] = templates_[static_cast<std::size_t>(form)];
  char* const end = std::copy(ipoc_digits.begin(), ipoc_digits.end(), buffer.data() + ipoc_at);
  return {buffer.data(), std::copy(rest.begin(), rest.end(), end)};
}

Form form_of(std::string_view telegram) noexcept {
  constexpr std::size_t kSearched = 256;  // room for an XML declaration and name spaces
  constexpr std::string_view kDat = "<Dat";
  constexpr std::string_view kAttribute = "TaskType";
  telegram = telegram.substr(0, kSearched);
  for (auto at = telegram.find('<'); at != telegram.npos; at = telegram.find('<', at + 1)) {
    if (!equal_ignoring_case(telegram.substr(at, kDat.size()), kDat)) continue;
    auto rest = telegram.substr(at + kDat.size());
    if (rest.empty() || !is_blank(rest.front())) continue;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    if (equal_ignoring_case(rest.substr(0, kAttribute.size()), kAttribute)) return Form::wrapped;
  }
  return Form::flat;
}

ReplyCheck::ReplyCheck(const EthernetConfig& config) : sentype_(config.sentype) {
  for (const auto& element : wire_layout(config.receive))
    for (const auto& [attribute, tag, component] : element.fields)
      wanted_.push_back({element.name, attribute, config.receive[tag].tag,
                         config.receive[tag].type != Type::STRING});
}

ReplyContent ReplyCheck::read(std::string_view payload) const {
  ReplyContent content;
  const auto wrong = [&](const std::string& why) {
    content.malformed = why;
    return content;
  };
  std::vector<bool> seen(wanted_.size());
  std::optional<std::string_view> type;
  std::optional<std::string_view> ipoc;
  std::string no_number;
  bool is_sen = false;

  const auto broken = Scan(payload).run(
      [&](std::string_view element, std::string_view attribute, std::string_view value) {
        // The root's own end comes last.
        is_sen = element == "Sen";
        if (is_sen && attribute == "Type") type = value;
        if (element == "IPOC" && attribute.empty()) ipoc = value;
        for (std::size_t i = 0; i < wanted_.size(); ++i) {
          if (wanted_[i].element != element || wanted_[i].attribute != attribute) continue;
          seen[i] = true;
          if (!wanted_[i].is_number) continue;
          const auto setting = [&] { return wanted_[i].tag + " = " + std::string(value); };
          const auto figure = number(value);
          if (!figure && no_number.empty()) no_number = setting();
          if (figure && *figure != 0 && content.not_zero.empty()) content.not_zero = setting();
        }
      });
  if (!broken.empty()) return wrong(std::string(broken));
  if (!is_sen) return wrong("its element is not <Sen>");
  if (!type) return wrong("<Sen> has no Type");
  if (!ipoc) return wrong("there is no IPOC");
  const auto ipoc_value = ipoc_number(*ipoc);
  if (!ipoc_value) return wrong("IPOC is no number: \"" + std::string(*ipoc) + "\"");
  if (!no_number.empty()) return wrong("no number: " + no_number);

  content.sen_type = *type;
  content.right_type = *type == sentype_ || *type == xml_escaped(sentype_);
  content.ipoc = *ipoc_value;
  const auto absent = std::find(seen.begin(), seen.end(), false);
  if (absent != seen.end())
    content.missing = wanted_[static_cast<std::size_t>(absent - seen.begin())].tag;
  return content;
}

}  // namespace rsi
