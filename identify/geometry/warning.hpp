#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace identify {

/// Something that the user should know; `code` is for programs and stays.
struct Warning {
  std::string code;
  std::optional<std::size_t> joint;  ///< counted from 0
  std::string message;
};

}  // namespace identify
