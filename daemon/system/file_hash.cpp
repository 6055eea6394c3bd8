#include "daemon/system/file_hash.hpp"

#include <fstream>
#include <string_view>
#include <utility>

#include <gcrypt.h>

namespace sweepd {
namespace {

constexpr std::size_t kBlock = 256 << 10;

/// The library wants to be told that it may be used; once in a program.
bool ready() {
  static const bool done = [] {
    if (gcry_check_version(GCRYPT_VERSION) == nullptr) return false;
    gcry_control(GCRYCTL_DISABLE_SECMEM, 0);
    gcry_control(GCRYCTL_INITIALIZATION_FINISHED, 0);
    return true;
  }();
  return done;
}

using Hash = std::unique_ptr<gcry_md_handle, decltype(&gcry_md_close)>;

Hash sha256() {
  gcry_md_hd_t hash = nullptr;
  if (!ready() || gcry_md_open(&hash, GCRY_MD_SHA256, 0) != 0) hash = nullptr;
  return {hash, gcry_md_close};
}

std::string digits_of(const Hash& hash) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const unsigned char* const digest = gcry_md_read(hash.get(), GCRY_MD_SHA256);
  std::string digits;
  for (unsigned i = 0; i < gcry_md_get_algo_dlen(GCRY_MD_SHA256); ++i) {
    digits += kDigits[digest[i] >> 4];
    digits += kDigits[digest[i] & 15];
  }
  return digits;
}

}  // namespace

std::string sha256_of(std::string_view bytes) {
  const Hash hash = sha256();
  if (!hash) return {};
  gcry_md_write(hash.get(), bytes.data(), bytes.size());
  return digits_of(hash);
}

struct FileHashes::Begun {
  FileHash found;
  std::ifstream stream;
  Hash hash = sha256();
  std::unique_ptr<char[]> block = std::make_unique<char[]>(kBlock);
};

FileHashes::FileHashes(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}

FileHashes::~FileHashes() = default;

bool FileHashes::go_on() {
  if (!begun_) {
    if (next_ == files_.size()) return false;
    const auto& file = files_[next_++];
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return true;
    begun_ = std::make_unique<Begun>(
        Begun{.found = {file, 0, {}}, .stream = std::ifstream(file, std::ios::binary)});
    if (!begun_->stream || !begun_->hash) begun_.reset();
    return true;
  }
  begun_->stream.read(begun_->block.get(), kBlock);
  const auto size = static_cast<std::size_t>(begun_->stream.gcount());
  gcry_md_write(begun_->hash.get(), begun_->block.get(), size);
  begun_->found.bytes += size;
  if (size > 0) return true;
  begun_->found.sha256 = digits_of(begun_->hash);
  if (!begun_->stream.bad()) made_.push_back(std::move(begun_->found));
  begun_.reset();
  return true;
}

std::optional<FileHash> hash_of(const std::filesystem::path& file) {
  auto hashes = hashes_of({file});
  return hashes.empty() ? std::nullopt : std::optional(std::move(hashes.front()));
}

std::vector<FileHash> hashes_of(const std::vector<std::filesystem::path>& files) {
  FileHashes hashes(files);
  while (hashes.go_on()) {
  }
  return hashes.made();
}

}  // namespace sweepd
