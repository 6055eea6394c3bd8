#include "rsi/capture/capture_order.hpp"

#include <algorithm>
#include <utility>

#include "rsi/capture/capture_reader.hpp"

namespace rsi {

std::vector<std::filesystem::path> in_order_of_time(
    const std::vector<std::filesystem::path>& captures) {
  if (captures.size() < 2) return captures;
  std::vector<std::pair<Timestamp, std::filesystem::path>> timed;
  for (const auto& path : captures) {
    const auto first = CaptureReader(path).next();
    timed.emplace_back(first ? first->time : Timestamp::max(), path);
  }
  std::stable_sort(timed.begin(), timed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::filesystem::path> ordered;
  for (auto& [time, path] : timed) ordered.push_back(std::move(path));
  return ordered;
}

}  // namespace rsi
