#pragma once

#include <stdexcept>

namespace sweepd {

/// Something that a user edits is wrong: settings, a robot description, a sweep plan. The text
/// reads
///   FILE:LINE:COLUMN: key: what was expected, what was found: what to do
/// with as much of the place as is known. The program ends with exit code 78 on it.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace sweepd
