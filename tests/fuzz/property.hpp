#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <sys/mman.h>
#include <unistd.h>

/// libFuzzer's entry. One a program, in C's convention.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fuzz {

/// What has to hold for every input, in every build type. Aborts: the fuzzer then keeps the input.
inline void expect(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: does not hold: %s\n", property);
  std::abort();
}

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

inline bool is_inside(std::string_view part, std::string_view whole) {
  return part.empty() ||
         (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size());
}

/// What an error says stands in one line, and can go to a log or a terminal as it is.
inline bool is_one_line(std::string_view text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  return !text.empty();
}

/// A file in memory, for readers that take a path.
class File {
 public:
  File() : file_(memfd_create("fuzz", MFD_CLOEXEC)) { expect(file_ >= 0, "memory for a file"); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(file_); }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  void write(std::string_view content) {
    const auto size = static_cast<off_t>(content.size());
    expect(ftruncate(file_, size) == 0 && pwrite(file_, content.data(), content.size(), 0) == size,
           "the input fits into a file");
  }

 private:
  int file_;
  std::filesystem::path path_ = "/proc/self/fd/" + std::to_string(file_);
};

}  // namespace fuzz
