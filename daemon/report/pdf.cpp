#include "daemon/report/pdf.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daemon/text/file_names.hpp"

namespace sweepd {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::array<const char*, 3> kBrowsers{"chromium", "chromium-browser", "google-chrome"};

/// The first browser that PATH has.
std::string browser() {
  const char* const path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  for (const char* const name : kBrowsers) {
    std::string_view folders = path != nullptr ? path : "/usr/bin:/bin";
    while (!folders.empty()) {
      const auto end = std::min(folders.find(':'), folders.size());
      const auto file = fs::path(folders.substr(0, end)) / name;
      if (end > 0 && ::access(file.c_str(), X_OK) == 0) return file.string();
      folders.remove_prefix(std::min(end + 1, folders.size()));
    }
  }
  throw std::runtime_error(
      "a PDF needs Chromium, and there is none on PATH: install it (apt-get install chromium), or "
      "print report.html by any browser");
}

/// A folder of its own, gone with this.
class Workplace {
 public:
  Workplace() {
    std::string name = (fs::temp_directory_path() / "sweepd-pdf-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("cannot make a folder in " + fs::temp_directory_path().string() +
                               " (" + std::generic_category().message(errno) +
                               "): name another one with TMPDIR");
    path_ = name;
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string file_url(const fs::path& file) {
  std::string url = "file://";
  for (const char c : file.string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("/._-~").find(c) != std::string_view::npos;
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    const auto byte = static_cast<unsigned char>(c);
    url += plain ? std::string(1, c) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return url;
}

/// Runs a program without input and output. Whether it ended well, in time.
bool run(std::vector<std::string> words, std::chrono::seconds patience) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int descriptor : {0, 1, 2})
    posix_spawn_file_actions_addopen(&files, descriptor, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t group;  // of its own: the browser has children
  posix_spawnattr_init(&group);
  posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int error = ::posix_spawn(&child, arguments[0], &files, &group, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&group);
  if (error != 0) return false;
  const auto deadline = std::chrono::steady_clock::now() + patience;
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child, &status, WNOHANG)) == 0 &&
         std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(20ms);
  ::kill(-child, SIGKILL);
  if (ended == 0) ::waitpid(child, &status, 0);
  return ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

void write_pdf(const std::string& html, const fs::path& pdf, std::chrono::seconds patience) {
  const std::string chromium = browser();
  const Workplace workplace;
  const auto page = workplace.path() / file_names::kReportPage;
  const auto printed = workplace.path() / "report.pdf";
  std::ofstream(page, std::ios::binary) << html;
  std::vector<std::string> words{chromium,
                                 "--headless",
                                 "--disable-gpu",
                                 "--no-first-run",
                                 "--user-data-dir=" + (workplace.path() / "profile").string(),
                                 "--no-pdf-header-footer",
                                 "--print-to-pdf=" + printed.string()};
  if (::geteuid() == 0) words.emplace_back("--no-sandbox");  // root cannot have one
  words.push_back(file_url(page));
  if (!run(std::move(words), patience) || !fs::exists(printed))
    throw std::runtime_error(chromium + " did not print the report: print report.html by hand");
  std::error_code error;
  fs::copy_file(printed, pdf, fs::copy_options::overwrite_existing, error);
  if (error)
    throw std::runtime_error(pdf.string() + ": " + error.message() +
                             ": name another file with --output");
}

}  // namespace sweepd
