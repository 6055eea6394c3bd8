#include <spdlog/fmt/fmt.h>

#include "daemon/results/poses_json.hpp"
#include "daemon/results/report.hpp"
#include "daemon/text/numbers.hpp"
#include "daemon/text/text_layout.hpp"
#include "daemon/text/units.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

using identify::JointEffect;

constexpr std::size_t kWho = 34;

std::string effect_line(const identify::EffectEvidence& seen) {
  const auto& effect = seen.effect;
  std::string line = right(std::to_string(effect.joint + 1), 5) + "  ";
  if (effect.kind == JointEffect::Kind::compliance)
    return line + left("gives way by its load", 24) + number(1e6 * effect.size(0), 3, 12) +
           number(1e6 * seen.sigma(0), 3, 10) + "  urad/Nm\n";
  const std::string what = effect.kind == JointEffect::Kind::weight
                               ? fmt::format("by the weight of link {}", effect.carried + 1)
                           : effect.kind == JointEffect::Kind::once ? "once a turn"
                                                                    : "twice a turn";
  return line + left(what, 24) + number(arcsec(effect.amplitude()), 2, 12) +
         number(arcsec(seen.sigma.maxCoeff()), 2, 10) + "  arcsec\n";
}

}  // namespace

std::string left_header() {
  return left("what is let go", kWho) + right("mean mm", 10) + right("rms mm", 10) +
         right("max mm", 10) + "\n";
}

std::string left_line(const std::string& who, const identify::Left& of) {
  return left(who, kWho) + number(of.mean_mm, 4, 10) + number(of.rms_mm, 4, 10) +
         number(of.most_mm, 4, 10) + "\n";
}

std::string poses_text(const identify::PoseEstimate& found) {
  const auto& noise = found.fit.noise;
  std::string text;
  text += paragraph("left        ",
                    fmt::format("mean {:.4f} mm, rms {:.4f} mm, max {:.4f} mm of {}",
                                found.left.mean_mm, found.left.rms_mm, found.left.most_mm,
                                rsi::counted(found.poses.size() - found.outliers.size(), "pose")));
  text +=
      paragraph("noise       ",
                fmt::format("{:.4f} mm in each coordinate, {:.2f} arcsec in each joint's angle "
                            "(1 sigma, a pose); gears err by {:.2f} arcsec once and twice a "
                            "turn (1 sigma of each size)",
                            noise.position_mm, arcsec(noise.joint_rad), arcsec(noise.gears_rad)) +
                    (arcsec(noise.weights_rad) >= 0.01
                         ? fmt::format("; links' weights bend joints by {:.2f} arcsec (1 sigma of "
                                       "each size)",
                                       arcsec(noise.weights_rad))
                         : std::string()) +
                    (noise.play_rad > 0
                         ? fmt::format("; joints play by {:.2f} arcsec (1 sigma, from one side to "
                                       "the other)",
                                       2 * arcsec(noise.play_rad))
                         : std::string()));
  text += paragraph("shown       ",
                    fmt::format("positions are predicted to {:.4f} mm (1 sigma, worst pose and "
                                "direction)",
                                found.observability.displacement_mm));
  if (!found.levels.empty()) {
    text += "\nWhat is left of these poses\n\n" + left_header();
    for (const auto& level : found.levels) text += left_line(words(level.freedom), level.left);
    text += left_line(found.effects.empty() ? "everything, weighed by its noise"
                                            : "and what joints do, see below",
                      found.left);
  }
  if (found.effects.empty()) return text;
  text += "\nWhat joints do beside what their angles say\n\n" + left("joint", 7) +
          left("what", 24) + right("size", 12) + right("1 sigma", 10) + "\n";
  for (const auto& one : found.effects) text += effect_line(one);
  return text;
}

}  // namespace sweepd
