#include "daemon/text/nearest_word.hpp"

#include <algorithm>

namespace sweepd {
namespace {

/// Edit distance that counts two swapped neighbours as one mistake.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min(
          {d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string_view nearest_word(std::string_view wrong, const std::vector<std::string_view>& words) {
  constexpr std::size_t kLongest = 64;  // of a longer one nobody can say
  if (wrong.size() > kLongest) return {};
  std::string_view best;
  std::size_t least = wrong.size() / 4 + 2;
  for (const std::string_view word : words) {
    if (word.size() > kLongest) continue;
    const bool forgot_unit =
        word.starts_with(wrong) && word.size() > wrong.size() && word[wrong.size()] == '_';
    const std::size_t mistakes = forgot_unit ? 1 : distance(wrong, word);
    if (mistakes < least) {
      least = mistakes;
      best = word;
    }
  }
  return best;
}

}  // namespace sweepd
