#include "rsi/server/port_owner.hpp"

#include <cerrno>

#include <unistd.h>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"

using Catch::Matchers::ContainsSubstring;
using rsi::Transport;
using rsi::test::kLoopback;
namespace ip = boost::asio::ip;

namespace {

std::string this_program() {
  return "rsi_tests (process " + std::to_string(getpid()) + ")";
}

}  // namespace

TEST_CASE("the program that has a port is named", "[port_owner]") {
  boost::asio::io_context context;
  const ip::udp::socket udp(context, {ip::address_v4(kLoopback), 0});
  const auto port = udp.local_endpoint().port();
  CHECK(rsi::port_owner(Transport::udp, {kLoopback, port}) == this_program());
  CHECK(rsi::port_owner(Transport::udp, {0, port}) == this_program());
  CHECK(rsi::port_owner(Transport::udp, {0x7f000002, port}).empty());

  const ip::tcp::acceptor tcp(context, {ip::address_v4::any(), 0});
  CHECK(rsi::port_owner(Transport::tcp, {kLoopback, tcp.local_endpoint().port()}) ==
        this_program());
  const ip::udp::socket both(context, {ip::address_v6::any(), 0});
  CHECK(rsi::port_owner(Transport::udp, {kLoopback, both.local_endpoint().port()}) ==
        this_program());
}

TEST_CASE("why a port cannot be had is said with what to do", "[port_owner]") {
  boost::asio::io_context context;
  rsi::Endpoint place{kLoopback, 0};
  {
    const ip::udp::socket udp(context, {ip::address_v4(kLoopback), 0});
    place.port = udp.local_endpoint().port();
    CHECK(rsi::cannot_listen(Transport::udp, place, EADDRINUSE) ==
          "UDP " + rsi::text(place) +
              " is in use by this program itself: choose another port here and in the "
              "controller's Ethernet file");
    CHECK_THAT(rsi::cannot_listen(Transport::udp, place, EADDRINUSE, "choose another"),
               ContainsSubstring("itself: choose another") && !ContainsSubstring("controller"));
  }
  CHECK_THAT(rsi::cannot_listen(Transport::tcp, place, EADDRINUSE), ContainsSubstring("ss -ulptn"));
  CHECK_THAT(rsi::cannot_listen(Transport::tcp, place, EADDRNOTAVAIL),
             ContainsSubstring("cannot listen on TCP") && ContainsSubstring("0.0.0.0"));
  CHECK_THAT(rsi::cannot_listen(Transport::udp, {kLoopback, 502}, EACCES),
             ContainsSubstring("ports below 1024 are for the system: use a higher one"));
}
