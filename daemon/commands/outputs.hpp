#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/system/atomic_file.hpp"

namespace sweepd {

/// Which files a command may write: never one that it reads, by whatever name or link; one that is
/// there already only if sweepd wrote it, or if that is forced. What is no regular file (a pipe,
/// /dev/null) may always be written. All checks throw std::invalid_argument, with what to do.
class Outputs {
 public:
  Outputs(std::vector<std::filesystem::path> inputs, bool force);

  /// `ours`: what such a file begins with where sweepd wrote it; those of a recording's folder are
  /// not for commands to write. An empty file is anybody's.
  void check(const std::filesystem::path& file, std::string_view ours) const;
  /// The same of what can be made again from its folder: a recording's, too.
  void check_made_again(const std::filesystem::path& file, std::string_view ours) const;
  /// For files that people edit: only what is the same to the byte may be written again.
  void check_same(const std::filesystem::path& file, std::string_view content) const;
  /// The files of these names in a folder for results, which may be written again where its
  /// run.json is that of results: it is one of `names`, and is to be written first.
  void check_results(const std::filesystem::path& folder,
                     const std::vector<std::string>& names) const;

 private:
  /// False if there is nothing at `file` that could be lost.
  [[nodiscard]] bool in_the_way(const std::filesystem::path& file) const;

  std::vector<std::filesystem::path> inputs_;
  bool force_;
};

/// A file that is written beside its place and put there as a whole; what is no regular file is
/// written where it is.
class OutputFile {
 public:
  /// `path` as Outputs has checked it. Throws std::runtime_error where nothing can be written.
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();  ///< without commit() the file is as it was, also after a signal
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where to write.
  [[nodiscard]] const std::filesystem::path& beside() const { return beside_; }
  /// Once it is written and closed. Throws std::runtime_error.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path beside_;
  std::optional<UnfinishedFile> unfinished_;
};

/// That two options, as "--csv and --html", do not name one file: what is written last would be all
/// of it. Throws std::invalid_argument.
void check_apart(const std::string& options, const std::filesystem::path& one,
                 const std::filesystem::path& other);

/// The whole of a file at once. Throws std::runtime_error.
void write_output(const std::filesystem::path& path, std::string_view content);

/// Files that people edit, with their contents: all of them, or none where Outputs::check_same()
/// refuses one. Says on `out` which they are. `folder`: is made first, where there is none. Throws
/// as Outputs, and std::runtime_error.
void write_edited(const Outputs& outputs, const std::optional<std::filesystem::path>& folder,
                  const std::vector<std::pair<std::filesystem::path, std::string>>& files,
                  std::ostream& out);

}  // namespace sweepd
