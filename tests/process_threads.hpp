#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <sys/types.h>

namespace sweepd::test {

struct ProcessThread {
  pid_t id = 0;
  std::string name;
  std::filesystem::path proc;  ///< its folder below /proc
};

/// The threads of a process. A thread may end while they are read: it is left out.
inline std::vector<ProcessThread> threads_of(const std::string& process = "self") {
  std::vector<ProcessThread> threads;
  std::error_code gone;
  const std::filesystem::path tasks = "/proc/" + process + "/task";
  for (std::filesystem::directory_iterator task(tasks, gone), end; !gone && task != end;
       task.increment(gone)) {
    std::string name;
    if (std::getline(std::ifstream(task->path() / "comm"), name))
      threads.push_back({std::stoi(task->path().filename()), name, task->path()});
  }
  return threads;
}

}  // namespace sweepd::test
