#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepd {

/// Texts for people stay within so many columns.
inline constexpr std::size_t kColumns = 80;

/// `label` and the words of `text`, in lines that fit the terminal; all but the first begin in the
/// column in which `text` began.
[[nodiscard]] std::string paragraph(const std::string& label, std::string_view text);

/// Without their ends.
[[nodiscard]] std::vector<std::string> lines_of(std::string_view text);

/// Filled up with blanks, on the left or on the right, to `width` characters of ASCII.
[[nodiscard]] std::string right(std::string text, std::size_t width);
[[nodiscard]] std::string left(std::string text, std::size_t width);

/// A number in a column; - where there is none.
[[nodiscard]] std::string number(double value, int decimals, std::size_t width);
[[nodiscard]] std::string number(const std::optional<double>& value, int decimals,
                                 std::size_t width);

}  // namespace sweepd
