#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "daemon/stream/joint_currents.hpp"
#include "identify/sweeps/sample.hpp"

namespace sweepd {

/// A sample, and what goes with it.
struct SeenSample {
  identify::Sample sample;
  std::string_view row;  ///< of samples.csv
  std::optional<Currents> currents;
  identify::Resolution resolution;  ///< as far as it is known by then
};

/// Has samples worked on by a thread of its own, in their order, while the next ones are read.
/// Bounded memory. All but the work is called by one thread.
class SampleRelay {
 public:
  using Work = std::function<void(const SeenSample&)>;
  /// Other work, a little at a time; false when there is no more.
  using Beside = std::function<bool()>;

  /// The thread does what is `beside` where no sample waits. Throws std::system_error where the
  /// system has no thread to give.
  explicit SampleRelay(Work work, Beside beside = {});
  ~SampleRelay();  ///< what has not been worked on is left
  SampleRelay(const SampleRelay&) = delete;
  SampleRelay& operator=(const SampleRelay&) = delete;

  /// Copies it. Waits where the work is far behind. Throws what the work threw; nothing more can be
  /// passed then.
  void pass(const SeenSample& sample);
  /// Waits until all are worked on. Throws as pass().
  void drain();
  /// Waits until what is beside is done, too. Throws as pass().
  void wait_for_beside();

 private:
  static constexpr std::size_t kOfBlock = 1024;
  static constexpr std::size_t kBlocks = 4;
  struct Block {
    std::vector<SeenSample> samples{kOfBlock};
    std::size_t size = 0;
    std::string rows;  // one after the other
  };

  void send();
  void run();
  void work(std::unique_lock<std::mutex>& lock);
  void work_on(Block& block) const;
  template <typename Condition>
  void wait_until(const Condition& condition);
  [[nodiscard]] Block& block(std::uint64_t number) { return blocks_[number % kBlocks]; }

  const Work work_;
  /// From done_ on they are the work's, from sent_ on the reader's.
  std::array<Block, kBlocks> blocks_;
  std::mutex mutex_;  // guards these
  std::condition_variable changed_;
  std::uint64_t sent_ = 0;
  std::uint64_t done_ = 0;
  bool ending_ = false;
  Beside beside_;  // once it is done, none
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sweepd
