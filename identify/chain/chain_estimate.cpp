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

std::string_view text(HomeLasts lasts) noexcept {
  switch (lasts) {
    case HomeLasts::stroke:
      return "stroke";
    case HomeLasts::stand:
      return "stand";
    case HomeLasts::rest:
      return "rest";
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
    case Cause::angles:
      return "angles";
    case Cause::height:
      return "height";
  }
  return "";
}

std::string_view words(Cause cause) noexcept {
  switch (cause) {
    case Cause::noise:
      return "noise of the samples";
    case Cause::home:
      return "locked joints off home";
    case Cause::drift:
      return "what drifted or was moved";
    case Cause::figure:
      return "arcs that are not quite circles";
    case Cause::offset:
      return "gears and load at other homes";
    case Cause::print:
      return "what printing leaves out";
    case Cause::sag:
      return "joints that give way to weight";
    case Cause::angles:
      return "joints off what their angles say";
    case Cause::height:
      return "how high base and target stand";
  }
  return "";
}

}  // namespace identify
