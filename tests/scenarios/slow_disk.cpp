// Preloaded into sweepd: a disk that stands still. While the file named by SWEEPD_STOPPED_DISK is
// there, writing and syncing a recording waits.

#include <cstddef>
#include <cstdlib>
#include <string_view>

#include <dlfcn.h>
#include <time.h>
#include <unistd.h>

namespace {

bool of_recording(int descriptor) {
  char link[32] = "/proc/self/fd/";
  std::size_t length = 14;
  char digits[12];
  std::size_t count = 0;
  for (int rest = descriptor; rest > 0 || count == 0; rest /= 10)
    digits[count++] = static_cast<char>('0' + rest % 10);
  while (count > 0) link[length++] = digits[--count];
  link[length] = '\0';
  char path[4096];
  const auto size = readlink(link, path, sizeof path);
  if (size <= 0) return false;
  const std::string_view target(path, static_cast<std::size_t>(size));
  const auto name = target.substr(target.rfind('/') + 1);
  return name.starts_with("trace") || name.starts_with("samples");
}

void wait_for_disk(int descriptor) {
  const char* const marker = std::getenv("SWEEPD_STOPPED_DISK");
  if (marker == nullptr || access(marker, F_OK) != 0 || !of_recording(descriptor)) return;
  const timespec pause{0, 5'000'000};
  while (access(marker, F_OK) == 0) nanosleep(&pause, nullptr);
}

template <typename Function>
Function* original(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static auto* const next = original<ssize_t(int, const void*, size_t)>("write");
  wait_for_disk(descriptor);
  return next(descriptor, bytes, size);
}

int fdatasync(int descriptor) {
  static auto* const next = original<int(int)>("fdatasync");
  wait_for_disk(descriptor);
  return next(descriptor);
}

int fsync(int descriptor) {
  static auto* const next = original<int(int)>("fsync");
  wait_for_disk(descriptor);
  return next(descriptor);
}
}
