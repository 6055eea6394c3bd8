#include "rsi/controller/faulty_wire.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace rsi {

using What = Sent::What;

FaultyWire::FaultyWire(const Rates& rates, std::uint64_t seed) : rates_(rates), random_(seed) {
  const std::array all{rates.lose, rates.duplicate, rates.swap,
                       rates.cut,  rates.garbage,   rates.foreign};
  // Written so that NaN fails.
  if (!std::all_of(all.begin(), all.end(), [](double rate) { return rate >= 0; }) ||
      !(std::accumulate(all.begin(), all.end(), 0.0) <= 1))
    throw std::invalid_argument(
        "rates of a network's faults: expected 0 or more, and at most 1 in all");
}

const std::vector<Sent>& FaultyWire::pass(std::string_view telegram) {
  out_.clear();
  if (std::exchange(holding_, false)) {
    ++counts_.swapped;
    out_ = {{What::telegram, telegram}, {What::telegram, held_}};
    return out_;
  }
  // Not std::uniform_real_distribution, whose numbers depend on the library.
  double draw = static_cast<double>(random_() >> 11) * 0x1p-53;
  if (std::exchange(first_, false)) draw = 2;
  const auto drawn = [&draw](double rate) {
    const bool yes = draw < rate;
    draw -= rate;
    return yes;
  };
  const Sent whole{What::telegram, telegram};
  if (drawn(rates_.lose)) {
    ++counts_.lost;
  } else if (drawn(rates_.duplicate)) {
    ++counts_.duplicated;
    out_ = {whole, whole};
  } else if (drawn(rates_.swap)) {
    held_ = telegram;
    holding_ = true;
  } else if (drawn(rates_.cut)) {
    ++counts_.cut;
    const auto end = telegram.rfind('>');
    const auto size = end == telegram.npos ? telegram.size() : end + 1;
    out_ = {{What::cut, telegram.substr(0, size == 0 ? 0 : random_() % size)}};
  } else if (drawn(rates_.garbage)) {
    ++counts_.garbage;
    out_ = {{What::garbage, random_bytes()}, whole};
  } else if (drawn(rates_.foreign)) {
    ++counts_.foreign;
    out_ = {{What::foreign, telegram}, whole};
  } else {
    out_ = {whole};
  }
  return out_;
}

const std::vector<Sent>& FaultyWire::flush() {
  out_.clear();
  if (std::exchange(holding_, false)) out_ = {{What::telegram, held_}};
  first_ = true;
  return out_;
}

const std::string& FaultyWire::random_bytes() {
  constexpr std::size_t kMost = 1500;
  garbage_.resize(random_() % kMost);
  for (char& byte : garbage_) byte = static_cast<char>(random_() & 0xff);
  return garbage_;
}

}  // namespace rsi
