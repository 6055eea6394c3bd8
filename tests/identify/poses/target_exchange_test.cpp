#include "identify/poses/target_exchange.hpp"

#include <functional>

#include "identify/identification.hpp"
#include "tests/catch.hpp"
#include "tests/identify/poses/judged_poses.hpp"

using namespace identify;
using namespace simulation::robots;
using Catch::Matchers::ContainsSubstring;

namespace {

void check_told(const Identification& found) {
  INFO(found.reason);
  CHECK((found.status == Status::doubtful || found.status == Status::failed));
  REQUIRE_FALSE(found.doubts.empty());
  CHECK(found.doubts.front().code == "targets_exchanged");
  CHECK_THAT(found.doubts.front().message, ContainsSubstring("names look exchanged"));
}

}  // namespace

TEST_CASE("Targets whose names are exchanged in some poses are told as that", "[target_exchange]") {
  const auto built = arm_with(tracker(), 4, 2);
  const auto exchanged = [&](const std::function<bool(std::size_t)>& rest) {
    auto poses = seen_together(built, 40, 4);
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (rest(i / 2)) poses[i].target = 1 - poses[i].target;
    return identify::identify({}, built.campaign(), poses);
  };
  check_told(exchanged([](std::size_t rest) { return rest >= 28; }));
  check_told(exchanged([](std::size_t rest) { return rest % 5 == 0; }));
  CHECK(exchanged([](std::size_t) { return false; }).doubts.empty());
}

TEST_CASE("Targets that have each other's names beside sweeps are told as that",
          "[target_exchange]") {
  const auto built = arm_with(tracker(), 4, 2);
  auto poses = seen_together(built, 20, 4);
  for (Pose& pose : poses) pose.target = 1 - pose.target;
  check_told(identify::identify(built.sweeps(), built.campaign(), poses));
}
