#pragma once

#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace sweepd {

struct PublishOptions {
  std::filesystem::path config = "/etc/sweepd/sweepd.toml";
  bool again = false;  ///< also what the broker has acknowledged already
};

CLI::App* add_publish(CLI::App& app, PublishOptions& options);

}  // namespace sweepd
