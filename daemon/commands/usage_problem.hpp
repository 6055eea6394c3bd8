#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
class ParseError;
}  // namespace CLI

namespace sweepd {

/// What is wrong with the options of `command`, in this program's words in place of the parser's.
[[nodiscard]] std::string usage_problem(const CLI::App& command, const CLI::ParseError& problem);

}  // namespace sweepd
