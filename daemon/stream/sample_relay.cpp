#include "daemon/stream/sample_relay.hpp"

#include <utility>

#include "daemon/system/realtime.hpp"

namespace sweepd {

SampleRelay::SampleRelay(Work work, Beside beside)
    : work_(std::move(work)), beside_(std::move(beside)), thread_([this] { run(); }) {}

SampleRelay::~SampleRelay() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void SampleRelay::pass(const SeenSample& sample) {
  Block& filling = block(sent_);  // only this thread changes sent_
  filling.samples[filling.size++] = sample;
  filling.rows += sample.row;
  if (filling.size == kOfBlock) send();
}

void SampleRelay::drain() {
  if (block(sent_).size > 0) send();
  wait_until([this] { return sent_ == done_; });
}

void SampleRelay::wait_for_beside() {
  wait_until([this] { return !beside_; });
}

void SampleRelay::send() {
  {
    const std::lock_guard lock(mutex_);
    ++sent_;
  }
  changed_.notify_all();
  wait_until([this] { return sent_ - done_ < kBlocks; });  // the next block is free
}

template <typename Condition>
void SampleRelay::wait_until(const Condition& condition) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return condition() || failure_; });
  if (failure_) std::rethrow_exception(failure_);
}

void SampleRelay::work_on(Block& block) const {
  std::string_view rows = block.rows;
  for (std::size_t k = 0; k < block.size; ++k) {
    SeenSample& next = block.samples[k];
    next.row = rows.substr(0, next.row.size());
    rows.remove_prefix(next.row.size());
    work_(next);
  }
  block.size = 0;
  block.rows.clear();
}

void SampleRelay::run() {
  name_thread("samples");
  std::unique_lock lock(mutex_);
  try {
    while (!ending_) work(lock);
  } catch (...) {
    lock.lock();
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}

/// The mutex is held, but while something is done, also where that throws.
void SampleRelay::work(std::unique_lock<std::mutex>& lock) {
  if (sent_ > done_) {
    Block& next = block(done_);
    lock.unlock();
    work_on(next);
    lock.lock();
    ++done_;
    changed_.notify_all();
  } else if (beside_) {
    lock.unlock();
    const bool more = beside_();
    lock.lock();
    if (more) return;
    beside_ = nullptr;
    changed_.notify_all();
  } else {
    changed_.wait(lock);
  }
}

}  // namespace sweepd
