#include "tests/bench/coverage_score.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "identify/geometry/angle.hpp"
#include "tests/simulation/truth.hpp"

namespace coverage {
namespace {

constexpr std::array<const char*, 5> kNames = {"b", "theta", "a", "alpha", "beta"};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace

bool Outcome::Number::inside() const {
  return std::abs(error) <= 1.96 * sigma;
}

Outcome judged(const simulation::Simulation& simulation, const identify::Identification& found) {
  Outcome outcome;
  outcome.status = found.status;
  outcome.converged = found.estimator == identify::Estimator::chain;
  for (const identify::Warning& warning : found.warnings) {
    outcome.transmission |= warning.code == "transmission_error";
    outcome.backlash |= warning.code == "backlash";
  }
  const auto truth = simulation::true_table(simulation, found.dh, found.home_rad);
  for (std::size_t j = 0; j < found.dh.size(); ++j) {
    const identify::DhEstimate& row = found.dh[j];
    const std::array<const identify::DhNumber*, 5> seen = {&row.b_mm, &row.theta_rad, &row.a_mm,
                                                           &row.alpha_rad, &row.beta_rad};
    const std::array<double, 5> right = {truth[j].b_mm, truth[j].theta_rad, truth[j].a_mm,
                                         truth[j].alpha_rad, truth[j].beta_rad};
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (seen[k]->knowledge != identify::Knowledge::identified) continue;
      const double off = seen[k]->value - right[k];
      outcome.numbers.push_back(
          {5 * j + k, k == 0 || k == 2 ? off : identify::wrapped(off), seen[k]->sigma});
    }
  }
  return outcome;
}

Errors errors(const std::vector<Outcome>& outcomes, std::size_t runs) {
  struct Sum {
    double squares = 0;
    int count = 0;
  };
  std::map<std::size_t, Sum> sums;
  for (std::size_t i = 0; i < std::min(runs, outcomes.size()); ++i)
    for (const Outcome::Number& number : outcomes[i].numbers) {
      sums[number.index].squares += number.error * number.error;
      ++sums[number.index].count;
    }
  Errors found;
  constexpr std::array<std::size_t, 4> kPlaces = {2, 0, 3, 1};
  for (std::size_t kind = 0; kind < kPlaces.size(); ++kind) {
    std::vector<double> all;
    for (const auto& [index, sum] : sums)
      if (index % 5 == kPlaces[kind])
        all.push_back(std::sqrt(sum.squares / sum.count) / (kind < 2 ? 1 : identify::kDegree));
    if (!all.empty()) found.rms[kind] = median(std::move(all));
  }
  return found;
}

Score score(const std::vector<Outcome>& outcomes) {
  Score total;
  struct Count {
    int inside = 0;
    int all = 0;
  };
  std::map<std::size_t, Count> counts;
  Count whole;
  double squares = 0;
  const auto runs = static_cast<double>(outcomes.size());
  for (const Outcome& outcome : outcomes) {
    for (const Outcome::Number& number : outcome.numbers) {
      const bool inside = number.inside();
      for (Count* count : {&counts[number.index], &whole}) {
        ++count->all;
        count->inside += inside;
      }
      const double z = number.error / number.sigma;
      squares += z * z;
    }
    total.unconverged += !outcome.converged;
    ++total.statuses[static_cast<std::size_t>(outcome.status)];
    total.transmission += outcome.transmission * 100 / runs;
    total.backlash += outcome.backlash * 100 / runs;
    total.milliseconds += outcome.milliseconds / runs;
  }
  const auto share = [](const Count& count) { return 100.0 * count.inside / count.all; };
  total.known = whole.all / runs;
  if (whole.all > 0) {
    total.covered = share(whole);
    total.rms_z = std::sqrt(squares / whole.all);
  }
  total.worst_covered = 101;
  for (const auto& [index, count] : counts)
    if (2 * count.all >= static_cast<int>(outcomes.size()) && share(count) < total.worst_covered) {
      total.worst_covered = share(count);
      total.worst = kNames[index % 5] + std::to_string(index / 5 + 1);
    }
  return total;
}

}  // namespace coverage
