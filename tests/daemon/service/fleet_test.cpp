#include "daemon/service/fleet.hpp"

#include <optional>

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "daemon/settings/toml_table.hpp"
#include "tests/catch.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/eventually.hpp"

using boost::asio::ip::udp;
using Catch::Matchers::ContainsSubstring;
using sweepd::Fleet;
using sweepd::RobotSettings;
using sweepd::ServiceStatus;
using namespace sweepd::test;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

RobotSettings settings(const std::string& name, const TemporaryFolder& folder) {
  spdlog::set_level(spdlog::level::off);
  RobotSettings robot;
  robot.name = name;
  robot.description = kConfig / "robots/kr5_arc.toml";
  robot.listen = {*rsi::parse_address("127.0.0.1"), 0};
  robot.output = folder / "out";
  robot.real_time.wish = sweepd::RealTime::off;
  return robot;
}

std::vector<std::string> served(const Fleet& fleet) {
  ServiceStatus status;
  fleet.tell(status);
  std::vector<std::string> names;
  for (const auto& robot : status.robots) names.push_back(robot->state.newest()->name);
  return names;
}

std::string reason(const Fleet& fleet, const std::string& robot) {
  ServiceStatus status;
  fleet.tell(status);
  for (const auto& each : status.not_served)
    if (each.robot == robot) return each.reason;
  return {};
}

bool ends(Fleet& fleet) {
  fleet.let_all_go();
  return eventually([&] { return fleet.gone() && fleet.finished(); }) && fleet.complete();
}

/// A file on a disk that does not answer: whoever opens it waits until this goes.
class HungFile {
 public:
  explicit HungFile(fs::path path) : path_(std::move(path)) {
    REQUIRE(::mkfifo(path_.c_str(), 0600) == 0);
  }
  ~HungFile() {
    const int answer = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    fs::remove(path_);
    ::close(answer);
  }
  HungFile(const HungFile&) = delete;
  HungFile& operator=(const HungFile&) = delete;

 private:
  fs::path path_;
};

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("a robot that cannot be served keeps no other from it, and is served once it can be",
          "[fleet][issue11][point_7]") {
  const TemporaryFolder folder;
  boost::asio::io_context context;
  std::optional<udp::socket> other(std::in_place, context,
                                   udp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
  auto no_port = settings("port", folder);
  no_port.listen.port = other->local_endpoint().port();
  auto no_folder = settings("folder", folder);
  no_folder.output = folder.write("file", "") / "out";

  Fleet fleet({settings("arc", folder), no_port, no_folder});
  REQUIRE(eventually([&] { return fleet.settled(); }));
  CHECK_FALSE(fleet.mistake());
  CHECK_FALSE(fleet.all_failed());
  CHECK(served(fleet).empty());
  fleet.serve();
  REQUIRE(eventually([&] { return fleet.settled(); }));
  CHECK(served(fleet) == Names{"arc"});
  CHECK(fleet.beats().size() == 1);
  CHECK_THAT(reason(fleet, "port"), ContainsSubstring("in use by this program itself"));
  CHECK_THAT(reason(fleet, "folder"), ContainsSubstring("cannot make the folder"));

  other.reset();
  CHECK(eventually([&] { return served(fleet) == Names{"arc", "port"}; }));
  fs::remove(folder / "file");
  CHECK(eventually([&] { return served(fleet) == Names{"arc", "folder", "port"}; }));
  CHECK(ends(fleet));
}

TEST_CASE("that no robot at all can be served is an error, and so is a mistake in a file",
          "[fleet][issue11][point_7]") {
  const TemporaryFolder folder;
  auto no_folder = settings("folder", folder);
  no_folder.output = folder.write("file", "") / "out";
  Fleet none({no_folder});
  REQUIRE(eventually([&] { return none.settled(); }));
  REQUIRE(none.all_failed());
  CHECK_THAT(none.all_failed()->text, ContainsSubstring("cannot make the folder"));
  CHECK_FALSE(none.mistake());

  auto wrong = settings("wrong", folder);
  wrong.description = folder.write("robot.toml", "home_deg = 1\n");
  Fleet one({settings("arc", folder), wrong});
  REQUIRE(eventually([&] { return one.settled(); }));
  REQUIRE(one.mistake());
  CHECK(one.mistake()->is_mistake);
  CHECK_FALSE(one.all_failed());
}

TEST_CASE("robots come, go and change places while others are served",
          "[fleet][issue11][point_7]") {
  const TemporaryFolder folder;
  const auto arc = settings("arc", folder);
  auto first = settings("first", folder);
  {
    boost::asio::io_context context;
    const udp::socket free(context, {boost::asio::ip::address_v4::loopback(), 0});
    first.listen.port = free.local_endpoint().port();
  }
  Fleet fleet({arc, first});
  fleet.serve();
  REQUIRE(eventually([&] { return served(fleet) == Names{"arc", "first"}; }));

  auto second = first;  // another name, the same port
  second.name = "second";
  fleet.reload({arc, second});
  CHECK(eventually([&] { return served(fleet) == Names{"arc", "second"}; }));

  auto wrong = settings("wrong", folder);
  wrong.description = folder.write("robot.toml", "home_deg = 1\n");
  fleet.reload({arc, second, wrong});
  REQUIRE(eventually([&] { return fleet.settled(); }));
  CHECK(served(fleet) == Names{"arc", "second"});
  CHECK_THAT(reason(fleet, "wrong"), ContainsSubstring("robot.toml:1:"));
  wrong.description = arc.description;
  fleet.reload({arc, second, wrong});
  CHECK(eventually([&] { return served(fleet) == Names{"arc", "second", "wrong"}; }));
  CHECK(ends(fleet));
}

TEST_CASE("a disk that does not answer holds up neither a start, nor a reload, nor the end",
          "[fleet][issue11][point_6][point_7]") {
  const TemporaryFolder folder;
  std::optional<HungFile> file(folder / "robot.toml");
  const auto arc = settings("arc", folder);
  auto hung = settings("hung", folder);
  hung.description = folder / "robot.toml";
  Fleet fleet({arc, hung});
  fleet.serve();
  CHECK(eventually([&] { return served(fleet) == Names{"arc"}; }));
  CHECK_FALSE(fleet.settled());
  CHECK_FALSE(fleet.all_failed());

  auto also_hung = arc;
  also_hung.description = hung.description;
  fleet.reload({also_hung});
  CHECK_FALSE(fleet.settled());
  CHECK(served(fleet) == Names{"arc"});

  fleet.let_all_go();
  CHECK(eventually([&] { return fleet.gone(); }));
  CHECK(fleet.complete());
  file.reset();
  CHECK(eventually([&] { return fleet.finished(); }));
}
