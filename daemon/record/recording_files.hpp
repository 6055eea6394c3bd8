#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/record/recording.hpp"

namespace sweepd {

/// The disk is full, or has less room than is to be kept free.
class NoRoom : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that grows by whole records: of one that a full disk cut off, the piece is taken back.
/// One thread. Everything throws NoRoom or another std::runtime_error with what to do.
class RecordFile {
 public:
  /// The size of the record that the bytes begin with; 0 if they are too few to tell.
  using RecordSize = std::size_t (*)(std::string_view bytes) noexcept;

  /// Makes the file with `head` in it: it never exists without.
  RecordFile(const std::filesystem::path& path, std::string_view head, RecordSize record_size);
  ~RecordFile();
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  /// Takes what is in the file now out of `records`: all, unless it throws.
  void append(std::string& records);
  /// Returns once everything is on the disk.
  void sync();

  /// Whether it is still found under its name, with all that was written.
  [[nodiscard]] bool in_place() const noexcept;
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t records() const { return records_; }
  /// A piece of a record could not be taken back, or what was written may have been lost: the rest
  /// had better go to another file.
  [[nodiscard]] bool doubtful() const { return doubtful_; }

 private:
  std::filesystem::path path_;
  RecordSize record_size_;
  int file_;
  std::uint64_t bytes_;
  std::uint64_t records_ = 0;
  bool doubtful_ = false;
};

/// How many whole records the bytes begin with, and where the last of them ends.
struct WholeRecords {
  std::uint64_t count = 0;
  std::size_t bytes = 0;
};
[[nodiscard]] WholeRecords whole_records(std::string_view bytes,
                                         RecordFile::RecordSize record_size) noexcept;

/// RecordFile::RecordSize of text.
[[nodiscard]] std::size_t line_size(std::string_view bytes) noexcept;

/// Some records in the form that they have in the files. Whole ones only.
struct Records {
  std::string trace;    ///< see rsi/capture/capture_writer.hpp
  std::string samples;  ///< lines

  [[nodiscard]] std::size_t bytes() const { return trace.size() + samples.size(); }
  [[nodiscard]] RecordCount count() const;
};

/// The growing files of a session: trace.pcap and samples.csv, then trace-0002.pcap and
/// samples-0002.csv, and so on. Both go on in a new file at the same moment, so that those of a
/// number belong together. Each can be read by itself. One thread; throws as RecordFile.
class RecordingFiles {
 public:
  using Steady = std::chrono::steady_clock;

  struct Rotation {
    std::uint64_t bytes;  ///< of the trace; of the samples where there is none
    Steady::duration age;
  };

  /// Files are made when there is something to write.
  RecordingFiles(std::filesystem::path folder, bool trace, std::string csv_header);

  /// Takes what is written out of `records`. True if it went to a new file, and not the first.
  bool write(Records& records, const Rotation& rotation, Steady::time_point now);
  void sync();
  /// Whether the files that are open are RecordFile::in_place().
  [[nodiscard]] bool in_place() const;

  // In all files so far.
  [[nodiscard]] RecordCount recorded() const;
  [[nodiscard]] std::uint64_t files() const { return files_; }
  [[nodiscard]] std::uint64_t bytes() const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] unsigned part() const { return part_; }

 private:
  [[nodiscard]] bool due(const Records& records, const Rotation& rotation,
                         Steady::time_point now) const;
  void close();

  std::filesystem::path folder_;
  bool with_trace_;
  std::string csv_header_;
  std::optional<RecordFile> trace_;
  std::optional<RecordFile> samples_;
  unsigned part_ = 1;
  Steady::time_point opened_{};
  RecordCount closed_records_;
  std::uint64_t closed_bytes_ = 0;
  std::uint64_t files_ = 0;
};

/// "trace", ".pcap" and 2 give trace-0002.pcap; 1 gives trace.pcap.
[[nodiscard]] std::string part_name(std::string_view stem, std::string_view ending, unsigned part);
/// The number in such a name; nothing if it is none.
[[nodiscard]] std::optional<unsigned> part_of(std::string_view name, std::string_view stem,
                                              std::string_view ending);
/// The parts of a folder's trace that are there, in the order in which they were written, whatever
/// the clock did meanwhile: the first ones may have been deleted.
[[nodiscard]] std::vector<std::filesystem::path> traces_of(const std::filesystem::path& folder);

}  // namespace sweepd
