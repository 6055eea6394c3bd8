#include "rsi/capture/capture_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include <pcap/pcap.h>
#include <stdio_ext.h>
#include <sys/types.h>

#include "rsi/counted.hpp"

namespace rsi {
namespace {

constexpr std::size_t read_buffer_size = 256 << 10;
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

/// One thread reads, so that nothing has to be locked.
void take_buffer(std::FILE* file, std::vector<char>& buffer) {
  std::setvbuf(file, buffer.data(), _IOFBF, buffer.size());
  __fsetlocking(file, FSETLOCKING_BYCALLER);
}

}  // namespace

CaptureSections::CaptureSections(const std::filesystem::path& path)
    : file_buffer_(read_buffer_size),
      section_buffer_(read_buffer_size),
      file_(std::fopen(path.c_str(), "rbe")) {
  if (!file_)
    throw CaptureError("cannot open capture " + path.string() + ": " +
                       std::generic_category().message(errno) +
                       ": check the name and the permissions");
  take_buffer(file_.get(), file_buffer_);
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
  if (section != nullptr) take_buffer(section, section_buffer_);
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

namespace {

/// libpcap takes the 32 bits of a pcap file as signed, but nothing was captured before 1970: those
/// are times after 2038. Seconds beyond what nanoseconds in 64 bits can count (the year 2262) come
/// from damaged bytes; they must not overflow.
Timestamp timestamp(const timeval& time) {
  constexpr std::int64_t limit = 9'000'000'000;
  const std::int64_t wrapped = time.tv_sec < 0 ? std::int64_t{1} << 32 : 0;
  const auto seconds = std::clamp<std::int64_t>(time.tv_sec + wrapped, 0, limit);
  const auto fraction_ns = std::clamp<std::int64_t>(time.tv_usec, 0, limit);
  return std::chrono::seconds(seconds) + Timestamp(fraction_ns);
}

std::string link_type_name(int link_type) {
  const char* name = pcap_datalink_val_to_name(link_type);
  return name != nullptr ? std::to_string(link_type) + " (" + name + ")"
                         : std::to_string(link_type);
}

std::string early_end(const std::string& name, const std::string& error, std::uint64_t packets) {
  const auto used =
      "; " + counted(packets, "packet before that is", "packets before that are") + " used: ";
  if (error.starts_with("truncated"))
    return name + ": is cut off in the middle of a packet" + used +
           "let the capturing program end (Ctrl-C) before the file is copied";
  if (error.starts_with("an interface has"))
    return name + ": holds captures of several unlike interfaces (" + error + ")" + used +
           "capture again on the one interface that the controller is connected to, and give "
           "merged captures one by one";
  return name + ": is damaged (" + error + ")" + used + "copy or capture it again";
}

}  // namespace

std::string remedy_for_fragments() {
  return "shorten the SEND list of the controller's Ethernet file so that a telegram stays below " +
         std::to_string(kOneFrame) + " bytes";
}

void CaptureReader::Close::operator()(pcap* capture) const noexcept {
  pcap_close(capture);
}

CaptureReader::CaptureReader(const std::filesystem::path& path)
    : name_(path.string()), sections_(std::make_unique<CaptureSections>(path)) {
  sections_->next();
  if (const auto problem = open_section(); !problem.empty()) throw CaptureError(name_ + problem);
}

/// Empty if it can be read; else what is wrong with it, as what follows its name.
std::string CaptureReader::open_section() {
  capture_.reset();
  char error[PCAP_ERRBUF_SIZE] = "out of memory";
  std::FILE* const file = sections_->open();
  if (file != nullptr) {
    capture_.reset(
        pcap_fopen_offline_with_tstamp_precision(file, PCAP_TSTAMP_PRECISION_NANO, error));
    if (!capture_) std::fclose(file);
  }
  if (!capture_)
    return " is not a capture that can be read (" + std::string(error) +
           "): give a pcap or pcapng file as tcpdump and Wireshark write it, unpacked";
  const int link_type = pcap_datalink(capture_.get());
  const auto layer = link_layer(link_type);
  if (layer) {
    layer_ = *layer;
    return {};
  }
  capture_.reset();
  return " was captured on a link of type " + link_type_name(link_type) +
         ", which is not understood; Ethernet, raw IP, loopback and Linux's \"any\" (SLL, SLL2) "
         "are: capture again on an interface of such a type";
}

void CaptureReader::next_section() {
  capture_.reset();
  while (!capture_ && sections_->next()) {
    ++section_;
    const auto problem = open_section();
    const bool empty = problem.find("no Interface Description Blocks") != std::string::npos;
    if (!problem.empty() && !empty) note(name_ + ": section " + std::to_string(section_) + problem);
  }
}

/// A damaged file may have any number of bad sections.
void CaptureReader::note(std::string sentence) {
  constexpr std::size_t most_notes = 8;
  if (section_notes_.size() < most_notes) section_notes_.push_back(std::move(sentence));
}

std::optional<Datagram> CaptureReader::next() {
  while (capture_) {
    pcap_pkthdr* header = nullptr;
    const u_char* bytes = nullptr;
    const int result = pcap_next_ex(capture_.get(), &header, &bytes);
    if (result != 1) {
      if (result != PCAP_ERROR_BREAK)
        note(early_end(name_, pcap_geterr(capture_.get()), counters_.packets));
      next_section();
      continue;
    }
    ++counters_.packets;
    Datagram datagram;
    const auto kind =
        decode_packet(layer_, {reinterpret_cast<const char*>(bytes), header->caplen}, datagram);
    const bool incomplete = kind == PacketKind::incomplete && header->caplen < header->len;
    if (incomplete || (kind == PacketKind::udp && datagram.cut)) ++counters_.snapped;
    if (kind == PacketKind::udp) {
      ++counters_.udp;
      datagram.time = timestamp(header->ts);
      return datagram;
    }
    if (kind == PacketKind::fragment)
      ++counters_.fragments;
    else if (!incomplete)
      ++counters_.foreign;
  }
  return std::nullopt;
}

std::vector<std::string> CaptureReader::notes() const {
  auto notes = section_notes_;
  if (counters_.snapped > 0)
    notes.push_back(name_ + ": of " + counted(counters_.snapped, "datagram") +
                    " only the first part was captured: capture again with whole packets "
                    "(tcpdump -s 0)");
  if (counters_.fragments > 0)
    notes.push_back(name_ + ": " + std::to_string(counters_.fragments) +
                    " IP fragments of UDP datagrams were left out, they are not put together: " +
                    remedy_for_fragments());
  return notes;
}

std::vector<std::filesystem::path> in_order_of_time(
    const std::vector<std::filesystem::path>& captures) {
  if (captures.size() < 2) return captures;
  std::vector<std::pair<Timestamp, std::filesystem::path>> timed;
  for (const auto& path : captures) {
    const auto first = CaptureReader(path).next();
    timed.emplace_back(first ? first->time : Timestamp::max(), path);
  }
  std::stable_sort(timed.begin(), timed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::filesystem::path> ordered;
  ordered.reserve(timed.size());
  for (auto& [time, path] : timed) ordered.push_back(std::move(path));
  return ordered;
}

}  // namespace rsi
