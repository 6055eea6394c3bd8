#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include <pugixml.hpp>

namespace sweepd {

/// One element of a page or a picture. The tree belongs to a pugi::xml_document, which escapes all
/// that is written: a text is never markup. Bytes that are no UTF-8 become U+FFFD, control
/// characters a blank.
class Markup {
 public:
  using Attributes = std::initializer_list<std::pair<const char*, std::string_view>>;

  Markup() = default;
  explicit Markup(pugi::xml_node node) : node_(node) {}

  /// Appends an element, and returns it.
  Markup add(const char* name, Attributes attributes = {});
  /// The same with a text in it; returns this one, for the next of a row of elements.
  Markup& put(const char* name, std::string_view text, Attributes attributes = {});
  /// Appends a text.
  Markup& text(std::string_view text);
  /// How many elements and texts are in it.
  [[nodiscard]] std::size_t size() const;
  /// Takes an element of this one away.
  void drop(const Markup& element);
  void set(const char* attribute, std::string_view value);

 private:
  pugi::xml_node node_;
};

/// A figure with a caption: `title` in bold, then `text`.
[[nodiscard]] Markup add_figure(Markup parent, std::string_view title, std::string_view text);

/// `text` as what XML can hold.
[[nodiscard]] std::string clean_text(std::string_view text);

/// A document's root as HTML 5, without the document type. Of what is void in HTML only `meta` may
/// be in it.
[[nodiscard]] std::string html_text(const pugi::xml_document& document);

}  // namespace sweepd
