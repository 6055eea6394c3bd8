#include "daemon/service/published.hpp"

#include <atomic>
#include <thread>

#include "tests/catch.hpp"

TEST_CASE("a reader keeps what it has read while newer states are published", "[published]") {
  sweepd::Published<int> published(1);
  const auto first = published.newest();
  published.publish(2);
  CHECK(*first == 1);
  CHECK(*published.newest() == 2);
  CHECK(published.try_publish(3));
  CHECK(*published.newest() == 3);
}

TEST_CASE("a reader on another thread sees whole states, the newest at last", "[published]") {
  struct Pair {
    int a = 0, b = 0;
  };
  sweepd::Published<Pair> published;
  std::atomic<bool> torn = false;
  std::thread reader([&] {
    for (int last = 0; last < 10'000;) {
      const auto seen = published.newest();
      if (seen->a != seen->b || seen->a < last) torn = true;
      last = seen->a;
    }
  });
  for (int i = 1; i < 10'000; ++i) static_cast<void>(published.try_publish({i, i}));
  published.publish({10'000, 10'000});
  reader.join();
  CHECK_FALSE(torn);
}
