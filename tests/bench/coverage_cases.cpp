#include "tests/bench/coverage_cases.hpp"

#include <utility>

namespace coverage {
namespace {

using simulation::Strokes;
using simulation::World;
using Gears = Aim::Gears;

constexpr double kTracker_mm = 0.02;

/// A device that knows no angles.
World tracker() {
  World world;
  world.placed = true;
  world.noise.range_mm = world.noise.across_mm = kTracker_mm;
  return world;
}

/// A device beside a controller's angles.
World with_angles() {
  World world = tracker();
  world.angles = true;
  world.decimals = 4;
  return world;
}

World telegrams(int decimals, bool wobble) {
  World world;
  world.controller = true;
  world.orientations = true;
  world.angles = true;
  world.decimals = decimals;
  if (wobble) world.wobble_deg = 0.0005;
  return world;
}

World with_gears(double first_arcsec, double second_arcsec) {
  World world = with_angles();
  world.gears.first_arcsec = first_arcsec;
  world.gears.second_arcsec = second_arcsec;
  return world;
}

World with_home_error(double sigma_deg) {
  World world = tracker();
  world.home.sigma_deg = sigma_deg;
  return world;
}

/// Everything of the list but sag, which no residual shows from one home.
World everything() {
  World world = with_angles();
  world.wobble_deg = 0.0005;
  world.noise.range_mm = 0.005;
  world.noise.correlation = 0.9;
  world.noise.outlier_share = 0.05;
  world.drift.walk_mm = 0.05;
  world.home.sigma_deg = 0.002;
  world.gears = {20, 10, 30, {}};
  world.delay.late_s = 0.1;
  return world;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](std::string name, std::string about, const World& world,
                       Strokes strokes = {}, std::size_t targets = 1, Aim aim = {}) {
    all.push_back(
        {std::move(name), std::move(about), world, std::move(strokes), targets, aim, 1, false});
  };
  Strokes back;
  back.there_and_back = true;
  back.ramp = 0.1;
  Strokes two_homes;
  two_homes.homes = 2;
  Strokes repeats;
  repeats.repeats = 3;
  Strokes back_and_again = back;
  back_and_again.repeats = 3;
  Strokes at_once;
  at_once.targets_at_once = true;

