#pragma once

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct CollectOptions {
  std::filesystem::path config = "/etc/sweepd/collect.toml";
};

CLI::App* add_collect(CLI::App& app, CollectOptions& options);

}  // namespace sweepd
