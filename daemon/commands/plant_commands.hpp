#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct CompareOptions;
struct HistoryCommandOptions;

struct PublishOptions {
  std::filesystem::path config = "/etc/sweepd/sweepd.toml";
  bool again = false;  ///< also what the broker has acknowledged already
};

CLI::App* add_publish(CLI::App& app, PublishOptions& options);

struct CollectOptions {
  std::filesystem::path config = "/etc/sweepd/collect.toml";
};

CLI::App* add_collect(CLI::App& app, CollectOptions& options);

/// Commands that speak with a broker or a database. The program sweepd-plant has what they take
/// (daemon/plant/plant_here.cpp). sweepd, which answers robots, does not: it becomes sweepd-plant
/// with the same arguments (daemon/commands/plant_elsewhere.cpp). Which of the two a program has is
/// decided where it is linked. `arguments` are those of the program, without its name. All return
/// the exit code and throw std::runtime_error.
namespace plant {

[[nodiscard]] int publish(const PublishOptions& options, const std::vector<std::string>& arguments);
[[nodiscard]] int collect(const CollectOptions& options, const std::vector<std::string>& arguments);
/// `compare` with --database.
[[nodiscard]] int compare(const CompareOptions& options, const std::vector<std::string>& arguments);
/// `history` with --database.
[[nodiscard]] int history(const HistoryCommandOptions& options,
                          const std::vector<std::string>& arguments);

}  // namespace plant

}  // namespace sweepd
