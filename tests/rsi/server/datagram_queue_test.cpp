#include "rsi/server/datagram_queue.hpp"

#include <deque>
#include <fstream>
#include <random>
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
  CHECK_FALSE(queue.half_full());
  CHECK(queue.push(datagram));
  CHECK(queue.half_full());
  CHECK_FALSE(queue.push(datagram));
  CHECK(queue.overflows() == 1);
  Datagram got;
  REQUIRE(queue.pop(got));
  CHECK(queue.push(datagram));
  CHECK(queue.overflows() == 1);
}

TEST_CASE("a queue takes as much as it has room for, from wherever it was emptied",
          "[datagram_queue]") {
  constexpr std::size_t kHead = 32;
  const std::string payload(468, 'x');
  const Datagram datagram{0ns, {}, {}, payload, false};
  Datagram got;
  for (int before = 0; before < 12; ++before) {
    DatagramQueue queue(10 * (payload.size() + kHead));
    for (int k = 0; k < before; ++k) {
      REQUIRE(queue.push(datagram));
      REQUIRE(queue.pop(got));
    }
    for (int k = 0; k < 10; ++k) CHECK(queue.push(datagram));
    CHECK_FALSE(queue.push(datagram));
    for (int k = 0; k < 10; ++k) CHECK(queue.pop(got));
    CHECK_FALSE(queue.pop(got));
  }
}

TEST_CASE("datagrams of any size go round the end of the memory in order", "[datagram_queue]") {
  DatagramQueue queue(5000);
  std::mt19937 random(7);
  std::deque<std::string> inside;
  int refused = 0;
  for (int k = 0; k < 20'000; ++k) {
    const std::string payload(random() % 900, static_cast<char>(k));
    if (queue.push({std::chrono::nanoseconds(k), {}, {}, payload, false}))
      inside.push_back(payload);
    else
      ++refused;
    // Never empty for long stretches, so that it goes round.
    while (inside.size() > 1 + random() % 8) {
      Datagram got;
      REQUIRE(queue.pop(got));
      REQUIRE(got.payload == inside.front());
      inside.pop_front();
    }
  }
  CHECK(refused > 0);
  CHECK(queue.overflows() == static_cast<std::uint64_t>(refused));
}

TEST_CASE("a consumer that keeps up needs the first part of the memory only", "[datagram_queue]") {
  const auto resident = [] {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages;
    return pages * 4096;
  };
  const auto before = resident();
  DatagramQueue queue(64 << 20);
  const std::string payload(1000, 'x');
  Datagram got;
  for (int k = 0; k < 200'000; ++k) {
    REQUIRE(queue.push({0ns, {}, {}, payload, false}));
    if (k % 50 == 0)
      while (queue.pop(got)) {
      }
  }
  CHECK(resident() < before + (32 << 20));
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
