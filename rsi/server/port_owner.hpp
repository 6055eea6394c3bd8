#pragma once

#include <string>
#include <string_view>

#include "rsi/endpoint.hpp"

namespace rsi {

enum class Transport { udp, tcp };

/// "UDP" or "TCP".
[[nodiscard]] std::string text(Transport transport);

/// The program that has a port of this machine, as "name (process 1234)"; empty if there is none or
/// this program may not know (another user's). From /proc.
[[nodiscard]] std::string port_owner(Transport transport, const Endpoint& local);

/// Why this program cannot listen there, and what to do, in a sentence. `error`: the errno of bind.
/// `other_port`: how another port is chosen, after "or".
[[nodiscard]] std::string cannot_listen(
    Transport transport, const Endpoint& local, int error,
    std::string_view other_port = "choose another port here and in the controller's Ethernet file");

}  // namespace rsi
