#include "daemon/record/record_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/system/atomic_file.hpp"

namespace sweepd {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int reason) {
  const auto text =
      "cannot write " + path.string() + " (" + std::generic_category().message(reason) + ")";
  if (reason == ENOSPC) throw NoRoom(text + ": make room on the disk");
  throw std::runtime_error(text + ": see what is wrong with the disk");
}

}  // namespace

RecordFile::RecordFile(const std::filesystem::path& path, std::string_view head,
                       RecordSize record_size)
    : path_(path), record_size_(record_size), bytes_(head.size()) {
  write_atomically(path, head);
  file_ = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW);
  if (file_ < 0) fail(path_, errno);
}

RecordFile::~RecordFile() {
  close(file_);
}

void RecordFile::append(std::string& records) {
  std::size_t done = 0;
  int failure = 0;
  while (done < records.size() && failure == 0) {
    const auto written = write(file_, records.data() + done, records.size() - done);
    if (written >= 0)
      done += static_cast<std::size_t>(written);
    else if (errno != EINTR)
      failure = errno;
  }
  const auto whole = whole_records({records.data(), done}, record_size_);
  bytes_ += whole.bytes;
  records_ += whole.count;
  records.erase(0, whole.bytes);
  if (whole.bytes < done && ftruncate(file_, static_cast<off_t>(bytes_)) != 0) doubtful_ = true;
  if (failure != 0) fail(path_, failure);
}

bool RecordFile::in_place() const noexcept {
  struct stat open_one {};
  struct stat named {};
  return fstat(file_, &open_one) != 0 ||
         (lstat(path_.c_str(), &named) == 0 && named.st_ino == open_one.st_ino &&
          named.st_dev == open_one.st_dev);
}

void RecordFile::sync() {
  if (fdatasync(file_) == 0) return;
  const int reason = errno;
  doubtful_ = true;  // the system may have thrown away what it could not write
  fail(path_, reason);
}

WholeRecords whole_records(std::string_view bytes, RecordFile::RecordSize record_size) noexcept {
  WholeRecords whole;
  while (whole.bytes < bytes.size()) {
    const auto size = record_size(bytes.substr(whole.bytes));
    if (size == 0 || size > bytes.size() - whole.bytes) break;
    whole.bytes += size;
    ++whole.count;
  }
  return whole;
}

std::size_t line_size(std::string_view bytes) noexcept {
  const auto end = bytes.find('\n');
  return end == std::string_view::npos ? 0 : end + 1;
}

}  // namespace sweepd
