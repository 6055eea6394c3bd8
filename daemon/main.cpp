#include <csignal>
#include <exception>
#include <iostream>
#include <stdexcept>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "daemon/command_line.hpp"
#include "daemon/config_error.hpp"
#include "daemon/log.hpp"
#include "rsi/ethernet_config.hpp"

namespace {

constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kConfigError = 78;  // EX_CONFIG of sysexits.h

int say(const std::exception& problem, int exit_code) {
  // In the journal as an error; it knows the program's name.
  if (sweepd::leads_to_journal())
    sweepd::Log().error("{}", problem.what());
  else
    std::cerr << "sweepd: " << problem.what() << '\n';
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  // A write that is refused says so by its result: a reader that went, a limit of file size.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  spdlog::set_default_logger(spdlog::stderr_color_mt("sweepd"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");

  try {
    return sweepd::CommandLine().execute(argc, argv);
  } catch (const sweepd::ConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const rsi::EthernetConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const std::invalid_argument& problem) {
    return say(problem, kUsage);
  } catch (const std::exception& problem) {
    return say(problem, kFailed);
  }
}
