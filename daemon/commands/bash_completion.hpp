#pragma once

#include <string>

#include "daemon/commands/help_text.hpp"

namespace sweepd {

/// A script that makes bash complete the program's commands, options, their values where these are
/// a fixed set, and the names of files and folders.
[[nodiscard]] std::string bash_completion(const CommandText& program);

}  // namespace sweepd
