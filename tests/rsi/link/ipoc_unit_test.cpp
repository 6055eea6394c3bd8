#include "rsi/link/ipoc_unit.hpp"

#include <vector>

#include "tests/catch.hpp"

using namespace std::chrono_literals;

namespace {

std::chrono::nanoseconds unit(std::vector<std::chrono::nanoseconds> per_count) {
  return rsi::ipoc_unit(per_count);
}

}  // namespace

TEST_CASE("an IPOC that counts milliseconds has a unit of exactly one", "[ipoc_unit]") {
  CHECK(unit({}) == 1ms);
  CHECK(unit({1007us, 998us, 700us, 1001us, 90ms}) == 1ms);
  CHECK(unit({1250us}) == 1ms);
  CHECK(unit({750us}) == 1ms);
  CHECK(unit({0us, 0us, 5us}) == 1ms);  // no times
}

TEST_CASE("any other IPOC has the median for its unit, however wild the rest is", "[ipoc_unit]") {
  CHECK(unit({4ms, 4001us, 3ms, 9s, 4002us}) == 4001us);
  CHECK(unit({2us}) == 2us);
  CHECK(unit({std::chrono::nanoseconds::max()}) == 1h);
}
