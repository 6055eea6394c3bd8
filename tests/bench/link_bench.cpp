// What the link to the controllers costs and how soon it answers, against an Asio server that does
// nothing but send as many bytes back.

#include <chrono>
#include <exception>
#include <iostream>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "tests/bench/link_parts.hpp"

int main(int argc, char** argv) {
  int turnaround_seconds = 20;
  int endpoint_seconds = 60;
  int fleet_seconds = 10;
  std::vector<std::size_t> robots{1, 10, 50, 100, 200};
  std::uint64_t telegrams = 2'000'000;
  std::uint64_t per_stream = 500'000;

  CLI::App app("The link to the controllers, against a bare Asio echo server", "bench_link");
  const auto* const turnaround = app.add_subcommand(
      "turnaround", "How soon a telegram is answered: idle, under load, with SCHED_FIFO");
  const auto* const endpoint = app.add_subcommand(
      "endpoint", "How soon a telegram is answered while the pages are asked for");
  const auto* const fleet =
      app.add_subcommand("fleet", "Many robots at 250 Hz: late replies, processor time, memory");
  const auto* const soak = app.add_subcommand(
      "soak", "Telegrams as fast as they are answered, stream after stream: memory and files");
  app.require_subcommand(0, 1);
  app.get_subcommand("turnaround")
      ->add_option("--seconds", turnaround_seconds, "How long each of the four parts takes")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.get_subcommand("endpoint")
      ->add_option("--seconds", endpoint_seconds, "How long each of the four parts takes")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.get_subcommand("fleet")
      ->add_option("--seconds", fleet_seconds, "How long each number of robots is served")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.get_subcommand("fleet")
      ->add_option("--robots", robots, "How many at once, in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.get_subcommand("soak")
      ->add_option("--telegrams", telegrams, "In all; 21600000 are a day at 250 Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.get_subcommand("soak")
      ->add_option("--per-stream", per_stream, "After so many RSI ends and begins anew")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.footer("Without a subcommand all four. Recordings lie in TMPDIR, or /tmp, until the end.");
  CLI11_PARSE(app, argc, argv)

  spdlog::set_level(spdlog::level::err);
  const bool all = app.get_subcommands().empty();
  try {
    if (all || turnaround->parsed()) bench::turnaround(std::chrono::seconds(turnaround_seconds));
    if (all) std::cout << '\n';
    if (all || endpoint->parsed()) bench::endpoint(std::chrono::seconds(endpoint_seconds));
    if (all) std::cout << '\n';
    if (all || fleet->parsed()) bench::fleet(robots, std::chrono::seconds(fleet_seconds));
    if (all) std::cout << '\n';
    if (all || soak->parsed()) bench::soak(telegrams, per_stream);
  } catch (const std::exception& error) {
    std::cerr << "bench_link: " << error.what() << '\n';
    return 1;
  }
}
