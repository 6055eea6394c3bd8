#include "rsi/controller/simulated_controller.hpp"

#include <algorithm>
#include <stdexcept>

namespace rsi {

std::string_view text(ReplyFault fault) noexcept {
  switch (fault) {
    case ReplyFault::unasked:
      return "unasked";
    case ReplyFault::wrong_source:
      return "wrong source";
    case ReplyFault::malformed:
      return "malformed";
    case ReplyFault::wrong_type:
      return "wrong Type";
    case ReplyFault::wrong_ipoc:
      return "wrong IPOC";
    case ReplyFault::late:
      return "late";
    case ReplyFault::repeated:
      return "repeated";
    case ReplyFault::missing_tag:
      return "missing tag";
    case ReplyFault::not_zero:
      return "not zero";
  }
  return "unknown";
}

SimulatedController::SimulatedController(const EthernetConfig& config, const Options& options)
    : writer_(config, options.precision),
      check_(config),
      sentype_(config.sentype),
      only_send_(config.only_send),
      rule_(options.rule),
      server_(options.server),
      cycle_(options.cycle),
      timeout_(options.timeout),
      first_ipoc_(options.first_ipoc),
      next_ipoc_(options.first_ipoc) {
  if (options.cycle <= std::chrono::milliseconds(0))
    throw std::invalid_argument("cycle of a controller: expected 1 ms or more, found " +
                                std::to_string(options.cycle.count()));
  if (options.timeout == 0)
    throw std::invalid_argument("Timeout of a controller: expected 1 cycle or more, found 0");
}

bool SimulatedController::next_telegram(SignalValues values, std::string& telegram) {
  finish();
  if (stopped()) return false;
  ipoc_ = next_ipoc_;
  next_ipoc_ += static_cast<std::uint64_t>(cycle_.count());
  values.Delay = static_cast<std::int64_t>(unanswered_);
  writer_.append(telegram, values, ipoc_);
  awaiting_ = !only_send_;
  answered_ = false;
  ++counts_.telegrams;
  return true;
}

void SimulatedController::skip_cycle() {
  finish();
  next_ipoc_ += static_cast<std::uint64_t>(cycle_.count());
}

void SimulatedController::finish() {
  if (!awaiting_) return;
  awaiting_ = false;
  ++counts_.unanswered;
  ++unanswered_;
  counts_.longest_unanswered = std::max(counts_.longest_unanswered, unanswered_);
}

void SimulatedController::restart(std::uint64_t first_ipoc) {
  finish();
  first_ipoc_ = next_ipoc_ = first_ipoc;
  unanswered_ = 0;
}

void SimulatedController::on_reply(std::string_view payload, const Endpoint& source,
                                   std::chrono::nanoseconds time) {
  ++counts_.replies;
  const std::string from = " from " + rsi::text(source);
  if (only_send_) return count(ReplyFault::unasked, from, "the Ethernet file says ONLYSEND");
  if (source != server_)
    return count(ReplyFault::wrong_source, from, "expected " + rsi::text(server_));
  const auto content = check_.read(payload);
  if (!content.malformed.empty()) return count(ReplyFault::malformed, from, content.malformed);
  const std::string subject = " to IPOC " + std::to_string(content.ipoc) + from;
  if (!content.right_type)
    return count(ReplyFault::wrong_type, subject,
                 "expected \"" + sentype_ + "\", found \"" + content.sen_type + "\"");
  // Whether in time or not: it should not have been sent.
  if (!content.not_zero.empty()) count(ReplyFault::not_zero, subject, content.not_zero);

  const bool nothing_sent = next_ipoc_ == first_ipoc_;
  const auto step = static_cast<std::uint64_t>(cycle_.count());
  // By differences, so that an IPOC that passes 2^64 is none but the next one.
  const auto since_first = content.ipoc - first_ipoc_;
  if (nothing_sent || since_first > ipoc_ - first_ipoc_ || since_first % step != 0)
    return count(ReplyFault::wrong_ipoc, subject,
                 nothing_sent ? "no telegram was sent yet"
                              : "the last telegram has " + std::to_string(ipoc_));
  if (content.ipoc != ipoc_)
    return count(ReplyFault::late, subject, "IPOC is at " + std::to_string(ipoc_) + " already");
  if (answered_) return count(ReplyFault::repeated, subject, "this telegram was answered already");
  if (!awaiting_) return count(ReplyFault::late, subject, "its cycle is over");
  if (time - sent_ >= cycle_)
    return count(
        ReplyFault::late, subject,
        "it took " + std::to_string((time - sent_) / std::chrono::microseconds(1)) + " µs");
  if (!content.missing.empty()) {
    count(ReplyFault::missing_tag, subject, content.missing);
    if (!allowed(ReplyFault::missing_tag)) return;
  }

  awaiting_ = false;
  answered_ = true;
  unanswered_ = 0;
  ++counts_.accepted;
  latency_.add(time - sent_);
}

void SimulatedController::count(ReplyFault fault, std::string_view subject,
                                std::string_view detail) {
  const auto kind = static_cast<std::size_t>(fault);
  if ((allowed(fault) ? counts_.remarks : counts_.faults)[kind]++ != 0) return;
  first_faults_[kind].append("reply").append(subject).append(": ").append(text(fault));
  first_faults_[kind].append(": ").append(detail);
  if (first_fault_.empty() && !allowed(fault)) first_fault_ = first_faults_[kind];
}

bool SimulatedController::allowed(ReplyFault fault) const {
  return rule_ == ReplyRule::controller &&
         (fault == ReplyFault::missing_tag || fault == ReplyFault::not_zero);
}

}  // namespace rsi
