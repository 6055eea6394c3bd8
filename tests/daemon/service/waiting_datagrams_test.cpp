#include "daemon/service/waiting_datagrams.hpp"

#include <algorithm>
#include <string>

#include "tests/catch.hpp"

using sweepd::WaitingDatagrams;

namespace {

void add(WaitingDatagrams& waiting, const std::string& payload, std::uint32_t peer) {
  rsi::Datagram datagram;
  datagram.payload = payload;  // gone when this returns
  waiting.add(datagram, {}, peer);
}

std::string handed_over(WaitingDatagrams& waiting) {
  std::string all;
  waiting.hand_over([&](const rsi::Datagram& datagram, rsi::Handling) {
    all += std::string(datagram.payload) + ' ';
  });
  return all;
}

}  // namespace

TEST_CASE("datagrams of others wait with their content, in their order", "[waiting_datagrams]") {
  WaitingDatagrams waiting;
  add(waiting, "the first one, longer than a short string", 1);
  add(waiting, "b", 2);
  add(waiting, "c", 1);
  waiting.leave_only(1);
  CHECK(handed_over(waiting) == "the first one, longer than a short string c ");
  CHECK(handed_over(waiting).empty());
}

TEST_CASE("of too many datagrams the newest wait", "[waiting_datagrams]") {
  WaitingDatagrams waiting;
  for (std::size_t k = 0; k < WaitingDatagrams::kMost + 3; ++k) add(waiting, std::to_string(k), 1);
  const std::string all = handed_over(waiting);
  CHECK(all.substr(0, 4) == "3 4 ");
  CHECK(std::count(all.begin(), all.end(), ' ') == WaitingDatagrams::kMost);
}
