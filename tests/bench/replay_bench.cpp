// How fast replay is, result files included, against the least that any reader of RSI captures has
// to do: libpcap takes the packets from the file, pugixml parses each telegram, nothing is looked
// at.
//
// Each replay is a process of its own, as `sweepd replay` is, so that what it takes in memory at
// most is its own. A stream as long as a day's has 21,600,000 telegrams and takes 10 GB on the
// disk.
//
// The capture is what `sweepd simulate` writes with the shipped Ethernet file while the robot
// repeats the 90-degree plan: it hardly ever rests, so most telegrams end in a sweep, and all that
// do in sweeps.csv.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <pcap/pcap.h>
#include <pugixml.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/commands/replay_command.hpp"
#include "daemon/commands/simulate_command.hpp"
#include "daemon/plan/simulated_robot.hpp"
#include "daemon/settings/robot_description.hpp"
#include "daemon/text/numbers.hpp"
#include "rsi/capture/packet.hpp"
#include "tests/bench/table.hpp"
#include "tests/daemon/temporary_folder.hpp"

namespace {

using std::filesystem::path;

constexpr double kRatioAim = 0.5;
constexpr double kSpeedAim = 300'000;  // telegrams per second
constexpr std::uintmax_t kMemoryAim = 64'000'000;

const path kConfig = path(SWEEPD_SOURCE_DIR) / "config";
const path kRobot = kConfig / "robots/kr5_arc.toml";
const path kPlan = kConfig / "plans/kr5_arc_90deg.toml";

/// The shipped plan, its sweeps as often as it takes for so many telegrams.
void write_long_plan(const path& file, std::uint64_t telegrams) {
  const std::string text = sweepd::test::content(kPlan);
  const auto sweeps = text.find("\n[[sweep]]");
  if (sweeps == std::string::npos) throw std::runtime_error(kPlan.string() + ": has no sweeps");
  const auto once =
      sweepd::SimulatedRobot(sweepd::load_robot(kRobot), sweepd::load_plan(kPlan), {}).cycles();
  std::ofstream out(file);
  out << text;
  for (std::uint64_t done = once; done < telegrams; done += once) out << text.substr(sweeps);
}

void write_capture(const path& file, const path& plan) {
  sweepd::SimulateOptions options;
  options.robot = kRobot;
  options.plan = plan;
  options.write = file;
  options.quiet = true;
  if (sweepd::simulate(options) != 0) throw std::runtime_error("cannot write " + file.string());
}

/// Returns the number of telegrams.
std::uint64_t parse_barely(const path& capture) {
  char error[PCAP_ERRBUF_SIZE] = "";
  pcap_t* const reader = pcap_open_offline(capture.c_str(), error);
  if (reader == nullptr) throw std::runtime_error(error);
  pugi::xml_document document;
  std::uint64_t telegrams = 0;
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  while (pcap_next_ex(reader, &header, &bytes) == 1)
    if (document.load_buffer(bytes + rsi::packet_header_size,
                             header->caplen - rsi::packet_header_size))
      ++telegrams;
  pcap_close(reader);
  return telegrams;
}

void replay(const path& capture, const path& output) {
  sweepd::ReplayOptions options;
  options.traces = {capture};
  options.config = kConfig / "sweepd.toml";
  options.output = output;
  options.quiet = true;
  if (sweepd::replay(options) != 0) throw std::runtime_error("replay found no axis");
}

/// Does the work in a process of its own. Returns the bytes that it had in memory at most.
template <typename Work>
std::uintmax_t apart(const Work& work) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start a process");
  if (child == 0) {
    try {
      work();
    } catch (const std::exception& error) {
      std::cerr << "bench_replay: " << error.what() << std::endl;
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child || status != 0)
    throw std::runtime_error("what was to be measured failed");
  return static_cast<std::uintmax_t>(used.ru_maxrss) * 1024;  // Linux counts kilobytes
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::string megabytes(std::uintmax_t bytes) {
  return sweepd::fixed(static_cast<double>(bytes) * 1e-6, 0) + " MB";
}

std::string row(const std::string& name, double bare, double full, double ratio) {
  using bench::right;
  return name + right(bare / 1000, 0, 24 - name.size()) + right(full / 1000, 0, 17) +
         right(ratio, 2, 9);
}

void measure(std::uint64_t wanted, int rounds) {
  const sweepd::test::TemporaryFolder temporary;
  const path capture = temporary / "long.pcap";
  const path output = temporary / "results";
  apart([&] {
    write_long_plan(temporary / "long.toml", wanted);
    write_capture(capture, temporary / "long.toml");
  });
  // Also brings the capture into the page cache.
  const auto telegrams = parse_barely(capture);
  std::cout << "replay of " << telegrams << " telegrams (" << megabytes(file_size(capture))
            << "), in thousand telegrams per second\n"
            << "round     libpcap+pugixml    sweepd replay    ratio" << std::endl;

  std::vector<double> bare;
  std::vector<double> full;
  std::vector<double> ratios;
  const auto speed = [&](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    return static_cast<double>(telegrams) / time.count();
  };
  std::uintmax_t memory = 0;
  for (int round = 1; round <= rounds; ++round) {
    bare.push_back(speed([&] { parse_barely(capture); }));
    full.push_back(
        speed([&] { memory = std::max(memory, apart([&] { replay(capture, output); })); }));
    ratios.push_back(full.back() / bare.back());
    std::cout << row(std::to_string(round), bare.back(), full.back(), ratios.back()) << std::endl;
  }
  std::uintmax_t written = 0;
  for (const auto& entry : std::filesystem::directory_iterator(output))
    written += entry.file_size();
  std::cout << row("median", median(bare), median(full), median(ratios)) << '\n'
            << "aim" << bench::right(kSpeedAim / 1000, 0, 38) << bench::right(kRatioAim, 2, 9)
            << '\n'
            << "result files of each replay: " << megabytes(written) << '\n'
            << "memory of a replay at most: " << megabytes(memory) << " (aim "
            << megabytes(kMemoryAim) << ")\n";
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t telegrams = 1'000'000;
  int rounds = 7;
  CLI::App app("Replay throughput against a bare loop of libpcap and pugixml", "bench_replay");
  app.add_option("--telegrams", telegrams, "Telegrams in the capture, rounded up to whole plans")
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Each runs both, one after the other")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.footer("Capture and result files lie in TMPDIR, or /tmp.");
  CLI11_PARSE(app, argc, argv)
  try {
    measure(telegrams, rounds);
  } catch (const std::exception& error) {
    std::cerr << "bench_replay: " << error.what() << '\n';
    return 1;
  }
}
