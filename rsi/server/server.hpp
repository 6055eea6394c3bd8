#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "rsi/endpoint.hpp"
#include "rsi/server/callers.hpp"
#include "rsi/server/datagram_queue.hpp"
#include "rsi/server/port_owner.hpp"
#include "rsi/telegram/reply.hpp"

namespace rsi {

[[nodiscard]] inline Callers::Time steady_now() noexcept {
  return std::chrono::steady_clock::now();
}

/// The robot's side of the link: answers each telegram first, hands it over afterwards. Whether
/// telegrams come over UDP or TCP is up to the two classes that derive from this one.
///
/// Of several telegrams that wait, all are handed over and the newest by its IPOC is answered: the
/// older ones are late anyway. Only one controller is answered: the configured one, or the first
/// that streams (see callers.hpp); datagrams of others are counted and dropped. Until one streams,
/// whoever sends an IPOC is answered, so that the controller's first telegram is. No reply leaves
/// that holds a correction (see correction_gate.hpp).
///
/// run() is the reply thread: from reception to reply it neither parses, allocates, locks, logs nor
/// touches a file. Everything else may be called from any thread.
class Server {
 public:
  struct Options {
    Endpoint listen;                          ///< port 0: the system chooses one
    std::optional<std::uint32_t> controller;  ///< nothing: the first that streams
    std::optional<Reply> reply;               ///< nothing: send nothing (ONLYSEND)
    /// Never begin to answer in a stream whose beginning was not heard here: for replies that are
    /// not harmless in the middle of another server's. A beginning is a telegram behind a second in
    /// which its address was silent on this port. What is not answered is handed over all the same.
    bool only_from_the_beginning = false;
    std::size_t queue_bytes = 4U << 20;
    Callers::Time (*clock)() noexcept = steady_now;  ///< for silence
  };

  struct Counts {
    std::uint64_t answered = 0;
    std::uint64_t superseded = 0;    ///< not answered, since a newer one waited behind
    std::uint64_t unanswerable = 0;  ///< no IPOC could be found
    /// Not from the controller. Over UDP, what the system kept away from the port is among them
    /// once the controller's next telegram tells.
    std::uint64_t foreign = 0;
    std::uint64_t not_begun = 0;  ///< not answered: the beginning of its stream was not heard
    std::uint64_t refused = 0;    ///< the reply was no zero correction: it did not leave
    std::uint64_t send_failures = 0;
    std::uint64_t cut = 0;        ///< larger than any buffer: only the first part was received
    std::uint64_t dropped = 0;    ///< by the system, whose receive buffer was full
    std::uint64_t skipped = 0;    ///< bytes of a TCP stream that were in no telegram
    std::uint64_t overflows = 0;  ///< answered, but the queue had no room to hand it over
    // Of a tap, which hears what another program answers:
    std::uint64_t missed = 0;  ///< packets that passed by: the link had them
    std::uint64_t copies = 0;  ///< of one packet, left out
  };

  virtual ~Server() = default;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] virtual Transport transport() const noexcept = 0;
  /// Where it listens, with the port that the system chose.
  [[nodiscard]] Endpoint local() const noexcept { return local_; }
  /// What the system made of the wish for a large receive buffer, in bytes of its own counting.
  [[nodiscard]] std::size_t receive_buffer() const noexcept { return receive_buffer_; }

  /// False for a controller that only sends.
  [[nodiscard]] virtual bool replies() const noexcept { return options_.reply.has_value(); }

  /// Takes the path of a reply without sending one, so that its memory and code are there when the
  /// first telegram comes. Before run(), on the same thread.
  virtual void warm() noexcept;

  /// Serves until stop(). Does not throw.
  virtual void run() noexcept = 0;
  /// run() returns at once.
  void stop() noexcept {
    stopping_ = true;
    wake();
  }

  /// Rises at least ten times a second while run() does its work.
  [[nodiscard]] std::uint64_t beats() const noexcept { return beats_; }

  /// From any thread but the one that serves: returns once what was answered by now is in the
  /// queue. A reply leaves before its telegram is queued; that takes microseconds.
  void settle() const;

  /// Telegrams and replies in the order in which they came and went, between the addresses that
  /// they had; replies have an empty payload if they did not leave.
  [[nodiscard]] DatagramQueue& datagrams() { return queue_; }

  /// What a person should know, a sentence each; nothing where there is no more. Any thread.
  [[nodiscard]] virtual std::optional<std::string> remark() { return std::nullopt; }

