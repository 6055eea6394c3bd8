#include "rsi/capture/live_capture.hpp"

#include <algorithm>
#include <vector>

#include <linux/if_packet.h>
#include <net/if.h>
#include <pcap/pcap.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace rsi {
namespace {

/// Ten seconds of a link at 4 ms, and more: nobody is waited for.
constexpr int kBufferBytes = 8 << 20;
constexpr int kWholePackets = 65535;

std::string interfaces() {
  std::vector<std::string> names;
  if (auto* const all = if_nameindex()) {
    for (const auto* at = all; at->if_index != 0; ++at) names.emplace_back(at->if_name);
    if_freenameindex(all);
  }
  std::sort(names.begin(), names.end());
  std::string text = "any";
  for (const auto& name : names) text += ", " + name;
  return text;
}

/// What is wrong, and what to do.
std::string cannot_open(const std::string& interface, int code, const std::string& said) {
  const std::string begin = "cannot watch interface " + interface + ": ";
  if (code == PCAP_ERROR_PERM_DENIED || code == PCAP_ERROR_PROMISC_PERM_DENIED)
    return begin +
           "not permitted: it takes the capability CAP_NET_RAW; start the unit "
           "sweepd-watch@" +
           interface + ".service, which has it, or run this command as root";
  if (code == PCAP_ERROR_NO_SUCH_DEVICE)
    return begin + "there is none of that name; there are " + interfaces() + ": name one of them";
  if (code == PCAP_ERROR_IFACE_NOT_UP)
    return begin + "it is down: bring it up, with `ip link set " + interface + " up`";
  return begin + said + ": see `ip link`";
}

}  // namespace

void LiveCapture::Close::operator()(pcap* capture) const noexcept {
  pcap_close(capture);
}

LiveCapture::LiveCapture(const Options& options)
    : interface_(options.interface), longest_look_(options.longest_look) {
  char error[PCAP_ERRBUF_SIZE] = "out of memory";
  capture_.reset(pcap_create(options.interface.c_str(), error));
  if (!capture_) throw CaptureError(cannot_open(options.interface, PCAP_ERROR, error));
  auto* const capture = capture_.get();
  pcap_set_snaplen(capture, kWholePackets);
  pcap_set_promisc(capture, options.promiscuous ? 1 : 0);
  pcap_set_timeout(capture, static_cast<int>(options.longest_look.count()));
  pcap_set_buffer_size(capture, kBufferBytes);
  pcap_set_tstamp_precision(capture, PCAP_TSTAMP_PRECISION_NANO);
  if (const int code = pcap_activate(capture); code < 0) {
    const std::string said = pcap_geterr(capture);
    throw CaptureError(
        cannot_open(options.interface, code, said.empty() ? pcap_statustostr(code) : said));
  }
  const auto layer = link_layer(pcap_datalink(capture));
  if (!layer)
    throw CaptureError(
        "cannot watch interface " + options.interface +
        ": its link is of a type that is not understood: watch an Ethernet interface");
  layer_ = *layer;
  pcap_setnonblock(capture, 1, error);
  // On the loopback interface each packet goes out and comes in. libpcap leaves one of them out;
  // the system need not copy it in the first place.
  const int yes = 1;
  if (options.interface == "lo")
    ::setsockopt(pcap_fileno(capture), SOL_PACKET, PACKET_IGNORE_OUTGOING, &yes, sizeof yes);
  look_at(options.port);
}

LiveCapture::Look LiveCapture::next(Datagram& datagram, PacketHeaders& headers) {
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  int result = pcap_next_ex(capture_.get(), &header, &bytes);
  waited_ = result == 0;
  if (waited_) {
    // Left to itself, libpcap waits for ever where nothing comes.
    pollfd room{pcap_get_selectable_fd(capture_.get()), POLLIN, 0};
    ::poll(&room, 1, static_cast<int>(longest_look_.count()));
    result = pcap_next_ex(capture_.get(), &header, &bytes);
  }
  if (result == 0) return is_up() ? Look::nothing : Look::gone;
  if (result != 1) return Look::gone;
  ++counters_.packets;
  datagram = {};
  const auto kind = decode_packet(layer_, {reinterpret_cast<const char*>(bytes), header->caplen},
                                  datagram, &headers);
  if (kind == PacketKind::udp || kind == PacketKind::tcp) {
    ++counters_.udp;
    datagram.time = std::chrono::seconds(header->ts.tv_sec) + Timestamp(header->ts.tv_usec);
    return kind == PacketKind::udp ? Look::datagram : Look::segment;
  }
  ++(kind == PacketKind::fragment ? counters_.fragments : counters_.foreign);
  return Look::other;
}

/// libpcap waits for an interface that is down, and says nothing.
bool LiveCapture::is_up() {
  const auto now = std::chrono::steady_clock::now();
  if (interface_ == "any" || now - asked_ < std::chrono::seconds(1)) return true;
  asked_ = now;
  ifreq request{};
  interface_.copy(request.ifr_name, sizeof request.ifr_name - 1);
  const bool there = ::ioctl(pcap_fileno(capture_.get()), SIOCGIFFLAGS, &request) == 0;
  return there && (request.ifr_flags & IFF_UP) != 0;
}

/// Once, at the beginning: while a filter is exchanged, packets are lost. Without one, what is not
/// wanted is left out later.
void LiveCapture::look_at(std::optional<std::uint16_t> port) {
  const std::string kinds = "(udp or tcp)";
  const std::string ours = port ? kinds + " and port " + std::to_string(*port) : kinds;
  const std::string wanted = "((" + ours + ") or (udp and ip[6:2] & 0x1fff != 0))";
  // Behind "vlan" all that follows is read as inside of a tag. Not every link may have one.
  const std::string also_tagged =
      wanted + " or (vlan and (" + wanted + " or (vlan and " + wanted + ")))";
  for (const auto& text : {also_tagged, wanted}) {
    bpf_program program{};
    if (pcap_compile(capture_.get(), &program, text.c_str(), 1, PCAP_NETMASK_UNKNOWN) != 0)
      continue;
    const bool set = pcap_setfilter(capture_.get(), &program) == 0;
    pcap_freecode(&program);
    if (set) return;
  }
}

std::uint64_t LiveCapture::missed() {
  pcap_stat stat{};
  return pcap_stats(capture_.get(), &stat) == 0 ? stat.ps_drop : 0;
}

}  // namespace rsi
