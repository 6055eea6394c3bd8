#include "identify/identification.hpp"

namespace identify {

std::string_view text(Status status) noexcept {
  switch (status) {
    case Status::complete:
      return "complete";
    case Status::partial:
      return "partial";
    case Status::failed:
      return "failed";
  }
  return "";
}

std::string_view text(Estimator estimator) noexcept {
  return estimator == Estimator::chain ? "chain" : "circle";
}

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

}  // namespace identify
