#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

/// What is wrong with a KRL file; each line of it begins with "line N: " where it is in a line.
class KrlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// NAME value, in the braces of an aggregate.
struct KrlField {
  std::string name;       ///< in capitals
  std::string_view text;  ///< its value as it is written
  std::size_t at = 0;     ///< where the value begins in the file

  /// A REAL or INT. Nothing where it is none.
  [[nodiscard]] std::optional<double> number() const;
  /// An INT, which may be written as 'B101' or 'H1F', up to 16 bits.
  [[nodiscard]] std::optional<unsigned> bits() const;
};

/// NAME={...} with its fields.
struct KrlAggregate {
  std::string type;  ///< in capitals, by its declaration or in its braces; empty: not told
  std::string name;  ///< in capitals, with its index: XP1, BASE_DATA[2]
  std::size_t line = 0;
  std::vector<KrlField> fields;

  /// Nothing where there is none.
  [[nodiscard]] const KrlField* find(std::string_view field) const;
};

/// The aggregates that a .dat file gives values, in its order. `text` is bytes, as KRL files may be
/// Latin-1; it has to outlive what is returned. Throws KrlError where braces or quotes are not
/// closed, and where the file ends before ENDDAT.
[[nodiscard]] std::vector<KrlAggregate> krl_aggregates(std::string_view text);

/// One aggregate by itself, as in an option; its braces may be missing. Throws KrlError.
[[nodiscard]] KrlAggregate krl_aggregate(std::string_view text);

/// In capitals, of ASCII.
[[nodiscard]] std::string in_capitals(std::string_view text);

}  // namespace sweepd
