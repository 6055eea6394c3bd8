#include "identify/sweeps/sweep.hpp"

namespace identify {

std::string_view remedy(SweepDefect defect, bool linear) noexcept {
  switch (defect) {
    case SweepDefect::too_short:
      return linear ? "its strokes are shorter than 5 mm: move it further"
                    : "its arcs are shorter than 5°: sweep it further";
    case SweepDefect::too_few_samples:
      return "its sweeps have too few samples: move it slower";
    case SweepDefect::other_joint_moved:
      return "another joint moved along by more than 0.03°: move one joint at a time";
    case SweepDefect::not_an_arc:
      return linear ? "its positions do not lie on a line" : "its positions do not lie on a circle";
    case SweepDefect::none:
      break;
  }
  return "";
}

std::string_view code(SweepDefect defect) noexcept {
  switch (defect) {
    case SweepDefect::too_short:
      return "sweep_too_short";
    case SweepDefect::too_few_samples:
      return "too_few_samples";
    case SweepDefect::other_joint_moved:
      return "other_joint_moved";
    case SweepDefect::not_an_arc:
      return "not_an_arc";
    case SweepDefect::none:
      break;
  }
  return "";
}

}  // namespace identify