  /// All that had come by then is in datagrams(), or was counted: what has not come since is
  /// silence, also behind a standstill of this program. Any thread.
  [[nodiscard]] Callers::Time heard_until() const noexcept {
    return Callers::Time(Callers::Time::duration(heard_until_));
  }

  /// The stream has ended: where no controller is configured, the next one is served.
  void forget_controller() noexcept { forget_ = true; }

  [[nodiscard]] Counts counts() const noexcept;

 protected:
  /// Telegrams that are taken at most before one is answered: a flood must not stop the replies.
  static constexpr std::size_t kMostAtOnce = 64;

  explicit Server(Options options);

  /// Sends to where a telegram came from, one of those given to serve(), from where it went to.
  /// False if the system refuses.
  [[nodiscard]] virtual bool send(std::string_view reply, const Datagram& telegram) noexcept = 0;

  /// run() no longer waits. Any thread.
  virtual void wake() noexcept = 0;

  /// The reply thread's work: answers the newest, then hands over all in their order. At most
  /// kMostAtOnce; the payloads must stay until it returns.
  void serve(std::span<const Datagram> received) noexcept;

  /// Whether this address is the controller's, or may still become it.
  [[nodiscard]] bool may_serve(std::uint32_t address) noexcept;

  [[nodiscard]] bool stopping() const noexcept { return stopping_; }
  /// How long to look at the port while nothing comes. Silence is known only as finely as that.
  [[nodiscard]] std::chrono::milliseconds longest_look() const noexcept;
  [[nodiscard]] Callers::Time clock() const noexcept { return options_.clock(); }
  /// A look that began at `time` took all there was, and that was served.
  void heard_all_until(Callers::Time time) noexcept {
    callers_.heard_all_until(time);
    heard_until_ = time.time_since_epoch().count();
  }
  void beat() noexcept { beats_.fetch_add(1, std::memory_order_relaxed); }
  void add_foreign(std::uint64_t count) noexcept { foreign_ += count; }
  /// They may have been the controller's.
  void add_dropped(std::uint32_t datagrams) noexcept;
  void set_skipped(std::uint64_t bytes) noexcept { skipped_ = bytes; }
  void set_missed(std::uint64_t packets) noexcept { missed_ = packets; }
  void set_copies(std::uint64_t packets) noexcept { copies_ = packets; }
  /// Hands over what another program has answered. The thread of run().
  void hand_over_reply(const Datagram& reply) noexcept;

  const Options& options() const noexcept { return options_; }
  /// Once the port is bound.
  void set_local(const Endpoint& local) noexcept;
  void set_receive_buffer(std::size_t bytes) noexcept { receive_buffer_ = bytes; }

 private:
  /// What is to be done with one of the telegrams that are served together.
  enum class Fate : std::uint8_t { drop, hand_over, answer };

  [[nodiscard]] Fate judge(const Datagram& received, std::string_view& digits,
                           Callers::Time taken) noexcept;
  /// A telegram that can be answered.
  struct Candidate {
    std::size_t at;  // among those that are served together
    std::string_view digits;
    std::uint64_t ipoc;
    Endpoint source;
  };
  /// Whether the one that came later is to be answered instead.
  [[nodiscard]] bool displaces(const Candidate& later, const Candidate& before) const noexcept;
  /// The reply; its payload is empty if it did not leave.
  [[nodiscard]] Datagram answer(const Datagram& telegram, std::string_view digits) noexcept;

  Options options_;
  Endpoint local_;
  std::size_t receive_buffer_ = 0;
  DatagramQueue queue_;
  Callers callers_;
  std::atomic<bool> stopping_{false};
  std::atomic<bool> serving_{false};
  std::atomic<bool> forget_{false};
  std::atomic<Callers::Time::rep> heard_until_{0};
  Endpoint answered_last_;
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<std::uint64_t> answered_{0}, superseded_{0}, unanswerable_{0}, foreign_{0},
      not_begun_{0}, refused_{0}, send_failures_{0}, cut_{0}, dropped_{0}, skipped_{0}, missed_{0},
      copies_{0};
};

/// The address of this machine from which it reaches `peer`; nothing if there is no way to it.
[[nodiscard]] std::optional<std::uint32_t> local_address_towards(const Endpoint& peer);

/// Time by the system's clock, as datagrams are stamped.
[[nodiscard]] Timestamp now() noexcept;

}  // namespace rsi
