#pragma once

#include <string>

#include "daemon/devices/device_text.hpp"
#include "daemon/points/points_file.hpp"
#include "tests/catch.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace sweepd::test {

/// The points of a file with this text, as identify reads them.
inline PointsFile read_text(const std::string& text) {
  const TemporaryFolder folder;
  return PointsReader({}, 6).read(folder.write("take.csv", text), {});
}

inline std::string notes_of(const PointsFile& file) {
  std::string notes;
  for (const auto& note : file.notes) notes += note + "\n";
  return notes;
}

/// `said` follows the file's name.
inline void check_text_error(const std::string& text, const std::string& said) {
  INFO(text);
  CHECK_THROWS_AS(read_text(text), CsvError);
  CHECK_THROWS_WITH(read_text(text), Catch::Matchers::ContainsSubstring("take.csv: " + said));
}

}  // namespace sweepd::test
