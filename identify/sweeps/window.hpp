#pragma once

#include <cstddef>
#include <vector>

namespace identify {

/// The latest of what a stream brings, in one piece of memory that is used again: std::deque
/// allocates for every second or third sample.
template <class T>
class Window {
 public:
  void push_back(const T& item) {
    // What is gone makes room, once it is as much as there is.
    if (items_.size() == items_.capacity() && 2 * gone_ >= items_.size()) {
      items_.erase(items_.begin(), begin());
      gone_ = 0;
    }
    items_.push_back(item);
  }
  /// So many of the oldest go.
  void drop(std::size_t count = 1) { gone_ += count; }
  void clear() {
    items_.clear();
    gone_ = 0;
  }

  [[nodiscard]] bool empty() const { return gone_ == items_.size(); }
  [[nodiscard]] std::size_t size() const { return items_.size() - gone_; }
  [[nodiscard]] const T& front() const { return items_[gone_]; }
  [[nodiscard]] const T& back() const { return items_.back(); }
  [[nodiscard]] const T& operator[](std::size_t index) const { return items_[gone_ + index]; }
  [[nodiscard]] auto begin() const { return items_.begin() + static_cast<std::ptrdiff_t>(gone_); }
  [[nodiscard]] auto end() const { return items_.end(); }

 private:
  std::vector<T> items_;
  std::size_t gone_ = 0;  // from its beginning
};

}  // namespace identify
