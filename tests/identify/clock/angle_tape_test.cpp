#include "identify/clock/angle_tape.hpp"

#include <cmath>

#include "tests/catch.hpp"

using Catch::Matchers::WithinAbs;

namespace {

identify::Sample told(double time_s, double angle_rad, std::uint8_t joints = 2) {
  identify::Sample sample;
  sample.time_s = time_s;
  sample.joints = joints;
  sample.angles_rad[1] = angle_rad;
  return sample;
}

}  // namespace

TEST_CASE("Between its samples a tape goes as smoothly as a joint does", "[angle_tape]") {
  identify::AngleTape tape(2);
  for (int i = 0; i < 500; ++i) tape.add(told(0.012 * i, std::sin(0.012 * i)));
  // The cubic's error is 9/384 h^4 of the fourth derivative.
  for (double t = 0.1; t < 5.9; t += 0.0317)
    CHECK_THAT((*tape.at(t))[1], WithinAbs(std::sin(t), 1e-9));
  CHECK_FALSE(tape.at(-0.001));
  CHECK_FALSE(tape.at(6));
  CHECK_THAT((*tape.mean(1, 2))[1], WithinAbs(std::cos(1.0) - std::cos(2.0), 1e-2));
  CHECK_FALSE(tape.mean(7, 8));
}

TEST_CASE("A tape tells nothing in a gap, and takes nothing that is out of order or incomplete",
          "[angle_tape]") {
  identify::AngleTape tape(2);
  for (const double t : {0.0, 0.1, 0.2, 0.1, 0.9, 1.0}) tape.add(told(t, t));
  tape.add(told(1.1, 5, 1));
  CHECK(tape.size() == 5);
  CHECK_FALSE(tape.at(0.5));
  CHECK_THAT((*tape.at(0.15))[1], WithinAbs(0.15, 1e-12));
  CHECK_THAT((*tape.at(0.95))[1], WithinAbs(0.95, 1e-12));
}

TEST_CASE("A tape that is full keeps every second sample, of all of its time", "[angle_tape]") {
  identify::AngleTape tape(2, 100);
  for (int i = 0; i < 1000; ++i) tape.add(told(0.01 * i, 0.01 * i));
  CHECK(tape.size() <= 100);
  CHECK(tape.size() > 50);
  CHECK_THAT((*tape.at(7.123))[1], WithinAbs(7.123, 1e-9));
  CHECK_THAT(tape.time_s().front(), WithinAbs(0, 1e-12));
}
