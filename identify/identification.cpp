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

}  // namespace identify
