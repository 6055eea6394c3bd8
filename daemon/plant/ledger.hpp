#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace sweepd {

/// What the broker has acknowledged, on the disk: a line for each result, its session and its
/// SHA-256. A crash costs nothing but the line that was being written. One thread.
class Ledger {
 public:
  /// Reads the file, which need not be there. Throws std::runtime_error where it cannot be written.
  explicit Ledger(const std::filesystem::path& file);
  ~Ledger();
  Ledger(const Ledger&) = delete;
  Ledger& operator=(const Ledger&) = delete;

  [[nodiscard]] bool has(const std::string& session, const std::string& sha256) const;
  /// On the disk when this returns. Throws std::runtime_error where the disk refuses it; has() is
  /// true all the same, until the end of the program.
  void add(const std::string& session, const std::string& sha256);
  [[nodiscard]] std::size_t size() const { return lines_.size(); }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::set<std::string> lines_;
};

}  // namespace sweepd
