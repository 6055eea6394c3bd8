#pragma once

#include <memory>

#include "daemon/settings/settings.hpp"
#include "rsi/server/server.hpp"

namespace sweepd {

/// The server for a robot: over UDP or TCP, with the replies that its controller's Ethernet file
/// asks for; where `tap` is set, what listens to another program's. What is doubtful is logged.
/// Throws rsi::EthernetConfigError, ConfigError where it must not answer (see answers.hpp), or
/// std::runtime_error.
[[nodiscard]] std::unique_ptr<rsi::Server> make_server(const RobotSettings& settings);

}  // namespace sweepd
