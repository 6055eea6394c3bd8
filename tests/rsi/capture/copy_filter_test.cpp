#include "rsi/capture/copy_filter.hpp"

#include <random>
#include <string>
#include <vector>

#include "tests/catch.hpp"
#include "tests/rsi/addresses.hpp"

using rsi::test::kController;
using rsi::test::kServer;
using namespace std::chrono_literals;

namespace {

/// A link at 4 ms, as a tap sees it.
class Tapped {
 public:
  void telegram(int ipoc, int times = 1, std::chrono::microseconds apart = 20us) {
    see(ipoc, false, times, apart);
  }
  void reply(int ipoc, int times = 1) { see(ipoc, true, times); }
  void settle() { filter_.settle(); }

  [[nodiscard]] const rsi::CopyFilter& filter() const { return filter_; }
  /// "T4" for the telegram with IPOC 4, "R4" for its reply.
  [[nodiscard]] const std::vector<std::string>& passed() const { return passed_; }
  [[nodiscard]] std::size_t telegrams() const { return count('T'); }
  [[nodiscard]] std::size_t replies() const { return count('R'); }

 private:
  /// Each copy that far behind the one before.
  void see(int ipoc, bool answers, int times, std::chrono::microseconds apart = 20us) {
    const auto first = 4ms * ipoc + (answers ? 300us : 0us);
    const auto text = (answers ? "R" : "T") + std::to_string(ipoc);
    for (int i = 0; i < times; ++i)
      filter_.take({first + apart * i, answers ? kServer : kController,
                    answers ? kController : kServer, text, false},
                   0, answers);
  }
  [[nodiscard]] std::size_t count(char kind) const {
    std::size_t count = 0;
    for (const auto& text : passed_) count += text.front() == kind ? 1U : 0U;
    return count;
  }

  std::vector<std::string> passed_;
  rsi::CopyFilter filter_{
      [this](const rsi::Datagram& datagram) { passed_.emplace_back(datagram.payload); }};
};

}  // namespace

TEST_CASE("what a tap sees once passes as it is, and what the link doubled stays double",
          "[copy_filter]") {
  Tapped tapped;
  for (int i = 0; i < 1000; ++i) {
    tapped.telegram(i, i % 100 == 7 ? 2 : 1);  // the seventh already, while nothing is decided
    tapped.reply(i);
  }
  tapped.settle();
  CHECK(tapped.telegrams() == 1010);
  CHECK(tapped.replies() == 1000);
  CHECK(tapped.filter().copies() == 0);
  CHECK(tapped.filter().times() == 1);
}

TEST_CASE("what a tap sees twice passes once, from the first telegram on", "[copy_filter]") {
  const int times = GENERATE(2, 3);
  Tapped tapped;
  for (int i = 0; i < 1000; ++i) {
    tapped.telegram(i, times);
    tapped.reply(i, times);
  }
  CHECK(tapped.telegrams() == 1000);
  CHECK(tapped.replies() == 1000);
  CHECK(tapped.filter().copies() == 2000U * static_cast<unsigned>(times - 1));
  CHECK(tapped.passed()[0] == "T0");
  CHECK(tapped.passed()[1] == "R0");
  CHECK(tapped.passed()[2] == "T1");
}

TEST_CASE(
    "where a tap doubles all, a telegram that the link doubled comes four times and counts "
    "twice, and one of which it missed a copy counts once",
    "[copy_filter]") {
  Tapped tapped;
  std::mt19937 chance(4);
  std::size_t doubled = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto luck = chance() % 100;
    if (luck == 0) ++doubled;
    tapped.telegram(i, luck == 0 ? 4 : luck == 1 ? 1 : 2);
    tapped.reply(i, 2);
  }
  CHECK(doubled > 10);
  CHECK(tapped.telegrams() == 5000 + doubled);
  CHECK(tapped.replies() == 5000);
}

TEST_CASE("each direction has its own number of copies", "[copy_filter]") {
  Tapped tapped;
  for (int i = 0; i < 500; ++i) {
    tapped.telegram(i, 2);
    tapped.reply(i, i % 50 == 3 ? 2 : 1);  // ten that the server repeated
  }
  CHECK(tapped.telegrams() == 500);
  CHECK(tapped.replies() == 510);
}

TEST_CASE("a copy that is seen some cycles late is a copy", "[copy_filter]") {
  // Stamps are of when the kernel got to it, which on a busy machine may be another time slice.
  Tapped tapped;
  for (int i = 0; i < 1000; ++i) {
    tapped.telegram(i, 2, i % 50 == 9 ? 9ms : 20us);
    tapped.reply(i, 2);
  }
  CHECK(tapped.telegrams() == 1000);
  CHECK(tapped.replies() == 1000);
  CHECK(tapped.filter().copies() == 2000U);
}

TEST_CASE("telegrams that come faster than their copies are decided all the same",
          "[copy_filter]") {
  std::size_t passed = 0;
  rsi::CopyFilter filter([&](const rsi::Datagram&) { ++passed; });
  for (int i = 0; i < 1000; ++i)
    for (int copy = 0; copy < 2; ++copy)
      filter.take({500us * i + 20us * copy, kController, kServer, std::to_string(i), false}, 0,
                  false);
  CHECK(passed == 1000);
  CHECK(filter.copies() == 1000U);
}

TEST_CASE("a few telegrams before a pause are let through, and order and bytes stay",
          "[copy_filter]") {
  Tapped tapped;
  for (int i = 0; i < 3; ++i) {
    tapped.telegram(i, 2);
    tapped.reply(i);
  }
  CHECK(tapped.passed().empty());
  tapped.settle();
  CHECK(tapped.passed() == std::vector<std::string>{"T0", "R0", "T1", "R1", "T2", "R2"});
}

TEST_CASE("packets that were sent twice have two identifications, and are no copies",
          "[copy_filter]") {
  std::size_t passed = 0;
  rsi::CopyFilter filter([&](const rsi::Datagram&) { ++passed; });
  for (int i = 0; i < 200; ++i) {
    const auto text = std::to_string(i);
    for (int sent = 0; sent < 2; ++sent)
      filter.take({4ms * i + 20us * sent, kController, kServer, text, false},
                  static_cast<std::uint16_t>(2 * i + sent), false);
  }
  filter.settle();
  CHECK(passed == 400);
}

TEST_CASE("a mirror that begins to double is followed within some telegrams", "[copy_filter]") {
  Tapped tapped;
  for (int i = 0; i < 1000; ++i) tapped.telegram(i, i < 500 ? 1 : 2);
  CHECK(tapped.telegrams() >= 1000);
  CHECK(tapped.telegrams() <= 1000 + rsi::CopyFilter::kDecides);
}
