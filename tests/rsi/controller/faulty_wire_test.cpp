#include "rsi/controller/faulty_wire.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/catch.hpp"

using rsi::FaultyWire;
using What = rsi::Sent::What;

namespace {

std::string bare_telegram(int number) {
  return "<Rob><IPOC>" + std::to_string(number) + "</IPOC></Rob>\n";
}

int number_in(std::string_view telegram) {
  return std::stoi(std::string(telegram.substr(11)));
}

/// What a receiver gets; the wire's own views are gone with its next call.
struct Received {
  What what;
  std::string payload;

  friend bool operator==(const Received&, const Received&) = default;
};
using Receipts = std::vector<Received>;

Receipts receipts(const std::vector<rsi::Sent>& sent) {
  Receipts all;
  for (const auto& [what, payload] : sent) all.push_back({what, std::string(payload)});
  return all;
}

/// The telegrams 0 to `count` - 1 as a receiver gets them.
Receipts sent_over(FaultyWire& wire, int count) {
  Receipts received;
  const auto take = [&](const std::vector<rsi::Sent>& sent) {
    for (auto& one : receipts(sent)) received.push_back(std::move(one));
  };
  for (int i = 0; i < count; ++i) {
    const auto text = bare_telegram(i);
    take(wire.pass(text));
  }
  take(wire.flush());
  return received;
}

constexpr FaultyWire::Rates kAll{
    .lose = 0.05, .duplicate = 0.03, .swap = 0.02, .cut = 0.03, .garbage = 0.02, .foreign = 0.02};

}  // namespace

TEST_CASE("a wire without faults passes everything in order", "[faulty_wire]") {
  FaultyWire wire({}, 1);
  const auto received = sent_over(wire, 1000);
  REQUIRE(received.size() == 1000);
  for (int i = 0; i < 1000; ++i)
    CHECK(received[static_cast<std::size_t>(i)] == Received{What::telegram, bare_telegram(i)});
}

TEST_CASE("a receiver finds exactly the faults that the wire counts", "[faulty_wire]") {
  const auto seed = GENERATE(1u, 2u, 3u);
  FaultyWire wire(kAll, seed);
  const int count = 20000;
  const auto received = sent_over(wire, count);

  std::set<int> seen;
  std::uint64_t duplicated = 0, overtaken = 0, cut = 0, garbage = 0, foreign = 0;
  int newest = -1;
  for (const auto& [what, payload] : received) {
    if (what == What::cut) {
      ++cut;
      CHECK(payload.find("</Rob>") == std::string::npos);
    } else if (what == What::garbage) {
      ++garbage;
    } else if (what == What::foreign) {
      ++foreign;
    } else {
      const int number = number_in(payload);
      CHECK(payload == bare_telegram(number));
      if (!seen.insert(number).second)
        ++duplicated;
      else if (number < newest)
        ++overtaken;
      newest = std::max(newest, number);
    }
  }
  CHECK(number_in(received.front().payload) == 0);
  const auto& counts = wire.counts();
  CHECK(counts.lost + counts.cut == count - seen.size());
  CHECK(counts.duplicated == duplicated);
  CHECK(counts.swapped == overtaken);
  CHECK(counts.cut == cut);
  CHECK(counts.garbage == garbage);
  CHECK(counts.foreign == foreign);

  // Five standard deviations of a binomial count; the telegram that completes a swap draws no
  // fault, so that rates come out 2 % lower.
  CHECK(std::abs(static_cast<double>(counts.lost) - 980) < 5 * 31);
  CHECK(std::abs(static_cast<double>(duplicated) - 588) < 5 * 24);
  CHECK(std::abs(static_cast<double>(overtaken) - 392) < 5 * 20);
  CHECK(std::abs(static_cast<double>(cut) - 588) < 5 * 24);
  CHECK(std::abs(static_cast<double>(garbage) - 392) < 5 * 20);
  CHECK(std::abs(static_cast<double>(foreign) - 392) < 5 * 20);
}

TEST_CASE("the same seed makes the same faults, another seed others", "[faulty_wire]") {
  FaultyWire one(kAll, 5), same(kAll, 5), other(kAll, 6);
  const auto received = sent_over(one, 200);
  CHECK(sent_over(same, 200) == received);
  CHECK(sent_over(other, 200) != received);
}

TEST_CASE("a swap holds a telegram back until the next one, at the end until the flush",
          "[faulty_wire]") {
  FaultyWire wire({.swap = 1}, 1);
  const auto whole = [](const char* payload) { return Received{What::telegram, payload}; };
  CHECK(receipts(wire.pass("0")) == Receipts{whole("0")});
  CHECK(wire.pass("1").empty());
  CHECK(receipts(wire.pass("2")) == Receipts{whole("2"), whole("1")});
  CHECK(wire.pass("3").empty());
  CHECK(wire.counts().swapped == 1);
  CHECK(receipts(wire.flush()) == Receipts{whole("3")});
  CHECK(wire.flush().empty());
  CHECK(wire.counts().swapped == 1);
}

TEST_CASE("a cut leaves any part but the whole", "[faulty_wire]") {
  FaultyWire wire({.cut = 1}, 1);
  static_cast<void>(wire.pass("<Rob></Rob>\n"));
  std::set<std::size_t> sizes;
  for (int i = 0; i < 1000; ++i) {
    const auto& sent = wire.pass("<Rob></Rob>\n");
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].what == What::cut);
    CHECK(std::string("<Rob></Rob>").starts_with(sent[0].payload));
    sizes.insert(sent[0].payload.size());
  }
  // Without its last '>', 0 to 10 bytes; each has a chance of 1/11 in each of 1,000 rounds.
  CHECK(sizes.size() == 11);
  CHECK(*sizes.rbegin() == 10);
  CHECK(wire.pass("").size() == 1);
}

TEST_CASE("garbage and strangers come before a telegram that is whole", "[faulty_wire]") {
  FaultyWire noisy({.garbage = 1}, 1);
  static_cast<void>(noisy.pass("first"));
  const auto with_garbage = receipts(noisy.pass("<Rob/>"));
  REQUIRE(with_garbage.size() == 2);
  CHECK(with_garbage[0].what == What::garbage);
  CHECK(with_garbage[1] == Received{What::telegram, "<Rob/>"});
  CHECK(receipts(noisy.pass("<Rob/>"))[0] != with_garbage[0]);

  FaultyWire crowded({.foreign = 1}, 1);
  static_cast<void>(crowded.pass("first"));
  CHECK(receipts(crowded.pass("<Rob/>")) ==
        Receipts{{What::foreign, "<Rob/>"}, {What::telegram, "<Rob/>"}});
}

TEST_CASE("the first telegram of each run comes through, whatever the rates", "[faulty_wire]") {
  FaultyWire wire({.lose = 1}, 1);
  CHECK(wire.pass("1").size() == 1);
  CHECK(wire.pass("2").empty());
  CHECK(wire.pass("3").empty());
  CHECK(wire.flush().empty());
  CHECK(wire.pass("1").size() == 1);
  CHECK(wire.flush().empty());
  CHECK(wire.counts().lost == 2);
}

TEST_CASE("rates that are no probabilities are refused", "[faulty_wire]") {
  CHECK_THROWS_AS(FaultyWire({.lose = -0.1}, 1), std::invalid_argument);
  CHECK_THROWS_AS(FaultyWire({.foreign = std::nan("")}, 1), std::invalid_argument);
  CHECK_THROWS_AS(FaultyWire({.lose = 0.6, .garbage = 0.6}, 1), std::invalid_argument);
}
