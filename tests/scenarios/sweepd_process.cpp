#include "tests/scenarios/sweepd_process.hpp"

#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "rsi/asio.hpp"

#include "tests/free_port.hpp"

namespace sweepd::test {

using namespace std::chrono_literals;

SweepdProcess::SweepdProcess(const std::vector<std::string>& arguments, const Launch& launch) {
  std::vector<std::string> words = launch.before;
  words.emplace_back(SWEEPD_BINARY);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::vector<std::string> given = launch.environment;
  std::vector<char*> environment;
  for (auto& variable : given) environment.push_back(variable.data());
  for (char** variable = environ; *variable != nullptr; ++variable)
    environment.push_back(*variable);
  environment.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, (folder_ / "out").c_str(), kNew, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, (folder_ / "errors").c_str(), kNew, 0600);
  const int failure = posix_spawnp(&id_, words.front().c_str(), &actions, nullptr, pointers.data(),
                                   environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::system_error(failure, std::generic_category(), words.front());
}

SweepdProcess::~SweepdProcess() {
  if (exit_code_ >= 0) return;
  kill(id_, SIGKILL);
  waitpid(id_, nullptr, 0);
}

void SweepdProcess::signal(int number) const {
  if (kill(id_, number) != 0) throw std::system_error(errno, std::generic_category(), "kill");
}

bool SweepdProcess::running() const {
  siginfo_t info{};
  return exit_code_ < 0 &&
         waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == 0;
}

int SweepdProcess::wait(std::chrono::seconds longest) {
  if (exit_code_ >= 0) return exit_code_;
  const auto deadline = std::chrono::steady_clock::now() + longest;
  while (running()) {
    if (std::chrono::steady_clock::now() > deadline)
      throw std::runtime_error("sweepd does not end; it said: " + errors());
    std::this_thread::sleep_for(1ms);
  }
  int status = 0;
  waitpid(id_, &status, 0);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return exit_code_;
}

Run run_sweepd(const std::vector<std::string>& arguments) {
  SweepdProcess process(arguments);
  const int code = process.wait();
  return {code, process.out(), process.errors()};
}

Daemon::Daemon(const std::filesystem::path& folder, Options options)
    : options_(std::move(options)),
      output_(folder / "output"),
      port_(free_port()),
      config_(folder / "sweepd.toml") {
  auto ethernet = content(kConfig / "controller/krc4/sweepd_ethernet.xml");
  ethernet.replace(ethernet.find("49152"), 5, std::to_string(port_));
  std::ofstream(folder / "ethernet.xml") << ethernet;
  std::ofstream(config_) << "[http]\nlisten = \"" << options_.pages
                         << "\"\n[[robot]]\nname = \"kr5-arc\"\ndescription = \""
                         << (kConfig / "robots/kr5_arc.toml").string() << "\"\nlisten = \""
                         << address()
                         << "\"\noutput = \"output\"\nethernet_config = \"ethernet.xml\"\n"
                         << options_.settings;
  start();
}

void Daemon::restart() {
  process_->signal(SIGTERM);
  process_->wait();
  start();
}

void Daemon::kill() {
  process_->signal(SIGKILL);
  process_->wait();
}

void Daemon::start() {
  process_ = std::make_unique<SweepdProcess>(
      std::vector<std::string>{"run", "--config", config_.string()}, options_.launch);
  const bool listens = eventually([&] {
    return !process_->running() ||
           process_->errors().find("listening on UDP " + address()) != std::string::npos;
  });
  if (!listens || !process_->running())
    throw std::runtime_error("sweepd run does not listen; it said: " + process_->errors());
}

std::filesystem::path Daemon::session() const {
  std::filesystem::path found;
  for (const auto& entry : std::filesystem::directory_iterator(output_ / "kr5-arc")) {
    if (!found.empty()) throw std::runtime_error("more than one session in " + output_.string());
    found = entry.path();
  }
  return found;
}

std::uint64_t figure(const std::string& report, const std::string& label) {
  const auto at = report.find(label);
  return at == std::string::npos ? 0 : std::stoull(report.substr(at + label.size()));
}

std::uint16_t free_tcp_port() {
  return free_port_of<boost::asio::ip::tcp>();
}

std::uint16_t free_port() {
  return free_port_of<boost::asio::ip::udp>();
}

std::filesystem::path write_short_plan(const TemporaryFolder& folder) {
  std::string plan =
      "home_deg = [90, -90, 90, 0, 90, 0]\npositioning_speed_deg_s = 120\n"
      "acceleration_deg_s2 = 1000\ndwell_ms = 180\n";
  const char* const starts[] = {"90", "-90", "90", "0", "90", "0"};
  const char* const ends[] = {"60", "-60", "60", "30", "60", "30"};
  for (std::size_t j = 0; j < 6; ++j)
    plan += "[[sweep]]\njoint = " + std::to_string(j + 1) + "\nstart_deg = " + starts[j] +
            "\nend_deg = " + ends[j] + "\nspeed_deg_s = 60\n";
  return folder.write("plan.toml", plan);
}

}  // namespace sweepd::test
