#include "daemon/stream/kept_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "identify/sweeps/segmentation.hpp"
#include "identify/sweeps/sweep.hpp"

namespace sweepd {
namespace {

using identify::kDegree;
using identify::Sample;
using identify::Sweep;

/// Joints stand at the same place within one and a half steps of the coarsest print, 0.1 degrees.
constexpr double kSamePlace_rad = 0.15 * kDegree;
/// The ends of a stroke are seen with their ramps cut off, at speed from sample to sample.
constexpr double kSameEnd_rad = 1 * kDegree;
constexpr double kSameEnd_mm = 5;
constexpr double kSameEnd = 0.05;  // of the whole stroke

/// Rather than lose a kind, sweeps lose every second sample: errors of a whole stroke and of the
/// joints' homes do not average out within it.
constexpr std::size_t kLong = 250;  // samples

/// What a joint repeats more often in one turn is of one kind.
constexpr std::size_t kMostRepeats = 16;
constexpr std::size_t kMostWaysOfTurn = 256;

std::size_t memory_of(const Sweep& sweep) {
  return sweep.samples->size() + KeptSweeps::kOfSweep;
}

/// Whether it has so many samples that half of them are enough.
bool can_be_halved(const Sweep& sweep) {
  return sweep.samples->size() >= 2 * identify::kFewestSamples;
}

identify::StrokeContent content_of(const Sweep& sweep) {
  identify::StrokeContent content{sweep.joint.value_or(0), identify::kMostJoints, true};
  for (const Sample& sample : *sweep.samples) {
    content.joints = std::min<std::size_t>(content.joints, sample.joints);
    content.orientation = content.orientation && sample.has_orientation;
  }
  return content;
}

void halve(Sweep& sweep) {
  std::vector<Sample> samples;
  samples.reserve((sweep.samples->size() + 1) / 2);
  for (std::size_t i = 0; i < sweep.samples->size(); i += 2) samples.push_back((*sweep.samples)[i]);
  sweep.samples = std::make_shared<const std::vector<Sample>>(std::move(samples));
}

}  // namespace

KeptSweeps::Way::Way(const Sweep& sweep)
    : joint(sweep.joint),
      range_rad(sweep.range_rad),
      first(sweep.first()),
      middle((*sweep.samples)[sweep.samples->size() / 2]),
      last(sweep.last()) {}

bool KeptSweeps::Way::like(const Way& other) const {
  const double end_rad = std::max(kSameEnd_rad, kSameEnd * range_rad);
  if (std::abs(range_rad - other.range_rad) > end_rad) return false;
  if (first.joints != other.first.joints) return false;
  for (std::size_t k = 0; k < first.joints; ++k)
    if (std::abs(first.angles_rad[k] - other.first.angles_rad[k]) >
        (k == joint ? end_rad : kSamePlace_rad))
      return false;
  const double size_mm = std::max((middle.position_mm - first.position_mm).norm(),
                                  (last.position_mm - first.position_mm).norm());
  const double end_mm = std::max(kSameEnd_mm, kSameEnd * size_mm);
  const auto same = [&](const Sample& a, const Sample& b) {
    if (!a.has_position || !b.has_position) return a.has_position == b.has_position;
    return (a.position_mm - b.position_mm).norm() <= end_mm;
  };
  return same(first, other.first) && same(middle, other.middle) && same(last, other.last);
}

void KeptSweeps::keep(const Sweep& sweep) {
  ++seen_;
  Kind* const kind = kind_of(sweep);
  if (kind == nullptr) return;
  const std::size_t number = kind->seen++;
  if (number % kind->stride != 0) return sum_up(sweep, *kind);
  add(sweep, {kind, number});
  for (std::size_t n = 1; n < sample_stride_ && can_be_halved(sweeps_.back()); n *= 2) {
    memory_ -= memory_of(sweeps_.back());
    halve(sweeps_.back());
    memory_ += memory_of(sweeps_.back());
  }
  while (memory_ > most_samples_ && make_room()) {
  }
}

KeptSweeps::LeftOut KeptSweeps::left_out() const {
  return {seen_ - sweeps_.size(), kinds_left_out_, sample_stride_};
}

/// Null where nothing of the kind is kept.
KeptSweeps::Kind* KeptSweeps::kind_of(const Sweep& sweep) {
  const Group group{sweep.joint, sweep.target, sweep.direction, sweep.defect,
                    sweep.first().external_place != sweep.last().external_place};
  const Way way(sweep);
  const std::size_t repeat = repeats_in_turn(sweep, way);
  const auto known = std::find_if(kinds_.begin(), kinds_.end(), [&](const Kind& kind) {
    return kind.group == group && kind.repeat == repeat && kind.way.like(way);
  });
  if (known != kinds_.end()) return &*known;
  Kinds& kinds = groups_[group];
  const std::size_t number = kinds.seen++;
  if (number % kinds.stride != 0 || kinds.kept >= kinds.most) {
    kinds_left_out_ = true;
    return nullptr;
  }
  ++kinds.kept;
  return &kinds_.emplace_back(Kind{group, number, way, repeat});
}

/// Without angles a turn is compared with the plan's, sweep by sweep: each sweep that it repeats is
/// a kind of its own, so that the whole turn is kept or goes.
std::size_t KeptSweeps::repeats_in_turn(const Sweep& sweep, const Way& way) {
  if (sweep.joint || sweep.defect != identify::SweepDefect::none) return 0;
  if (before_ && identify::turns_in({*before_, sweep}, {0, 1}, 2).size() > 1) turn_.clear();
  before_ = sweep;
  const auto repeats = static_cast<std::size_t>(std::count_if(
      turn_.begin(), turn_.end(), [&](const Way& earlier) { return earlier.like(way); }));
  if (repeats < kMostRepeats && turn_.size() < kMostWaysOfTurn) turn_.push_back(way);
  return repeats;
}

void KeptSweeps::add(const Sweep& sweep, Place place) {
  sweeps_.push_back(sweep);
  places_.push_back(place);
  ++place.kind->kept;
  memory_ += memory_of(sweep);
}

Sweep* KeptSweeps::first_of(const Kind& kind) {
  for (std::size_t s = 0; s < sweeps_.size(); ++s)
    if (places_[s].kind == &kind && places_[s].number == 0) return &sweeps_[s];
  return nullptr;
}

void KeptSweeps::sum_up(const Sweep& sweep, Kind& kind) {
  Sweep* const first = first_of(kind);
  if (first == nullptr || sweep.defect != identify::SweepDefect::none) return;
  if (!kind.reference)
    if (const auto whole = identify::moments_of(*first, content_of(*first)))
      kind.reference = identify::moments_like(*whole, *first);
  if (!kind.reference) return;
  const identify::StrokeContent content = content_of(sweep);
  if (content.joints < kind.reference->content.joints ||
      (kind.reference->content.orientation && !content.orientation))
    return;
  const auto moments = identify::moments_like(*kind.reference, sweep);
  if (!moments) return;
  // Snapshots share what there is: it is not changed.
  auto sum = std::make_shared<identify::StrokeMoments>(*moments);
  if (first->repeats) identify::add(*sum, *first->repeats);
  first->repeats = std::move(sum);
}

bool KeptSweeps::make_room() {
  std::size_t first_sweeps = 0;
  for (std::size_t s = 0; s < sweeps_.size(); ++s)
    if (places_[s].number == 0) first_sweeps += memory_of(sweeps_[s]);
  std::size_t most_kinds = 0;
  for (const auto& [group, kinds] : groups_) most_kinds = std::max(most_kinds, kinds.kept);
  if (2 * first_sweeps <= memory_)
    halve_repeats();
  else if (memory_ > (kLong + kOfSweep) * sweeps_.size() && halve_samples())
    return true;
  else if (most_kinds > 1)
    halve_kinds(most_kinds);
  else
    return halve_samples();
  return true;
}

/// Of all kinds that have at least half as many sweeps as the fullest one: those of one program go
/// on in step, however far its present round has come.
void KeptSweeps::halve_repeats() {
  std::size_t fullest = 0;
  for (const Kind& kind : kinds_) fullest = std::max(fullest, kind.kept);
  for (Kind& kind : kinds_)
    if (2 * kind.kept >= fullest) kind.stride *= 2;
  const auto stays = [](const Place& place) { return place.number % place.kind->stride == 0; };
  for (std::size_t s = 0; s < sweeps_.size(); ++s)
    if (!stays(places_[s])) sum_up(sweeps_[s], *places_[s].kind);
  filter(stays);
}

void KeptSweeps::halve_kinds(std::size_t fullest) {
  kinds_left_out_ = true;
  std::map<const Kind*, bool> goes;
  for (auto& [group, kinds] : groups_) {
    if (2 * kinds.kept < fullest) continue;
    if (group.joint)
      kinds.stride *= 2;
    else
      kinds.most = std::max<std::size_t>(1, kinds.kept / 2);
    std::size_t place = 0;
    for (const Kind& kind : kinds_)
      if (kind.group == group)
        goes[&kind] = group.joint ? kind.number % kinds.stride != 0 : place++ >= kinds.most;
  }
  filter([&](const Place& place) { return !goes[place.kind]; });
  std::erase_if(kinds_, [&](const Kind& kind) {
    if (goes[&kind]) --groups_[kind.group].kept;
    return goes[&kind];
  });
}

bool KeptSweeps::halve_samples() {
  const std::size_t before = memory_;
  memory_ = 0;
  for (Sweep& sweep : sweeps_) {
    if (can_be_halved(sweep)) halve(sweep);
    memory_ += memory_of(sweep);
  }
  if (memory_ == before) return false;
  sample_stride_ *= 2;
  return true;
}

template <typename Stays>
void KeptSweeps::filter(const Stays& stays) {
  std::size_t kept = 0;
  for (std::size_t s = 0; s < sweeps_.size(); ++s) {
    if (!stays(places_[s])) {
      --places_[s].kind->kept;
      memory_ -= memory_of(sweeps_[s]);
      continue;
    }
    if (kept != s) sweeps_[kept] = std::move(sweeps_[s]);
    places_[kept++] = places_[s];
  }
  sweeps_.resize(kept);
  places_.resize(kept);
}

}  // namespace sweepd
