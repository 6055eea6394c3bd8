#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/commands/command_text.hpp"
#include "daemon/settings/settings.hpp"

namespace sweepd {

/// Parts of manual pages in roff, in the macros of groff_man(7). The pages themselves are written
/// by hand, in sweepd.1.in and sweepd.toml.5.in, with places for these.

/// The program's own options, an entry each.
[[nodiscard]] std::string options_roff(const CommandText& program);

/// A section for each command of the program: how it is called, what it does, its options. --help,
/// which all have, is left to the program's own.
[[nodiscard]] std::string commands_roff(const CommandText& program);

/// A section for `table` ("[[robot]]", "[http]") and for each table in it, and an entry a key.
[[nodiscard]] std::string settings_roff(std::string_view table,
                                        const std::vector<OptionText>& options);

/// Puts `parts` into a page where it says @NAME@. Throws std::runtime_error for a place without a
/// part, and for a part without a place.
[[nodiscard]] std::string manual_page(const std::string& page,
                                      const std::map<std::string, std::string>& parts);

}  // namespace sweepd
