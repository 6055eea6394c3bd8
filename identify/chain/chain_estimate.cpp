#include "identify/chain/chain_estimate.hpp"

namespace identify {

std::string_view text(AngleTrust trust) noexcept {
  switch (trust) {
    case AngleTrust::trusted:
      return "trusted";
    case AngleTrust::smooth:
      return "smooth";
    case AngleTrust::free:
      return "free";
  }
  return "";
}

std::string_view text(Cause cause) noexcept {
  switch (cause) {
    case Cause::noise:
      return "noise";
    case Cause::home:
      return "home";
    case Cause::drift:
      return "drift";
    case Cause::figure:
      return "figure";
    case Cause::offset:
      return "offset";
    case Cause::print:
      return "print";
    case Cause::sag:
      return "sag";
  }
  return "";
}

}  // namespace identify
