// One controller, the next telegram as soon as the last is answered, in one stream after another
// from another port each. What a day brings must leave memory and files as they were.

#include <algorithm>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "daemon/service/robot_service.hpp"
#include "rsi/telegram/ipoc.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/bench/link_parts.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace bench {
namespace {

using boost::asio::ip::udp;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

sweepd::RobotSettings soak_settings(const fs::path& output) {
  auto robot = settings(output, "soak");
  robot.silence = 200ms;
  // At this pace a tenth of a second is half a minute of a controller's.
  robot.queue_bytes = std::size_t{64} << 20;
  robot.recording.memory_bytes = std::size_t{64} << 20;
  robot.recording.rotate_bytes = std::uint64_t{64} << 20;
  robot.recording.keep_bytes = std::uint64_t{512} << 20;
  return robot;
}

/// From a port of its own, as RSI has one after each start.
void stream(std::uint16_t port, std::uint64_t telegrams) {
  boost::asio::io_context context;
  udp::socket socket(context, udp::v4());
  socket.connect({boost::asio::ip::address_v4::loopback(), port});
  const timeval longest{10, 0};
  setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  Telegrams source(Telegrams::Then::rest);  // one campaign a stream, not a hundred
  rsi::Reply expected(rsi::EthernetConfig::load(ethernet_file()));
  std::array<char, 2048> buffer{};
  for (; telegrams > 0; --telegrams) {
    const auto telegram = source.next();
    socket.send(boost::asio::buffer(telegram.data(), telegram.size()));
    const auto size = recv(socket.native_handle(), buffer.data(), buffer.size(), 0);
    if (size < 0) throw std::runtime_error("no answer within ten seconds");
    if (std::string_view(buffer.data(), static_cast<std::size_t>(size)) !=
        expected.with_ipoc(rsi::find_ipoc(telegram)))
      throw std::runtime_error("a wrong reply");
  }
}

nlohmann::json json_in(const fs::path& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file, nullptr, false);
}

/// Waits for the end of the one session that there is and takes its folder away. The telegrams that
/// its result knows.
std::uint64_t end_session(const fs::path& sessions) {
  const auto deadline = Clock::now() + 10min;
  while (Clock::now() < deadline) {
    for (const auto& entry : fs::directory_iterator(sessions)) {
      const auto run = json_in(entry.path() / "run.json");
      if (!run.is_object() || !run.contains("ended")) continue;
      const auto result = json_in(entry.path() / "result.json");
      fs::remove_all(entry.path());
      return result.at("source").at("telegrams").get<std::uint64_t>();
    }
    std::this_thread::sleep_for(20ms);
  }
  throw std::runtime_error("a session does not end");
}

}  // namespace

void soak(std::uint64_t telegrams, std::uint64_t per_stream) {
  const sweepd::test::TemporaryFolder temporary;
  Child server([&](const Child::Ready& ready) {
    sweepd::RobotService service(soak_settings(temporary.path()));
    service.start();
    ready({service.local().port});
    service.stop();
  });
  const auto port = static_cast<std::uint16_t>(server.numbers().at(0));
  std::cout << "soak: telegrams as fast as they are answered, " << per_stream << " a stream\n"
            << "                               while it streams        when it has ended\n"
            << "telegrams   thousand/s    resident MB   files    resident MB   files\n"
            << std::string(11, ' ') << std::string(37, ' ')
            << right(resident_mb(server.process()), 1, 15)
            << right(std::to_string(open_files(server.process())), 8) << std::endl;
  std::vector<double> after;
  std::vector<std::size_t> files;
  std::uint64_t known = 0;
  for (std::uint64_t done = 0; done < telegrams;) {
    const auto count = std::min(per_stream, telegrams - done);
    const auto start = Clock::now();
    stream(port, count);
    const std::chrono::duration<double> took = Clock::now() - start;
    done += count;
    const double resident = resident_mb(server.process());
    const auto open = open_files(server.process());
    known += end_session(temporary.path() / "soak");
    after.push_back(resident_mb(server.process()));
    files.push_back(open_files(server.process()));
    std::cout << right(std::to_string(done), 9)
              << right(static_cast<double>(count) / took.count() / 1000, 1, 13)
              << right(resident, 1, 15) << right(std::to_string(open), 8)
              << right(after.back(), 1, 15) << right(std::to_string(files.back()), 8) << std::endl;
  }
  server.stop();
  std::cout << "in its results sweepd has " << known << " of " << telegrams << " telegrams"
            << (known == telegrams ? "" : "  MISSED") << '\n';
  if (after.size() < 2) return;
  const auto half = after.begin() + static_cast<std::ptrdiff_t>(after.size() / 2);
  const double growth =
      *std::max_element(half, after.end()) - *std::max_element(after.begin(), half);
  const bool flat = growth < 8 && files.back() == files.front();
  std::cout << "most in the second half of the streams over most in the first: "
            << right(growth, 1, 0) << " MB, " << files.front() << " and " << files.back()
            << " files: " << (flat ? "flat" : "NOT flat") << '\n';
}

}  // namespace bench
