// Writes sweepd.1, sweepd.toml.5 and the completion for bash from the tables that sweepd reads its
// command line and its settings by. Runs while sweepd is built.
//
//   sweepd_manual SOURCE_FOLDER OUTPUT_FOLDER DATE

#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "daemon/commands/bash_completion.hpp"
#include "daemon/commands/command_line.hpp"
#include "daemon/commands/manual.hpp"

namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

void write_all(const fs::path& source, const fs::path& output, const std::string& date) {
  using namespace sweepd;
  const auto program = command_text(CommandLine().app());
  write(output / "sweepd.1",
        manual_page(content(source / "sweepd.1.in"), {{"DATE", date},
                                                      {"VERSION", SWEEPD_VERSION},
                                                      {"OPTIONS", options_roff(program)},
                                                      {"COMMANDS", commands_roff(program)}}));
  write(output / "sweepd.toml.5",
        manual_page(content(source / "sweepd.toml.5.in"),
                    {{"DATE", date},
                     {"VERSION", SWEEPD_VERSION},
                     {"ROBOT_KEYS", settings_roff("[[robot]]", robot_options())},
                     {"HTTP_KEYS", settings_roff("[http]", http_options())}}));
  write(output / "sweepd.bash", bash_completion(program));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4)
      throw std::runtime_error("usage: sweepd_manual SOURCE_FOLDER OUTPUT_FOLDER DATE");
    write_all(argv[1], argv[2], argv[3]);
    return 0;
  } catch (const std::exception& problem) {
    std::cerr << "sweepd_manual: " << problem.what() << '\n';
    return 1;
  }
}
