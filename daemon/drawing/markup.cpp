#include "daemon/drawing/markup.hpp"

#include <cstdint>
#include <iterator>

namespace sweepd {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// The bytes of the character of UTF-8 that `text` begins with; 0 if it begins with none.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(text[at]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((byte(k) & 0xC0) != 0x80) return 0;
  // Too long, surrogates, beyond Unicode, and the two that XML does not have.
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) >= 0xA0) ||
      (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) >= 0x90) ||
      (first == 0xEF && byte(1) == 0xBF && byte(2) >= 0xBE))
    return 0;
  return size;
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string clean;
  clean.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = character(text);
    const auto first = static_cast<std::uint8_t>(text.front());
    if (size == 0)
      clean += kReplacement;
    else if (first < 0x20 || first == 0x7F)
      clean += first == '\n' || first == '\t' ? text.front() : ' ';
    else
      clean += text.substr(0, size);
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return clean;
}

Markup Markup::add(const char* name, Attributes attributes) {
  Markup element(node_.append_child(name));
  for (const auto& [attribute, value] : attributes) element.set(attribute, value);
  return element;
}

Markup& Markup::put(const char* name, std::string_view text, Attributes attributes) {
  add(name, attributes).text(text);
  return *this;
}

Markup& Markup::text(std::string_view text) {
  node_.append_child(pugi::node_pcdata).set_value(clean_text(text).c_str());
  return *this;
}

std::size_t Markup::size() const {
  return static_cast<std::size_t>(std::distance(node_.begin(), node_.end()));
}

void Markup::drop(const Markup& element) {
  node_.remove_child(element.node_);
}

void Markup::set(const char* attribute, std::string_view value) {
  node_.append_attribute(attribute).set_value(clean_text(value).c_str());
}

Markup add_figure(Markup parent, std::string_view title, std::string_view text) {
  auto figure = parent.add("figure");
  auto caption = figure.add("figcaption");
  caption.put("b", title);
  if (!text.empty()) caption.text(std::string(" ") += text);
  return figure;
}

std::string html_text(const pugi::xml_document& document) {
  struct Text : pugi::xml_writer {
    std::string text;
    void write(const void* data, std::size_t size) override {
      text.append(static_cast<const char*>(data), size);
    }
  } out;
  document.document_element().print(out, "", pugi::format_raw | pugi::format_no_empty_element_tags,
                                    pugi::encoding_utf8);
  // The only element of ours that HTML knows without an end.
  for (std::size_t at = 0; (at = out.text.find("</meta>", at)) != std::string::npos;)
    out.text.erase(at, 7);
  return std::move(out.text) + '\n';
}

}  // namespace sweepd
