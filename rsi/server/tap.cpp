#include "rsi/server/tap.hpp"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

namespace rsi {
namespace {

using namespace std::chrono_literals;

constexpr auto kFirstSilence = 3s;
constexpr auto kLongestSilence = 3600s;
/// Longer than any cycle: what waits to be decided is decided with what there is.
constexpr auto kSettled = 200ms;
constexpr std::size_t kMostOthers = 16;
constexpr std::size_t kMostRemarks = 64;

LiveCapture::Options only(LiveCapture::Options capture, std::uint16_t port) {
  capture.port = port;
  return capture;
}

bool is(const Endpoint& watched, const Endpoint& endpoint) {
  return endpoint.port == watched.port &&
         (watched.address == 0 || endpoint.address == watched.address);
}

}  // namespace

Tap::Tap(Settings settings, Options watched)
    : Server(std::move(watched)),
      settings_(std::move(settings)),
      capture_(only(settings_.capture, options().listen.port)),
      copies_([this](const Datagram& datagram) { take(datagram); }),
      heard_(clock()),
      looked_after_(heard_),
      tried_(heard_),
      silence_(kFirstSilence) {
  set_local(options().listen);
}

void Tap::run() noexcept {
  while (!stopping()) {
    beat();
    try {
      if (capture_)
        look();
      else
        open_again();
    } catch (const std::exception& error) {  // of memory
      say(error.what());
    }
  }
}

void Tap::look() {
  const auto looking = clock();
  // Nobody waits for a tap: what acquisition has no time for waits in the kernel, which counts.
  if (datagrams().half_full()) return std::this_thread::sleep_for(5ms);
  Datagram datagram;
  PacketHeaders headers;
  const auto look = capture_->next(datagram, headers);
  if (look != LiveCapture::Look::gone && capture_->waited())
    heard_all_until(looking - settings_.capture.longest_look);
  switch (look) {
    case LiveCapture::Look::datagram:
    case LiveCapture::Look::segment: {
      const bool answers = is(options().listen, datagram.source);
      if (!answers && !is(options().listen, datagram.destination)) break;
      if (look == LiveCapture::Look::segment)
        take_segment(datagram, headers, answers);
      else
        copies_.take(datagram, headers.identification, answers);
      break;
    }
    case LiveCapture::Look::other:
      break;
    case LiveCapture::Look::nothing:
      if (looking - heard_ > kSettled) copies_.settle();
      set_missed(missed_before_ + capture_->missed());
      listen_elsewhere();
      break;
    case LiveCapture::Look::gone:
      missed_before_ += capture_->missed();
      capture_.reset();
      elsewhere_.reset();
      say("interface " + settings_.capture.interface +
          " is gone or down: nothing is seen until it is there again; see `ip link`");
      return;
  }
  set_copies(copies_.copies());
  if (looking - looked_after_ >= 1s) look_after(looking);
}

void Tap::open_again() {
  heard_all_until(clock());  // nothing comes from there
  if (clock() - tried_ < 1s) {
    std::this_thread::sleep_for(20ms);
    return;
  }
  tried_ = clock();
  try {
    capture_.emplace(only(settings_.capture, options().listen.port));
  } catch (const CaptureError&) {
    return;
  }
  say("interface " + settings_.capture.interface + " is there again");
}

void Tap::take(const Datagram& datagram) {
  heard_ = clock();
  silence_ = kFirstSilence;
  elsewhere_.reset();
  if (is(options().listen, datagram.source)) return hand_over_reply(datagram);
  if (looks_like_telegram(datagram.payload)) controller_ = datagram.source.address;
  serve({&datagram, 1});
}

void Tap::take_segment(const Datagram& segment, const PacketHeaders& headers, bool answers) {
  constexpr std::size_t kMostStreams = 8;
  const auto key = std::pair(segment.source, segment.destination);
  if (headers.begins || (streams_.size() >= kMostStreams && !streams_.contains(key)))
    std::erase_if(streams_, [&](const auto& stream) {  // of connections before
      return stream.first.first == segment.source || streams_.size() >= kMostStreams;
    });
  auto& stream = streams_.try_emplace(key, answers ? "Sen" : "Rob").first->second;
  stream.take(headers.sequence, headers.begins, segment.payload, [&](std::string_view telegram) {
    auto whole = segment;
    whole.payload = telegram;
    take(whole);
  });
  if (stream.missed() > 0 && !std::exchange(told_holes_, true))
    say("parts of a TCP connection passed unseen: the telegrams in them count as lost");
}

void Tap::listen_elsewhere() {
  constexpr int kMostInALook = 1000;
  Datagram datagram;
  PacketHeaders headers;
  for (int i = 0; elsewhere_ && i < kMostInALook; ++i) {
    const auto look = elsewhere_->next(datagram, headers);
    if (look == LiveCapture::Look::nothing) return;
    if (look == LiveCapture::Look::gone) return elsewhere_.reset();
    if (look == LiveCapture::Look::other) continue;
    ++packets_;
    if (!looks_like_telegram(datagram.payload)) continue;
    const Conversation other{datagram.source.address, datagram.destination};
    if (others_.size() < kMostOthers || others_.contains(other)) ++others_[other];
  }
}

void Tap::look_after(Time now) {
  looked_after_ = now;
  set_missed(missed_before_ + capture_->missed());
  if (const auto times = copies_.times(); times != std::exchange(told_times_, times))
    say(times == 1 ? "each datagram passes " + settings_.capture.interface + " once now"
                   : "each datagram passes " + settings_.capture.interface + " " +
                         std::to_string(times) + " times: it is counted once");
  if (capture_->counters().fragments > 0 && !std::exchange(told_fragments_, true))
    say("IP fragments pass, which are not put together: " + remedy_for_fragments());
  if (now - heard_ >= 1s && !elsewhere_) {
    auto all = settings_.capture;
    all.longest_look = {};
    elsewhere_.emplace(all);
    others_.clear();
    packets_ = 0;
  }
  if (now - heard_ >= silence_) say_silence(now);
}

void Tap::say_silence(Time now) {
  silence_ = std::min<std::chrono::seconds>(6 * silence_, kLongestSilence);
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - heard_).count();
  std::string sentence = "no RSI for " + text(options().listen) + " on " +
                         settings_.capture.interface + " for " + std::to_string(seconds) + " s";
  std::string elsewhere;
  for (const auto& [conversation, telegrams] : others_)
    if (telegrams >= kSurelyRsi &&
        conversation.controller == controller_.value_or(conversation.controller))
      elsewhere += (elsewhere.empty() ? "" : ", ") + text(conversation);
  if (controller_ && elsewhere.empty()) return;  // the stream has ended, as streams do
  if (!elsewhere.empty())
    sentence += ", but of " + elsewhere + ": watch that port";
  else if (packets_ > 0)
    sentence += ", while " + std::to_string(packets_) +
                " other packets passed: is RSI on, and is this the controller's network?";
  else
    sentence +=
        ", and no other packet: is RSI on, is this the interface, does the switch mirror "
        "the controller's port?";
  say(std::move(sentence));
}

void Tap::say(std::string sentence) {
  const std::lock_guard lock(mutex_);
  if (remarks_.size() < kMostRemarks) remarks_.push_back(std::move(sentence));
}

std::optional<std::string> Tap::remark() {
  const std::lock_guard lock(mutex_);
  if (remarks_.empty()) return std::nullopt;
  auto first = std::move(remarks_.front());
  remarks_.pop_front();
  return first;
}

}  // namespace rsi
