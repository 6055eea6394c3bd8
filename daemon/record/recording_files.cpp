#include "daemon/record/recording_files.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <map>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/system/atomic_file.hpp"
#include "daemon/text/file_names.hpp"
#include "rsi/capture/capture_writer.hpp"

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
          named.st_dev == open_one.st_dev &&
          static_cast<std::uint64_t>(open_one.st_size) >= bytes_);
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

namespace {

std::size_t packet_size(std::string_view bytes) noexcept {
  return rsi::capture_record_size(bytes);
}

}  // namespace

RecordCount Records::count() const {
  return {whole_records(trace, packet_size).count, whole_records(samples, line_size).count};
}

RecordingFiles::RecordingFiles(std::filesystem::path folder, bool trace, std::string csv_header)
    : folder_(std::move(folder)), with_trace_(trace), csv_header_(std::move(csv_header)) {
  csv_header_ += '\n';
}

bool RecordingFiles::write(Records& records, const Rotation& rotation, Steady::time_point now) {
  const bool another = due(records, rotation, now);
  if (another) close();
  if (!trace_ && !samples_) opened_ = now;
  if (with_trace_ && !trace_) {
    trace_.emplace(folder_ / part_name(file_names::kTraceStem, file_names::kTraceEnding, part_),
                   rsi::capture_header(), packet_size);
    ++files_;
  }
  if (!samples_) {
    samples_.emplace(
        folder_ / part_name(file_names::kSamplesStem, file_names::kSamplesEnding, part_),
        csv_header_, line_size);
    ++files_;
  }
  if (trace_) trace_->append(records.trace);
  samples_->append(records.samples);
  return another;
}

void RecordingFiles::sync() {
  if (trace_) trace_->sync();
  if (samples_) samples_->sync();
}

bool RecordingFiles::in_place() const {
  return (!trace_ || trace_->in_place()) && (!samples_ || samples_->in_place());
}

RecordCount RecordingFiles::recorded() const {
  RecordCount count = closed_records_;
  count += {trace_ ? trace_->records() : 0, samples_ ? samples_->records() : 0};
  return count;
}

std::uint64_t RecordingFiles::bytes() const {
  return closed_bytes_ + (trace_ ? trace_->bytes() : 0) + (samples_ ? samples_->bytes() : 0);
}

bool RecordingFiles::due(const Records& records, const Rotation& rotation,
                         Steady::time_point now) const {
  if (!trace_ && !samples_) return false;
  if ((trace_ && trace_->doubtful()) || (samples_ && samples_->doubtful())) return true;
  const auto& file = trace_ ? *trace_ : *samples_;
  const auto more = trace_ ? records.trace.size() : records.samples.size();
  return file.records() > 0 &&
         (file.bytes() + more > rotation.bytes || now - opened_ >= rotation.age);
}

void RecordingFiles::close() {
  // What is doubtful cannot be helped by another attempt.
  if (trace_ && !trace_->doubtful()) trace_->sync();
  if (samples_ && !samples_->doubtful()) samples_->sync();
  closed_records_ = recorded();
  closed_bytes_ = bytes();
  trace_.reset();
  samples_.reset();
  ++part_;
}

std::string part_name(std::string_view stem, std::string_view ending, unsigned part) {
  std::string name(stem);
  if (part > 1) {
    const auto digits = std::to_string(part);
    name += '-';
    name.append(4 - std::min<std::size_t>(digits.size(), 4), '0').append(digits);
  }
  return name.append(ending);
}

std::optional<unsigned> part_of(std::string_view name, std::string_view stem,
                                std::string_view ending) {
  if (!name.starts_with(stem) || !name.ends_with(ending)) return std::nullopt;
  unsigned part = 1;
  if (name.size() > stem.size() + 1 + ending.size()) {
    const auto digits = name.substr(stem.size() + 1, name.size() - stem.size() - 1 - ending.size());
    std::from_chars(digits.data(), digits.data() + digits.size(), part);
  }
  return name == part_name(stem, ending, part) ? std::optional(part) : std::nullopt;
}

std::vector<std::filesystem::path> traces_of(const std::filesystem::path& folder) {
  std::map<unsigned, std::filesystem::path> found;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    const auto part = part_of(entry->path().filename().string(), file_names::kTraceStem,
                              file_names::kTraceEnding);
    if (part && entry->is_regular_file(ignored)) found.emplace(*part, entry->path());
  }
  std::vector<std::filesystem::path> traces;
  traces.reserve(found.size());
  for (const auto& [part, trace] : found) traces.push_back(trace);
  return traces;
}

}  // namespace sweepd
