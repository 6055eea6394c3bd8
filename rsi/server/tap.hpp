#pragma once

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "rsi/capture/conversation.hpp"
#include "rsi/capture/copy_filter.hpp"
#include "rsi/capture/live_capture.hpp"
#include "rsi/capture/tcp_stream.hpp"
#include "rsi/server/server.hpp"

namespace rsi {

/// In the place of a server where another program answers the controller: hears both on an
/// interface, and hands over what a server would. It has no socket of RSI, and sends nothing.
///
/// Telegrams are what goes to the watched endpoint, replies what comes from it; address 0 is any.
/// Copies that the tap makes are left out (see copy_filter.hpp), fragments are counted, streams of
/// TCP are put together (see tcp_stream.hpp). An interface that goes is waited for. What a person
/// should know is in remark(): also silence before the first telegram, but not that behind a
/// stream, unless its controller sends elsewhere.
class Tap : public Server {
 public:
  struct Settings {
    LiveCapture::Options capture;
    Transport transport = Transport::udp;  ///< to be told; both are heard
    bool replies = true;                   ///< false: the controller wants none (ONLYSEND)
  };

  /// `watched.listen` is the other program's. Throws CaptureError.
  Tap(Settings settings, Options watched);

  [[nodiscard]] Transport transport() const noexcept override { return settings_.transport; }
  [[nodiscard]] bool replies() const noexcept override { return settings_.replies; }
  void warm() noexcept override {}
  void run() noexcept override;
  [[nodiscard]] std::optional<std::string> remark() override;

 private:
  using Time = Callers::Time;

  void wake() noexcept override {}
  [[nodiscard]] bool send(std::string_view, const Datagram&) noexcept override { return false; }

  void look();
  void open_again();
  void take(const Datagram& datagram);
  void take_segment(const Datagram& segment, const PacketHeaders& headers, bool answers);
  void listen_elsewhere();
  void look_after(Time now);
  void say_silence(Time now);
  void say(std::string sentence);

  const Settings settings_;
  std::optional<LiveCapture> capture_;    // nothing while the interface is gone
  std::optional<LiveCapture> elsewhere_;  // of all ports, in silence, to tell where RSI goes
  CopyFilter copies_;
  std::map<std::pair<Endpoint, Endpoint>, TcpStream> streams_;  // from where, to where
  std::optional<std::uint32_t> controller_;                     // of the last telegram
  Time heard_;                                                  // the last of the conversation
  Time looked_after_;                                           // once a second
  Time tried_;                                                  // to open it again
  std::chrono::seconds silence_;                                // that is said next
  unsigned told_times_ = 1;
  bool told_fragments_ = false;
  bool told_holes_ = false;
  std::uint64_t missed_before_ = 0;     // by captures that are gone
  std::uint64_t packets_ = 0;           // of others, in this silence
  std::map<Conversation, int> others_;  // RSI that goes elsewhere, in this silence

  std::mutex mutex_;
  std::deque<std::string> remarks_;
};

}  // namespace rsi
