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
// do in sweeps.csv. With --motion production all joints move at once all the time, as those of a
// robot at work do, and nothing is a sweep.
//
// Times are those on the clock; a replay hashes the capture and writes samples.csv to the disk on
// threads of their own. The ratio of processor time counts what all threads take.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <random>
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
#include "rsi/capture/capture_writer.hpp"
#include "rsi/capture/packet.hpp"
#include "rsi/telegram/ethernet_config.hpp"
#include "rsi/telegram/telegram_writer.hpp"
#include "tests/bench/table.hpp"
#include "tests/config_folder.hpp"
#include "tests/daemon/temporary_folder.hpp"
#include "tests/rsi/addresses.hpp"

namespace {

using std::filesystem::path;
using sweepd::test::kConfig;
using sweepd::test::kEthernet;
using sweepd::test::kPlan;
using sweepd::test::kRobot;

constexpr double kRatioAim = 0.5;
constexpr double kSpeedAim = 300'000;  // telegrams per second
constexpr std::uintmax_t kMemoryAim = 64'000'000;

/// The shipped plan, its sweeps as often as it takes for so many telegrams.
void write_long_plan(const path& file, std::uint64_t telegrams) {
  const std::string text = sweepd::test::content(kPlan);
  const auto sweeps = text.find("\n[[sweep]]");
  if (sweeps == std::string::npos) throw std::runtime_error(std::string(kPlan) + ": has no sweeps");
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

/// All joints swing, each at its own pace; angles and currents have noise.
void write_production(const path& file, std::uint64_t telegrams) {
  using namespace std::chrono_literals;
  const rsi::TelegramWriter writer(rsi::EthernetConfig::load(kEthernet), 4);
  rsi::CaptureWriter capture(file);
  rsi::Datagram datagram{1'700'000'000s, rsi::test::kController, rsi::test::kServer, {}, false};
  constexpr std::array kMiddle_deg{0.0, -90.0, 90.0, 0.0, 60.0, 0.0};
  constexpr std::array kMiddle_mm{0.0, -600.0, 905.0};
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise;
  rsi::SignalValues values;
  std::string telegram;
  for (std::uint64_t n = 0; n < telegrams; ++n, datagram.time += 4ms) {
    for (std::size_t k = 0; k < 6; ++k) {
      const double phase = 1e-3 * static_cast<double>(n * (k + 2)) + static_cast<double>(k);
      values.ASPos[k] = kMiddle_deg[k] + 20 * std::sin(phase);
      values.AIPos[k] = values.ASPos[k] + 1e-4 * noise(random);
      values.RSol[k] = k < 3 ? kMiddle_mm[k] + 300 * std::sin(phase) : 60 * std::sin(phase);
      values.RIst[k] = values.RSol[k] + 1e-3 * noise(random);
      values.MACur[k] = 2 * std::cos(phase) + 0.05 * noise(random);
    }
    telegram.clear();
    writer.append(telegram, values, 1'525'084 + 4 * n);
    datagram.payload = telegram;
    if (!capture.write(datagram)) throw std::runtime_error(capture.error());
  }
  if (!capture.flush()) throw std::runtime_error(capture.error());
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
  (void)sweepd::replay(options);  // where nothing is a sweep it finds no axis
  if (!exists(output / "result.json") || file_size(output / "samples.csv") == 0)
    throw std::runtime_error("replay wrote no result");
}

/// What a process took.
struct Used {
  std::uintmax_t bytes = 0;  ///< in memory at most
  double processor_s = 0;
};

/// Does the work in a process of its own.
template <typename Work>
Used apart(const Work& work) {
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
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {static_cast<std::uintmax_t>(used.ru_maxrss) * 1024,  // Linux counts kilobytes
          seconds(used.ru_utime) + seconds(used.ru_stime)};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::string megabytes(std::uintmax_t bytes) {
  return sweepd::fixed(static_cast<double>(bytes) * 1e-6, 0) + " MB";
}

std::string row(const std::string& name, double bare, double full, double ratio,
                double processor_ratio) {
  using bench::right;
  return name + right(bare / 1000, 0, 24 - name.size()) + right(full / 1000, 0, 17) +
         right(ratio, 2, 9) + right(processor_ratio, 2, 19);
}

void measure(std::uint64_t wanted, int rounds, bool production) {
  const sweepd::test::TemporaryFolder temporary;
  const path capture = temporary / "long.pcap";
  const path output = temporary / "results";
  apart([&] {
    if (production) return write_production(capture, wanted);
    write_long_plan(temporary / "long.toml", wanted);
    write_capture(capture, temporary / "long.toml");
  });
  // Also brings the capture into the page cache.
  const auto telegrams = parse_barely(capture);
  std::cout << "replay of " << telegrams << " telegrams (" << megabytes(file_size(capture))
            << "), in thousand telegrams per second\n"
            << "round     libpcap+pugixml    sweepd replay    ratio  of processor time"
            << std::endl;

  std::vector<double> bare, full, ratios, processor_ratios;
  const auto seconds = [](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto all = static_cast<double>(telegrams);
  std::uintmax_t memory = 0;
  for (int round = 1; round <= rounds; ++round) {
    Used barely, replayed;
    bare.push_back(all / seconds([&] { barely = apart([&] { parse_barely(capture); }); }));
    full.push_back(all / seconds([&] { replayed = apart([&] { replay(capture, output); }); }));
    memory = std::max(memory, replayed.bytes);
    ratios.push_back(full.back() / bare.back());
    processor_ratios.push_back(barely.processor_s / replayed.processor_s);
    std::cout << row(std::to_string(round), bare.back(), full.back(), ratios.back(),
                     processor_ratios.back())
              << std::endl;
  }
  std::uintmax_t written = 0;
  for (const auto& entry : std::filesystem::directory_iterator(output))
    written += entry.file_size();
  std::cout << row("median", median(bare), median(full), median(ratios), median(processor_ratios))
            << '\n'
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
  std::string motion = "campaigns";
  CLI::App app("Replay throughput against a bare loop of libpcap and pugixml", "bench_replay");
  app.add_option("--telegrams", telegrams, "Telegrams in the capture, rounded up to whole plans")
      ->capture_default_str();
  app.add_option("--rounds", rounds, "Each runs both, one after the other")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--motion", motion,
         "The paper's plan again and again, or all joints at once, where nothing is a sweep")
      ->check(CLI::IsMember({"campaigns", "production"}))
      ->capture_default_str();
  app.footer("Capture and result files lie in TMPDIR, or /tmp.");
  CLI11_PARSE(app, argc, argv)
  try {
    measure(telegrams, rounds, motion == "production");
  } catch (const std::exception& error) {
    std::cerr << "bench_replay: " << error.what() << '\n';
    return 1;
  }
}
