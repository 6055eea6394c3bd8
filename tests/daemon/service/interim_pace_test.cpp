#include "daemon/service/interim_pace.hpp"

#include "tests/catch.hpp"

using namespace std::chrono_literals;
using sweepd::InterimPace;

TEST_CASE("interim results of all robots share a twentieth of one processor", "[interim_pace]") {
  const InterimPace::Steady::time_point start{};
  constexpr auto kTook = 100ms;
  InterimPace pace;
  CHECK(pace.due(start, 0ms, 1));
  pace.begin(start);
  // The first one is under way, however long it takes.
  CHECK_FALSE(pace.due(start + 1h, 0ms, 1));
  CHECK_FALSE(pace.due(start + 1999ms, kTook, 1));
  CHECK(pace.due(start + 2000ms, kTook, 1));
  // A hundred robots.
  CHECK_FALSE(pace.due(start + 199s, kTook, 100));
  CHECK(pace.due(start + 200s, kTook, 100));
  // Another session's first one is at once.
  pace.begin_session();
  CHECK(pace.due(start, kTook, 100));
}
