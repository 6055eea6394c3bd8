#pragma once

#include <string>

#include <pugixml.hpp>

#include "daemon/drawing/markup.hpp"

namespace sweepd {

/// The head of a page in the style of the reports, and its main part, to be filled. Pictures and
/// style are within, no script, nothing from elsewhere.
[[nodiscard]] Markup begin_page(pugi::xml_document& document, const std::string& title);

}  // namespace sweepd
