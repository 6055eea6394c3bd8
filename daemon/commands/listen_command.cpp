#include "daemon/commands/listen_command.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <thread>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "daemon/commands/command_options.hpp"
#include "daemon/commands/exit_codes.hpp"
#include "daemon/commands/help_text.hpp"
#include "daemon/points/device_lines.hpp"
#include "daemon/settings/toml_table.hpp"
#include "daemon/system/process_events.hpp"
#include "rsi/ascii.hpp"
#include "rsi/counted.hpp"
#include "rsi/server/text_receiver.hpp"

namespace sweepd {
namespace {

using namespace std::chrono_literals;
using Steady = std::chrono::steady_clock;

DeviceSettings device_of(const ListenOptions& options) {
  DeviceSettings device;
  if (options.config) {
    for (const auto& robot : load_settings(*options.config).robots) {
      if (!robot.device.there()) continue;
      if (device.there())
        throw ConfigError(options.config->string() +
                          ": expected one [[robot.device]], found several: name the port and "
                          "--columns in place of --config");
      device = robot.device;
    }
    if (!device.there())
      throw ConfigError(options.config->string() +
                        ": expected a [[robot.device]], found none: add one, or name the port");
  }
  if (options.port) device.listen = *options.port;
  if (!options.columns.empty()) device.columns = {options.columns};
  if (!device.there())
    throw std::invalid_argument(
        "PORT is required: name it, as in udp://0.0.0.0:5005, or give --config");
  return device;
}

/// Counts lines, and shows them.
class Shown {
 public:
  Shown(const ColumnList& columns, bool print, std::ostream& out) : print_(print), out_(out) {
    if (!columns.text.empty()) lines_.emplace(columns);
  }

  void take(const rsi::Datagram& datagram) {
    if (!first_) first_ = datagram.time;
    last_ = datagram.time;
    ++datagrams_;
    std::string_view bytes = datagram.payload;
    while (!bytes.empty()) line(next_line(bytes), seconds(datagram.time), datagram.source);
  }

  [[nodiscard]] std::size_t lines() const { return count_; }
  [[nodiscard]] std::size_t points() const { return by_kind_[0]; }

  void summary(std::uint64_t dropped, std::uint64_t too_long) const {
    out_ << fmt::format("{} in {}", rsi::counted(count_, "line"),
                        rsi::counted(datagrams_, "datagram"));
    if (count_ > 1 && last_ > *first_)
      out_ << fmt::format(", {:.1f} lines a second",
                          static_cast<double>(count_ - 1) / seconds(last_));
    out_ << '\n';
    for (std::size_t k = 0; lines_ && k < by_kind_.size(); ++k)
      if (by_kind_[k] > 0)
        out_ << fmt::format("{:8}  {}\n", by_kind_[k], text(static_cast<DeviceLines::Line>(k)));
    if (too_long > 0)
      out_ << fmt::format("{:8}  left out, as they are longer than {} bytes\n", too_long,
                          rsi::TextReceiver::kLongestLine);
    if (dropped > 0)
      out_ << fmt::format("{:8}  datagrams dropped, as they came faster than {} a second\n",
                          dropped, rsi::TextReceiver::kMostInASecond);
  }

 private:
  [[nodiscard]] double seconds(rsi::Timestamp time) const {
    return std::chrono::duration<double>(time - *first_).count();
  }

  void line(std::string_view text_of_line, double time_s, const rsi::Endpoint& source) {
    constexpr std::size_t kShown = 200;
    ++count_;
    if (print_)
      out_ << fmt::format("{:10.4f} s  {}  {}\n", time_s, rsi::text(source),
                          rsi::printable(rsi::trimmed(text_of_line).substr(0, kShown)));
    if (!lines_) return;
    Point point;
    point.sample.time_s = time_s;
    const auto kind = lines_->read(text_of_line, point);
    ++by_kind_[static_cast<std::size_t>(kind)];
    if (!print_) return;
    if (kind != DeviceLines::Line::point) {
      out_ << fmt::format("{:>14}{}\n", "", text(kind));
      return;
    }
    const auto& at = point.sample.position_mm;
    const auto& target = lines_->targets()[point.target];
    out_ << fmt::format("{:>14}t {:.4f} s, x {:.4f}, y {:.4f}, z {:.4f} mm{}\n", "",
                        point.sample.time_s, at.x(), at.y(), at.z(),
                        target.empty() ? "" : ", target " + rsi::printable(target));
  }

