#include "daemon/service/job_thread.hpp"

#include <atomic>
#include <filesystem>
#include <future>
#include <vector>

#include "tests/catch.hpp"
#include "tests/eventually.hpp"

using sweepd::Share;

namespace {

/// Keeps a thread busy until it is let go.
class Gate {
 public:
  std::function<void()> job() {
    return [this] {
      entered_.set_value();
      opened_.get_future().wait();
    };
  }
  void wait_until_entered() { entered_.get_future().wait(); }
  void open() { opened_.set_value(); }

 private:
  std::promise<void> entered_;
  std::promise<void> opened_;
};

}  // namespace

TEST_CASE("jobs are done in order, on another thread, and all before the end", "[job_thread]") {
  std::vector<int> done;
  std::thread::id thread;
  {
    sweepd::JobThread jobs("test", Share::fair);
    for (int k = 0; k < 100; ++k)
      jobs.submit(
          [&done, &thread, k] {
            done.push_back(k);
            thread = std::this_thread::get_id();
          },
          false);
  }
  REQUIRE(done.size() == 100);
  for (int k = 0; k < 100; ++k) CHECK(done[static_cast<std::size_t>(k)] == k);
  CHECK(thread != std::this_thread::get_id());
}

TEST_CASE("an interim job that has not begun gives way to the next one, a final one never",
          "[job_thread]") {
  std::vector<std::string> done;
  Gate gate;
  {
    sweepd::JobThread jobs("test", Share::fair);
    const auto note = [&](const char* name) { return [&done, name] { done.emplace_back(name); }; };
    jobs.submit(gate.job(), true);
    gate.wait_until_entered();  // it has begun: it is not given up
    jobs.submit(note("interim 1"), true);
    jobs.submit(note("interim 2"), true);
    jobs.submit(note("final 1"), false);
    jobs.submit(note("interim 3"), true);
    jobs.submit(note("final 2"), false);
    jobs.submit(note("interim 4"), true);
    gate.open();
  }
  CHECK(done == std::vector<std::string>{"final 1", "final 2", "interim 4"});
}

TEST_CASE("what a job holds is let go when it is done, not with the next job", "[job_thread]") {
  auto held = std::make_shared<int>(1);
  const std::weak_ptr<int> watch = held;
  std::promise<void> second;
  sweepd::JobThread jobs("test", Share::fair);
  jobs.submit([held] { static_cast<void>(*held); }, false);
  held.reset();
  jobs.submit([&] { second.set_value(); }, false);
  second.get_future().wait();
  CHECK(watch.expired());
}

TEST_CASE("a drain waits for the job under way and for those behind it", "[job_thread]") {
  std::atomic<int> done = 0;
  Gate gate;
  sweepd::JobThread jobs("test", Share::fair);
  jobs.drain();  // nothing to wait for
  jobs.submit(gate.job(), false);
  jobs.submit([&] { ++done; }, false);
  gate.wait_until_entered();
  auto drained = std::async(std::launch::async, [&] {
    jobs.drain();
    return done.load();
  });
  gate.open();
  CHECK(drained.get() == 1);
}

TEST_CASE("there is a thread while there are jobs, and a new one for those that come later",
          "[job_thread]") {
  const auto threads = [] {
    const auto tasks = std::filesystem::directory_iterator("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const auto before = threads();
  sweepd::JobThread jobs("test", Share::fair);
  for (int k = 0; k < 3; ++k) {
    auto during = before;
    jobs.submit([&] { during = threads(); }, false);
    jobs.drain();
    CHECK(during == before + 1);
    CHECK(sweepd::test::eventually([&] { return threads() == before; }));
  }
}
