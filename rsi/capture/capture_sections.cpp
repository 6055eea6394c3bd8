#include "rsi/capture/capture_sections.hpp"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include <sys/types.h>

#include "rsi/capture/capture_reader.hpp"

namespace rsi {
namespace {

constexpr std::size_t read_buffer_size = 256 * 1024;
constexpr std::string_view section_header = "\x0a\x0d\x0d\x0a";  // in either byte order
constexpr std::string_view big_endian_magic = "\x1a\x2b\x3c\x4d";
constexpr std::string_view little_endian_magic = "\x4d\x3c\x2b\x1a";
constexpr std::uint64_t least_block = 12;
constexpr auto rest_of_file = std::numeric_limits<std::uint64_t>::max();

std::uint64_t number(std::string_view bytes, bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    value = value << 8 | static_cast<unsigned char>(bytes[big_endian ? i : bytes.size() - 1 - i]);
  return value;
}

}  // namespace

CaptureSections::CaptureSections(const std::filesystem::path& path)
    : file_(std::fopen(path.c_str(), "rbe")) {
  if (!file_)
    throw CaptureError("cannot open capture " + path.string() + ": " +
                       std::generic_category().message(errno) +
                       ": check the name and the permissions");
  std::setvbuf(file_.get(), nullptr, _IOFBF, read_buffer_size);
}

bool CaptureSections::next() {
  if (!begun_) {
    begun_ = true;
    begin_block();
    at_header_ = false;
    return true;
  }
  std::array<char, 4096> passed_over{};
  while (read(passed_over.data(), passed_over.size()) > 0) {
  }
  return std::exchange(at_header_, false);
}

std::FILE* CaptureSections::open() {
  constexpr auto read_section = [](void* cookie, char* bytes, std::size_t size) {
    auto* const sections = static_cast<CaptureSections*>(cookie);
    const auto read = sections->read(bytes, size);
    const bool failed = read == 0 && std::ferror(sections->file_.get()) != 0;
    return failed ? ssize_t{-1} : static_cast<ssize_t>(read);
  };
  std::FILE* const section =
      fopencookie(this, "rb", {.read = read_section, .write = {}, .seek = {}, .close = {}});
  if (section != nullptr) std::setvbuf(section, nullptr, _IOFBF, read_buffer_size);
  return section;
}

std::size_t CaptureSections::read(char* bytes, std::size_t size) {
  if (left_ == 0) begin_block();
  if (at_header_) return 0;
  size = static_cast<std::size_t>(std::min<std::uint64_t>(size, left_));
  const auto from_head = std::min(size, head_size_ - head_read_);
  std::copy_n(head_.begin() + static_cast<std::ptrdiff_t>(head_read_), from_head, bytes);
  head_read_ += from_head;
  const auto read = from_head + std::fread(bytes + from_head, 1, size - from_head, file_.get());
  left_ -= read;
  bytes_read_ += read;
  return read;
}

/// Where the size of a block cannot be told, the rest of the file belongs to it.
void CaptureSections::begin_block() {
  const bool in_sections = left_ == 0 && bytes_read_ > 0;
  head_size_ = std::fread(head_.data(), 1, head_.size(), file_.get());
  head_read_ = 0;
  left_ = rest_of_file;
  const std::string_view head(head_.data(), head_size_);
  if (head.starts_with(section_header)) {
    at_header_ = true;
    big_endian_ = head.ends_with(big_endian_magic);
    if (!big_endian_ && !head.ends_with(little_endian_magic)) return;
  } else if (!in_sections) {
    return;
  }
  if (head.size() < head_.size()) return;
  const auto size = number(head.substr(4, 4), big_endian_);
  if (size >= least_block && size % 4 == 0) left_ = size;
}

}  // namespace rsi
