// A program's .dat file. Only a KrlError comes out. What is read lies in the file; with all points
// left as they are the file comes back, and with all corrected all but numbers of points is there.
#include <algorithm>

#include "daemon/krl/corrected_program.hpp"
#include "daemon/krl/krl_position.hpp"
#include "tests/fuzz/property.hpp"

using fuzz::expect;

namespace {

/// An arm with a wrist, a little off what is specified.
struct Arm {
  identify::PlacedArm controller;
  identify::PoseFit identified;
  sweepd::ProgramOptions options;

  Arm() {
    constexpr double kRight = identify::kPi / 2;
    controller.arm.rows = {{400, 0, 180, kRight},  {0, kRight, 600, 0},
                           {0, 0, 120, kRight},    {620, 2 * kRight, 0, kRight},
                           {0, kRight, 0, kRight}, {0, 0, 0, 0}};
    controller.arm.home_rad.assign(6, 0);
    controller.arm.positive.assign(6, -1);
    controller.targets_mm = {{200, 0, 215}};
    identify::PlacedArm built = controller;
    built.arm.rows[1].a_mm += 0.4;
    built.arm.rows[2].theta_rad += 0.001;
    identified.model.chain = built.chain();
    identified.model.home_rad = built.arm.home_rad;
    const auto count = identified.model.parameters();
    identified.covariance = Eigen::MatrixXd::Zero(count, count);
    identified.noise.position_mm = 0.01;
    options.base = options.tool = Eigen::Isometry3d::Identity();
    options.largest_shift_mm = 100;
  }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Arm kArm;
  const auto text = fuzz::text(data, size);
  try {
    const auto all = sweepd::krl_aggregates(text);
    for (const auto& one : all)
      for (const auto& field : one.fields) {
        expect(field.at + field.text.size() <= text.size(), "a value lies in the file");
        expect(text.compare(field.at, field.text.size(), field.text) == 0,
               "and is what stands there");
      }
    auto leave = kArm.options;
    for (const auto& one : all) leave.leave.push_back(one.name);
    try {
      expect(sweepd::corrected_program(text, kArm.identified, kArm.controller, leave).text == text,
             "what is left stays");
    } catch (const sweepd::KrlError&) {
    }
    const auto program =
        sweepd::corrected_program(text, kArm.identified, kArm.controller, kArm.options);
    const auto lines = [](const std::string& of) { return std::count(of.begin(), of.end(), '\n'); };
    expect(lines(program.text) == lines(std::string(text)), "lines stay");
    expect(sweepd::krl_aggregates(program.text).size() == all.size(), "aggregates stay");
  } catch (const sweepd::KrlError&) {
  }
  return 0;
}
