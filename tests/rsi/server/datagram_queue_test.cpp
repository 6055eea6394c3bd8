#include "rsi/server/datagram_queue.hpp"

#include <string>
#include <thread>

#include "tests/catch.hpp"

using rsi::Datagram;
using rsi::DatagramQueue;
using namespace std::chrono_literals;

TEST_CASE("a datagram goes through the queue whole", "[datagram_queue]") {
  DatagramQueue queue(200'000);
  const std::string payload(65'507, 'x');
  REQUIRE(queue.push({5ns, {1, 2}, {3, 4}, payload, true}));
  REQUIRE(queue.push({6ns, {1, 2}, {3, 4}, "", false}));
  Datagram got;
  REQUIRE(queue.pop(got));
  CHECK(got.time == 5ns);
  CHECK(got.source == rsi::Endpoint{1, 2});
  CHECK(got.destination == rsi::Endpoint{3, 4});
  CHECK(got.payload == payload);
  CHECK(got.cut);
  REQUIRE(queue.pop(got));
  CHECK(got.payload.empty());
  CHECK_FALSE(queue.pop(got));
}

TEST_CASE("a full queue refuses, counts, and goes on when there is room again",
          "[datagram_queue]") {
  DatagramQueue queue(1000);
  const std::string payload(400, 'x');
  const Datagram datagram{0ns, {}, {}, payload, false};
  CHECK(queue.push(datagram));
  CHECK(queue.push(datagram));
  CHECK_FALSE(queue.push(datagram));
  CHECK(queue.overflows() == 1);
  Datagram got;
  REQUIRE(queue.pop(got));
  CHECK(queue.push(datagram));
  CHECK(queue.overflows() == 1);
}

TEST_CASE("what one thread pushes, another gets in order and without loss", "[datagram_queue]") {
  constexpr int kDatagrams = 50'000;
  DatagramQueue queue(64 << 10);
  std::thread producer([&] {
    for (int k = 0; k < kDatagrams;) {
      const std::string payload(static_cast<std::size_t>(k % 700), static_cast<char>(k));
      if (queue.push({std::chrono::nanoseconds(k), {}, {}, payload, false})) ++k;
    }
  });
  int wrong = 0;
  Datagram got;
  for (int k = 0; k < kDatagrams;) {
    if (!queue.pop(got)) {
      std::this_thread::yield();
      continue;
    }
    const std::string expected(static_cast<std::size_t>(k % 700), static_cast<char>(k));
    if (got.time.count() != k || got.payload != expected) ++wrong;
    ++k;
  }
  producer.join();
  CHECK(wrong == 0);
}
