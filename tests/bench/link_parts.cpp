#include "tests/bench/link_parts.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/settings/robot_description.hpp"
#include "daemon/settings/sweep_plan.hpp"
#include "rsi/telegram/reply.hpp"
#include "tests/config_folder.hpp"
#include "tests/process_threads.hpp"

namespace bench {

using boost::asio::ip::udp;
using std::filesystem::path;
using sweepd::test::kEthernet;
using sweepd::test::kPlan;
using sweepd::test::kRobot;

namespace {

path proc(int process) {
  return path("/proc") / std::to_string(process);
}

/// Throws std::system_error unless everything was read or written.
template <typename Operation, typename Byte>
void transfer(Operation operation, int file, Byte* bytes, std::size_t size) {
  while (size > 0) {
    const auto done = operation(file, bytes, size);
    if (done <= 0) throw std::system_error(errno, std::generic_category(), "pipe to a child");
    bytes += done;
    size -= static_cast<std::size_t>(done);
  }
}

}  // namespace

const path& ethernet_file() {
  static const path file = kEthernet;
  return file;
}

sweepd::RobotSettings settings(const path& output, const std::string& name) {
  sweepd::RobotSettings settings;
  settings.name = name;
  settings.description = kRobot;
  settings.listen = {kLoopback, 0};
  settings.ethernet_config = ethernet_file();
  settings.output = output;
  settings.real_time.wish = sweepd::RealTime::off;
  return settings;
}

EchoServer::EchoServer(std::function<void()> prepare)
    : socket_(context_, {boost::asio::ip::address_v4::loopback(), 0}),
      reply_size_(
          rsi::Reply(rsi::EthernetConfig::load(ethernet_file())).with_ipoc("1525088").size()) {
  receive();
  thread_ = std::thread([this, prepare = std::move(prepare)] {
    if (prepare) prepare();
    context_.run();
  });
}

EchoServer::~EchoServer() {
  context_.stop();
  thread_.join();
}

void EchoServer::receive() {
  socket_.async_receive_from(
      boost::asio::buffer(buffer_), source_,
      [this](const boost::system::error_code& error, std::size_t size) {
        if (!error)
          socket_.send_to(boost::asio::buffer(buffer_, std::min(size, reply_size_)), source_);
        receive();
      });
}

Telegrams::Telegrams(Then then)
    : then_(then),
      writer_(rsi::EthernetConfig::load(ethernet_file()), 4),
      robot_(start()),
      ipoc_(1'525'084) {}

std::string_view Telegrams::next() {
  if (!robot_.next(values_) && then_ == Then::again) {
    robot_ = start();
    static_cast<void>(robot_.next(values_));
  }
  telegram_.clear();
  ipoc_ += static_cast<std::uint64_t>(kCycle.count());
  writer_.append(telegram_, values_, ipoc_);
  return telegram_;
}

sweepd::SimulatedRobot Telegrams::start() {
  return {sweepd::load_robot(kRobot), sweepd::load_plan(kPlan), {}};
}

double quantile_us(std::vector<std::chrono::nanoseconds>& times, double q) {
  if (times.empty()) return std::nan("");
  std::sort(times.begin(), times.end());
  const auto rank = std::ceil(q * static_cast<double>(times.size()));
  const auto at = std::max<std::size_t>(1, static_cast<std::size_t>(rank)) - 1;
  return std::chrono::duration<double, std::micro>(times[at]).count();
}

std::map<std::string, std::chrono::nanoseconds> processor_times(int process) {
  std::map<std::string, std::chrono::nanoseconds> times;
  for (const auto& thread : sweepd::test::threads_of(std::to_string(process))) {
    std::int64_t time = 0;
    std::ifstream(thread.proc / "schedstat") >> time;
    times[thread.name] += std::chrono::nanoseconds(time);
  }
  return times;
}

double resident_mb(int process) {
  std::uint64_t pages = 0;
  std::ifstream(proc(process) / "statm") >> pages >> pages;
  return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

std::size_t open_files(int process) {
  const std::filesystem::directory_iterator files(proc(process) / "fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

Child::Child(const std::function<void(const Ready&)>& serve) {
  std::array<int, 2> down{};
  std::array<int, 2> up{};
  if (pipe(down.data()) != 0 || pipe(up.data()) != 0)
    throw std::system_error(errno, std::generic_category(), "pipe");
  std::cout.flush();
  process_ = fork();
  if (process_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    close(down[1]);
    close(up[0]);
    int status = 1;
    try {
      serve([&](const std::vector<int>& numbers) {
        const std::size_t size = numbers.size();
        transfer(write, up[1], reinterpret_cast<const char*>(&size), sizeof size);
        transfer(write, up[1], reinterpret_cast<const char*>(numbers.data()), size * sizeof(int));
        char end = 0;
        static_cast<void>(!read(down[0], &end, 1));
      });
      status = 0;
    } catch (const std::exception& error) {
      std::cerr << "server: " << error.what() << '\n';
    }
    _exit(status);
  }
  close(down[0]);
  close(up[1]);
  to_child_ = down[1];
  try {
    std::size_t size = 0;
    transfer(read, up[0], reinterpret_cast<char*>(&size), sizeof size);
    numbers_.resize(size);
    transfer(read, up[0], reinterpret_cast<char*>(numbers_.data()), size * sizeof(int));
  } catch (...) {
    close(up[0]);
    end();
    throw;
  }
  close(up[0]);
}

Child::~Child() {
  end();
}

void Child::stop() {
  if (end() != 0) throw std::runtime_error("a server failed");
}

int Child::end() noexcept {
  if (process_ < 0) return 0;
  close(to_child_);
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = -1;
  return status;
}

Load::Load() {
  for (unsigned i = std::thread::hardware_concurrency(); i > 0; --i) {
    const int process = fork();
    if (process < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (process == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (volatile unsigned work = 0;;) work = work + 1;
    }
    processes_.push_back(process);
  }
}

Load::~Load() {
  for (const int process : processes_) {
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
}

std::uint64_t counted(const path& output, const char* name) {
  // The counts go on from session to session: of each robot the greatest.
  std::map<path, std::uint64_t> robots;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(output)) {
    if (entry.path().filename() != "run.json") continue;
    std::ifstream file(entry.path());
    const auto run = nlohmann::json::parse(file);
    auto& most = robots[entry.path().parent_path().parent_path()];
    most = std::max(most, run.at("since_start_of_sweepd").value(name, std::uint64_t{0}));
  }
  std::uint64_t sum = 0;
  for (const auto& [robot, count] : robots) sum += count;
  return sum;
}

}  // namespace bench
