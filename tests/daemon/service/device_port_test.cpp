#include "daemon/service/device_port.hpp"

#include <stdexcept>
#include <string>

#include "rsi/asio.hpp"

#include "tests/catch.hpp"
#include "tests/eventually.hpp"
#include "tests/free_port.hpp"

using boost::asio::ip::udp;
using Catch::Matchers::ContainsSubstring;
using sweepd::DevicePort;
using namespace std::chrono_literals;

TEST_CASE("A device's port that cannot be had is told, and had as soon as it can be",
          "[device_port]") {
  boost::asio::io_context context;
  const udp::endpoint place(boost::asio::ip::address_v4::loopback(),
                            sweepd::test::free_port_of<udp>());
  udp::socket taken(context, place);
  sweepd::DeviceSettings settings;
  settings.listen.endpoint = rsi::from_asio(place);
  settings.columns.text = "x_mm,y_mm,z_mm";
  DevicePort port(settings, 5ms);
  port.start();

  std::optional<DevicePort::News> news;
  const auto told = [&] { return (news = port.news()).has_value(); };
  REQUIRE(sweepd::test::eventually(told));
  CHECK(news->importance == sweepd::Importance::error);
  CHECK_THAT(news->text, ContainsSubstring("is in use by") &&
                             ContainsSubstring("the robot is served without its device"));
  rsi::Datagram datagram;
  CHECK_FALSE(port.pop(datagram));
  CHECK_FALSE(port.news());

  taken.close();
  REQUIRE(sweepd::test::eventually(told));
  CHECK(news->importance == sweepd::Importance::note);
  CHECK_THAT(news->text, ContainsSubstring("listening for a device on udp://127.0.0.1:"));
  udp::socket device(context, udp::v4());
  device.send_to(boost::asio::buffer(std::string("1,2,3\n")), place);
  CHECK(sweepd::test::eventually([&] { return port.pop(datagram); }));
  CHECK_FALSE(port.news());
}

TEST_CASE("A device's port that was never had ends at once", "[device_port]") {
  boost::asio::io_context context;
  const udp::socket taken(context, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  sweepd::DeviceSettings settings;
  settings.listen.endpoint = rsi::from_asio(taken.local_endpoint());
  settings.columns.text = "x_mm,y_mm,z_mm";
  {
    DevicePort port(settings, 1h);
    port.start();
  }
  settings.columns.text = "x_mm,y_parsec";
  CHECK_THROWS_AS(DevicePort(settings), std::invalid_argument);
}