  add("white", "a device of 0.02 mm, no angles", tracker());
  World world = tracker();
  world.noise.correlation = 0.9;
  add("ar1", "its errors are AR(1) with 0.9", world);
  for (const bool wobble : {false, true})
    for (const int decimals : {4, 3, 2, 1})
      add(std::string(wobble ? "wobble_" : "telegrams_") + std::to_string(decimals),
          "a controller's telegrams of " + std::to_string(decimals) + " decimals, " +
              (wobble ? "servo wobble 0.0005 deg" : "no wobble"),
          telegrams(decimals, wobble));
  for (const int decimals : {3, 2, 1})
    add("telegrams_two_homes_" + std::to_string(decimals),
        "a controller's telegrams of " + std::to_string(decimals) + " decimals, two homes",
        telegrams(decimals, true), two_homes);
  for (const int decimals : {4, 3, 2, 1}) {
    add("aligned_" + std::to_string(decimals),
        "the same, wobble, at home as drawn, where axes lie along the frame's",
        telegrams(decimals, true));
    all.back().as_drawn = true;
  }
  for (const int decimals : {3, 2, 1}) {
    world = with_angles();
    world.decimals = decimals;
    world.home.sigma_deg = 0.002;
    add("angles_" + std::to_string(decimals),
        "a device beside angles of " + std::to_string(decimals) + " decimals, 0.002 deg", world,
        back);
  }
  for (const auto& [name, sigma] :
       {std::pair("0005", 0.0005), std::pair("002", 0.002), std::pair("005", 0.005)}) {
    const std::string what = "locked joints off by 0." + std::string(name) + " deg each stroke";
    add(std::string("home_") + name, what, with_home_error(sigma));
    add(std::string("home_") + name + "_targets", what + ", three targets one after the other",
        with_home_error(sigma), {}, 3);
  }
  add("home_002_markers", "0.002 deg, three targets seen in one stroke", with_home_error(0.002),
      at_once, 3);
  add("home_002_back", "0.002 deg, there and back", with_home_error(0.002), back);
  world = with_home_error(0.002);
  world.home.lasts = identify::HomeLasts::stand;
  add("home_002_stands", "0.002 deg until another joint sweeps, there and back", world, back);
  world.home.lasts = identify::HomeLasts::rest;
  add("home_002_rests_once", "0.002 deg until the joint itself sweeps", world);
  add("home_002_rests_markers", "the same, three targets seen in one stroke", world, at_once, 3);
  Strokes rounds = back;
  rounds.rounds = 2;
  add("home_002_rests", "0.002 deg until the joint itself sweeps, there and back, all twice", world,
      rounds);
  world = with_home_error(0.0005);
  world.home.creep_deg = 0.002;
  add("creep_002", "joints go on by 0.002 deg while another one sweeps, there and back", world,
      back);
  world.home.creep_deg = 0.01;
  add("creep_010", "joints go on by 0.01 deg while another one sweeps, there and back", world,
      back);
  add("home_002_repeats", "0.002 deg, every sweep three times", with_home_error(0.002), repeats);
  world = with_angles();
  world.home = {.sigma_deg = 0.0005, .seen = true, .stray_sigma_deg = 0.05, .joint = {}};
  add("strays", "a joint comes back 0.05 deg elsewhere, as its angle says", world);
  for (const int size : {0, 20, 60}) {
    const World gears = with_gears(size, size / 2.0);
    const Aim aim = {93, 97, size > 0 ? Gears::with_error : Gears::perfect};
    const std::string what = "transmission error " + std::to_string(size) + " + " +
                             std::to_string(size / 2) + " arcsec, ";
    add("one_home_" + std::to_string(size), what + "one home", gears, {}, 1, aim);
    add("two_homes_" + std::to_string(size), what + "two homes", gears, two_homes, 1, aim);
  }
  for (const int size : {20, 60}) {
    world = with_gears(size, size / 2.0);
    world.noise.decimals = 1;
    add("coarse_" + std::to_string(size),
        "transmission error " + std::to_string(size) + " + " + std::to_string(size / 2) +
            " arcsec, a device that prints 0.1 mm",
        world, {}, 1, {93, 97, Gears::with_error});
  }
  add("eccentricity", "50 arcsec once a turn", with_gears(50, 0), {}, 1,
      {93, 97, Gears::with_large});
  world = with_angles();
  world.gears.backlash_arcsec = 30;
  add("backlash", "30 arcsec, there and back", world, back, 1, {93, 97, Gears::with_backlash});
  world.gears.play_as_left = true;
  add("backlash_left", "30 arcsec, locked joints as their sweeps left them, there and back", world,
      back, 1, {93, 97, Gears::with_backlash});
  World plain = tracker();
  plain.gears = world.gears;
  add("play_left", "the same one way, no angles", plain, {}, 1);
  world.gears.joint = 2;
  add("backlash_left_3", "the same there and back, joint 3 alone plays", world, back, 1,
      {93, 97, Gears::with_backlash});
  for (const bool plays : {false, true}) {
    world = with_angles();
    world.home.sigma_deg = 0.005;
    if (plays) world.gears.backlash_arcsec = 60;
    add(plays ? "backlash_home" : "angles_home",
        std::string("locked joints off by 0.005 deg each stroke, ") +
            (plays ? "backlash 60 arcsec, " : "") + "angles, there and back three times",
        world, back_and_again, 1, {93, 97, plays ? Gears::with_backlash : Gears::perfect});
  }
  for (const bool walk : {false, true}) {
    world = tracker();
    (walk ? world.drift.walk_mm : world.drift.linear_mm) = 0.05;
    add(walk ? "drift_walk" : "drift", walk ? "0.05 mm, a random walk" : "0.05 mm, evenly", world);
    if (walk) add("drift_walk_back", "the same, there and back", world, back);
  }
  for (const bool warms : {false, true}) {
    world = tracker();
    (warms ? world.drift.warm_mm : world.drift.sway_mm) = 0.2;
    add(warms ? "drift_warm" : "drift_sway",
        warms ? "0.2 mm while it warms up, there and back"
              : "0.2 mm to and fro once, there and back",
        world, back);
  }
  for (const bool again : {false, true}) {
    world = tracker();
    world.drift.moved_mm = 0.1;
    add(again ? "moved_back" : "moved",
        std::string("a device moved by 0.1 mm half way through") +
            (again ? ", there and back" : ""),
        world, again ? back : Strokes{});
  }
  world = tracker();
  world.noise.range_mm = 0.005;
  world.noise.across_mm = 0.03;
  add("anisotropic", "0.005 mm along the line of sight, 0.03 across", world);
  for (const int percent : {5, 15}) {
    world = tracker();
    world.noise.outlier_share = percent / 100.0;
    add("outliers_" + std::to_string(percent), std::to_string(percent) + " % off by 5 mm", world);
  }
  for (const int ms : {4, 100, 500}) {
    world = with_angles();
    world.delay.late_s = ms / 1000.0;
    add("delay_" + std::to_string(ms), "angles late by " + std::to_string(ms) + " ms", world, back);
  }
  world = with_angles();
  world.delay = {0.02, 50};
  add("clock", "angles late by 20 ms, the device's clock off by 50 ppm", world, back);
  world = tracker();
  world.shape.rms_mm = 0.02;
  add("arcs", "arcs that are no circles, 0.02 mm rms", world);
  world.shape.rms_mm = 0.05;
  add("arcs_back", "arcs that are no circles, 0.05 mm rms, there and back", world, back);
  for (const int size : {30, 60, 100}) {
    world = tracker();
    world.sag_arcsec = size;
    add("sag_" + std::to_string(size), "sag of " + std::to_string(size) + " arcsec, no angles",
        world, {}, 1, {90, 100});
    world.sag_told = true;
    add("sag_" + std::to_string(size) + "_told",
        "the same, its standard deviation in the description", world, {}, 1, {90, 100});
  }
  world = with_angles();
  world.sag_arcsec = 100;
  add("sag_two_homes", "sag of 100 arcsec, angles, two homes", world, two_homes, 1,
      {90, 100, Gears::with_error});
  add("everything",
      "AR(1), anisotropic, 5 % outliers, drift, home error 0.002 deg, gears 20 + 10 arcsec, "
      "backlash 30, delay 100 ms, there and back",
      everything(), back, 1, {90, 98, Gears::with_error});
  Strokes most = back;
  most.homes = 2;
  add("everything_homes", "the same from two homes", everything(), most, 1,
      {90, 98, Gears::with_error});
  world = everything();
  world.sag_arcsec = 30;
  world.shape.rms_mm = 0.01;
  world.home.stray_sigma_deg = 0.02;
  world.delay.rate_ppm = 50;
  add("everything_two_homes", "the same, and sag 30 arcsec, arcs no circles, strays, clock", world,
      most, 1, {90, 98, Gears::with_error});
  Strokes often;
  often.repeats = 16;
  const auto add_stream = [&](const std::string& name, const std::string& about,
                              const World& repeated, const Aim& aim = {}) {
    add("long_" + name, about + ", every sweep 16 times", repeated, often, 1, aim);
    add("stream_" + name, "the same, memory for an eighth", repeated, often, 1, aim);
    all.back().kept = 0.125;
  };
  add_stream("white", "no angles", tracker());
  add_stream("telegrams", "a controller's telegrams of 4 decimals, wobble", telegrams(4, true));
  add_stream("home_002", "0.002 deg", with_home_error(0.002));
  add_stream("gears", "transmission error 20 + 10 arcsec", with_gears(20, 10),
             {93, 97, Gears::with_error});
  world = tracker();
  world.noise.range_mm = 0.005;
  world.noise.across_mm = 0.03;
  world.noise.correlation = 0.9;
  world.noise.outlier_share = 0.05;
  world.home.sigma_deg = 0.0005;
  world.drift.walk_mm = 0.05;
  add_stream("all", "AR(1), anisotropic, 5 % outliers, home error 0.0005 deg, drift", world,
             {90, 98});
  return all;
}

}  // namespace

const std::vector<Case>& all_cases() {
  static const std::vector<Case> kAll = cases();
  return kAll;
}

const std::vector<std::string>& all_arms() {
  static const std::vector<std::string> kAll = {"kr5", "iiwa", "paper"};
  return kAll;
}

simulation::Robot robot_of(const std::string& arm, std::size_t targets, std::uint32_t seed,
                           bool as_drawn) {
  if (arm == "paper") return simulation::kr5(targets);
  const auto robot = arm == "iiwa" ? simulation::iiwa(targets) : simulation::kr5(targets);
  const auto built = simulation::built(robot, seed);
  return as_drawn ? built : simulation::at_random_home(built, seed);
}

}  // namespace coverage
