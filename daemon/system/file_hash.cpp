#include "daemon/system/file_hash.hpp"

#include <fstream>
#include <memory>
#include <string_view>

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

std::optional<FileHash> hash_of(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  const Hash hash = sha256();
  if (!stream || !hash) return std::nullopt;
  FileHash found{file, 0, {}};
  const auto block = std::make_unique<char[]>(kBlock);
  while (stream.read(block.get(), kBlock), stream.gcount() > 0) {
    const auto size = static_cast<std::size_t>(stream.gcount());
    gcry_md_write(hash.get(), block.get(), size);
    found.bytes += size;
  }
  if (stream.bad()) return std::nullopt;
  found.sha256 = digits_of(hash);
  return found;
}

std::vector<FileHash> hashes_of(const std::vector<std::filesystem::path>& files) {
  std::vector<FileHash> hashes;
  for (const auto& file : files)
    if (auto hash = hash_of(file)) hashes.push_back(std::move(*hash));
  return hashes;
}

}  // namespace sweepd
