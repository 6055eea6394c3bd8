#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/packet.hpp"
#include "rsi/datagram.hpp"

struct pcap;

namespace rsi {

/// What passes an interface of this machine, read and never sent: nothing here can send. UDP and
/// TCP over IPv4. On the loopback interface each packet is seen once. One thread.
class LiveCapture {
 public:
  struct Options {
    std::string interface = "any";
    bool promiscuous = false;  ///< also what is not for this machine, as on a mirror port
    /// Only what comes from or goes to this port, and fragments. Nothing: all UDP and TCP.
    std::optional<std::uint16_t> port = {};
    /// next() waits at most so long.
    std::chrono::milliseconds longest_look{50};
  };

  /// Throws CaptureError: no such interface, not permitted, a link that is not understood.
  explicit LiveCapture(const Options& options);

  enum class Look {
    datagram,
    segment,  ///< of TCP: its bytes are the payload
    other,    ///< a packet that is none
    nothing,  ///< came while it waited
    gone,     ///< the interface: open another capture once it is there again
  };
  /// The payload is valid until the next call.
  [[nodiscard]] Look next(Datagram& datagram, PacketHeaders& headers);
  /// The last next() had to wait: all that had come longest_look before it began was handed out.
  [[nodiscard]] bool waited() const noexcept { return waited_; }

  /// Packets that passed by, and that this program was too slow for.
  [[nodiscard]] std::uint64_t missed();
  [[nodiscard]] const CaptureCounters& counters() const noexcept { return counters_; }

 private:
  struct Close {
    void operator()(pcap* capture) const noexcept;
  };

  void look_at(std::optional<std::uint16_t> port);
  [[nodiscard]] bool is_up();

  std::string interface_;
  std::chrono::milliseconds longest_look_;
  std::chrono::steady_clock::time_point asked_;  // whether it is up
  std::unique_ptr<pcap, Close> capture_;
  LinkLayer layer_{};
  bool waited_ = false;
  CaptureCounters counters_;
};

}  // namespace rsi
