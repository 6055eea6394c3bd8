#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

#include "daemon/commands/plant_commands.hpp"

namespace sweepd::plant {
namespace {

namespace fs = std::filesystem;

/// Beside sweepd where it was built, in libexec where it is installed.
fs::path program() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  std::error_code error;
  fs::path beside = folder / "sweepd-plant";
  if (fs::exists(beside, error)) return beside;
  return folder.parent_path() / "libexec/sweepd/sweepd-plant";
}

int become(const std::vector<std::string>& arguments) {
  const fs::path path = program();
  std::vector<std::string> words{"sweepd"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(path.c_str(), pointers.data());
  throw std::runtime_error("cannot start " + path.string() + " (" +
                           std::generic_category().message(errno) +
                           "), which speaks with brokers and databases: install the whole package");
}

}  // namespace

int publish(const PublishOptions&, const std::vector<std::string>& arguments) {
  return become(arguments);
}

int collect(const CollectOptions&, const std::vector<std::string>& arguments) {
  return become(arguments);
}

int compare(const CompareOptions&, const std::vector<std::string>& arguments) {
  return become(arguments);
}

int history(const HistoryCommandOptions&, const std::vector<std::string>& arguments) {
  return become(arguments);
}

}  // namespace sweepd::plant
