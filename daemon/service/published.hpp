#pragma once

#include <memory>
#include <mutex>
#include <utility>

namespace sweepd {

/// The newest state of something, as one thread publishes it and others read it. What is published
/// never changes; a reader keeps what it got for as long as it likes.
template <typename State>
class Published {
 public:
  explicit Published(State first = {}) : newest_(std::make_shared<const State>(std::move(first))) {}

  void publish(State state) { swap(std::make_shared<const State>(std::move(state)), lock()); }
  /// For a thread that must not wait for a reader: false if one was just reading.
  [[nodiscard]] bool try_publish(State state) {
    std::unique_lock now(mutex_, std::try_to_lock);
    if (!now) return false;
    swap(std::make_shared<const State>(std::move(state)), std::move(now));
    return true;
  }
  /// Never null.
  [[nodiscard]] std::shared_ptr<const State> newest() const {
    const auto now = lock();
    return newest_;
  }

 private:
  [[nodiscard]] std::unique_lock<std::mutex> lock() const { return std::unique_lock(mutex_); }

  /// The old state goes after the lock.
  void swap(std::shared_ptr<const State> state, std::unique_lock<std::mutex> now) {
    newest_.swap(state);
    now.unlock();
  }

  mutable std::mutex mutex_;
  std::shared_ptr<const State> newest_;
};

}  // namespace sweepd