  bool print_;
  std::ostream& out_;
  std::optional<DeviceLines> lines_;
  std::optional<rsi::Timestamp> first_;
  rsi::Timestamp last_{};
  std::size_t count_ = 0, datagrams_ = 0;
  std::array<std::size_t, 6> by_kind_{};
};

}  // namespace

CLI::App* add_listen(CLI::App& app, ListenOptions& options) {
  auto* command = app.add_subcommand(
      "listen",
      "Show what a measuring device sends over UDP or TCP, and what its columns make of it\n"
      "It ends with Ctrl-C, and tells then how many lines came, and how fast.");
  command
      ->add_option("PORT",
                   parsed(options.port, parse_text_port, "PORT",
                          "expected udp:// or tcp://, an IPv4 address and a port (1 to "
                          "65535), as udp://0.0.0.0:5005"),
                   "Listen here: udp://ADDRESS:PORT or tcp://ADDRESS:PORT")
      ->type_name("");
  command->add_option("--config", options.config, "Take port and columns from these settings")
      ->type_name("FILE");
  command
      ->add_option("--columns", options.columns,
                   "Say what the lines hold, with commas between, as for identify --columns")
      ->type_name("NAMES");
  command->add_flag("--print", options.print, "Print each line, and what the columns make of it");
  command->add_option("--lines", options.lines, "End after so many lines")
      ->check(whole_number(1))
      ->type_name("N")
      ->default_str("no end");
  command->add_option("--seconds", options.seconds, "End after this time")
      ->check(more_than_zero())
      ->type_name("S")
      ->default_str("no end");
  command->footer(
      exit_status({{0, "Lines came. If there are columns, points were among them."},
                   {kFailed,
                    "Nothing came that the columns fit, or the port cannot be had. A line on "
                    "standard error says why, and what to do."},
                   kWrongUsage,
                   kWrongFile}));
  return command;
}

int listen(const ListenOptions& options, std::ostream& out, std::ostream& errors) {
  const DeviceSettings device = device_of(options);
  Shown shown(device.columns, options.print, out);
  ProcessEvents events({SIGINT, SIGTERM});
  rsi::TextReceiver receiver(device.listen.tcp ? rsi::Transport::tcp : rsi::Transport::udp,
                             device.listen.endpoint);
  out << "listening on " << text(device.listen) << std::endl;
  std::thread thread([&] { receiver.run(); });
  const auto began = Steady::now();
  const auto ends = began + std::chrono::duration<double>(options.seconds);
  const auto is_over = [&] {
    return !out ||  // whoever read it has gone
           (options.lines > 0 && shown.lines() >= options.lines) ||
           (options.seconds > 0 && Steady::now() >= ends);
  };
  while (!is_over() && !events.next_signal()) {
    rsi::Datagram datagram;
    while (!is_over() && receiver.datagrams().pop(datagram)) shown.take(datagram);
    out.flush();
    if (!is_over()) events.wait_until(Steady::now() + 50ms);
  }
  receiver.stop();
  thread.join();
  shown.summary(receiver.dropped(), receiver.too_long());
  // Interrupted it was less; a busy machine is a little late.
  double listened = std::chrono::duration<double>(Steady::now() - began).count();
  if (options.seconds > 0) listened = std::min(listened, options.seconds);
  if (shown.lines() == 0)
    errors << fmt::format(
        "sweepd: nothing came to {} in {:.1f} s: see the device's target address and port, and the "
        "firewall\n",
        text(device.listen), listened);
  else if (!device.columns.text.empty() && shown.points() == 0)
    errors << "sweepd: no line is a point by the columns " + device.columns.text +
                  ": see the lines with --print, and correct the columns\n";
  else
    return 0;
  return kFailed;
}

}  // namespace sweepd
