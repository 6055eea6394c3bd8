#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

/// Adds every command with its options, in the order of the help. Whichever is called leaves its
/// exit code in `exit_code`; `arguments` are those of the program, as they stand then. Both must
/// outlive `app`.
void add_commands(CLI::App& app, const std::vector<std::string>& arguments, int& exit_code);

}  // namespace sweepd
