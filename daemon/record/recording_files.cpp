#include "daemon/record/recording_files.hpp"

#include <algorithm>
#include <utility>

#include "rsi/capture/capture_writer.hpp"

namespace sweepd {
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
    trace_.emplace(folder_ / part_name("trace", ".pcap", part_), rsi::capture_header(),
                   packet_size);
    ++files_;
  }
  if (!samples_) {
    samples_.emplace(folder_ / part_name("samples", ".csv", part_), csv_header_, line_size);
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

}  // namespace sweepd
