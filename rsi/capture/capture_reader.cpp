#include "rsi/capture/capture_reader.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <pcap/pcap.h>

#include "rsi/counted.hpp"

namespace rsi {
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
                    " IP fragments of UDP datagrams were left out, they are not put together: "
                    "shorten the SEND list of the controller's Ethernet file so that a telegram "
                    "stays below 1472 bytes");
  return notes;
}

}  // namespace rsi
