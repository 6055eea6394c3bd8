#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include <poll.h>
#include <unistd.h>

#include "daemon/commands/command_line.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/atomic_file.hpp"
#include "daemon/system/log.hpp"
#include "daemon/text/text_layout.hpp"
#include "rsi/telegram/ethernet_config.hpp"

using sweepd::kConfigError;
using sweepd::kFailed;
using sweepd::kUsage;

namespace {

/// Whether standard error takes a line: `run` must not wait for one who does not read it.
bool is_read() {
  pollfd room{STDERR_FILENO, POLLOUT, 0};
  return ::poll(&room, 1, 2000) == 1;
}

int say(const std::exception& problem, int exit_code) {
  // In the journal as an error; it knows the program's name.
  if (sweepd::leads_to_journal())
    for (const auto& line : sweepd::lines_of(problem.what())) sweepd::Log().error("{}", line);
  const bool finished = sweepd::finish_log();
  if (!sweepd::leads_to_journal() && finished && is_read())
    std::cerr << "sweepd: " << problem.what() << '\n';
  // Else a thread stands in a write, perhaps for ever.
  if (!finished) std::_Exit(exit_code);
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  // A write that is refused says so by its result: a reader that went, a limit of file size.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  sweepd::delete_unfinished_on_signals();  // commands that go on serving take them over
  sweepd::log_at_once();

  try {
    return sweepd::CommandLine().execute(argc, argv);
  } catch (const sweepd::ConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const rsi::EthernetConfigError& problem) {
    return say(problem, kConfigError);
  } catch (const std::invalid_argument& problem) {
    return say(problem, kUsage);
  } catch (const std::filesystem::filesystem_error& problem) {
    return say(std::runtime_error(problem.path1().string() + ": " + problem.code().message() +
                                  ": check the path and the permissions"),
               kFailed);
  } catch (const std::exception& problem) {
    return say(problem, kFailed);
  }
}
