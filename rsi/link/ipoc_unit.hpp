#pragma once

#include <chrono>
#include <span>

namespace rsi {

/// What one count of the IPOC lasts. `per_count`: times from one telegram to the next, each divided
/// by the rise of the IPOC; they are left in another order. Where their median is within a quarter
/// of a millisecond of 1 ms the IPOC counts milliseconds, as on every controller, and the answer is
/// exactly 1 ms. Some simulators raise it by one a telegram, or keep another time than they print;
/// there the median is all there is, up to an hour. 1 ms if `per_count` is empty, or if all times
/// are the same, as where a recording has none.
[[nodiscard]] std::chrono::nanoseconds ipoc_unit(
    std::span<std::chrono::nanoseconds> per_count) noexcept;

}  // namespace rsi
