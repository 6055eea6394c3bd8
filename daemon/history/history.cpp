#include "daemon/history/history.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "daemon/history/compared_campaigns.hpp"
#include "daemon/history/history_words.hpp"
#include "daemon/report/file_parts.hpp"
#include "daemon/text/file_names.hpp"
#include "identify/geometry/median.hpp"
#include "identify/geometry/spread.hpp"
#include "rsi/counted.hpp"

namespace sweepd {
namespace {

constexpr std::chrono::nanoseconds kShortlyBefore = std::chrono::hours(24);

bool is_at(const CampaignRecord& record, const std::filesystem::path& path) {
  std::error_code error;
  return record.name == path.lexically_normal().string() ||
         std::filesystem::equivalent(record.name, path, error) ||
         std::filesystem::equivalent(std::filesystem::path(record.name) / file_names::kResult, path,
                                     error);
}

std::string words_for(const std::string& describes) {
  return describes == "arm" ? "the arm" : "the controller's model";
}

/// A campaign that a clock with a wrong date has dated, as one that begins anew in 1970: before any
/// controller had RSI or still to come, and a decade and more from all that are neither.
bool is_misdated(const CampaignRecord& record, const std::vector<CampaignRecord>& all) {
  constexpr double kDecade = 10, kFirst = 30;  // years, and since 1970
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto possible = [&](const CampaignRecord& one) {
    return years(one.time) > kFirst && one.time < now + kShortlyBefore;
  };
  return !possible(record) && std::ranges::any_of(all, possible) &&
         std::ranges::none_of(all, [&](const CampaignRecord& other) {
           return possible(other) && std::abs(years(other.time) - years(record.time)) < kDecade;
         });
}

/// Which of the records belong together: one kind, one robot's joints.
std::vector<CampaignRecord> of_one_kind(std::vector<CampaignRecord> records,
                                        const HistoryOptions& options, History& history) {
  std::vector<CampaignRecord> told, chosen;
  for (CampaignRecord& record : records)
    if (record.arm && is_misdated(record, records)) {
      record.why_not = record.name + " is dated " + date_of(record.time) +
                       ", as by a clock that was not set: give its date with `sweepd note " +
                       record.name + " --measured DATE`";
      record.arm.reset();
    }
  for (CampaignRecord& record : records)
    (record.arm ? told : history.left_out).push_back(std::move(record));
  if (told.empty())
    throw std::runtime_error(
        history.left_out.empty()
            ? "there are no results in these folders: give folders that run, replay or identify "
              "has written, or one that has them"
            : "none of the " + rsi::counted(history.left_out.size(), "campaign") +
                  " tells an arm; the first: " + history.left_out.front().why_not);
  history.describes = options.describes;
  if (history.describes.empty())
    history.describes =
        std::any_of(told.begin(), told.end(),
                    [](const CampaignRecord& record) { return record.arm->describes == "arm"; })
            ? "arm"
            : told.front().arm->describes;
  std::map<std::pair<std::size_t, std::vector<bool>>, std::size_t> shapes;
  const auto shape = [](const CampaignRecord& record) {
    return std::pair(record.arm->all_joints, record.arm->reach.linear);
  };
  for (const CampaignRecord& record : told)
    if (record.arm->describes == history.describes && record.arm->whole()) ++shapes[shape(record)];
  const auto usual =
      std::max_element(shapes.begin(), shapes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  if (usual == shapes.end())
    throw std::runtime_error("no campaign here tells the whole table of " +
                             words_for(history.describes) +
                             ": choose the other kind with --of, or identify again with sweeps of "
                             "every joint");
  for (CampaignRecord& record : told) {
    if (record.arm->describes != history.describes)
      record.why_not = record.name + " is of " + words_for(record.arm->describes);
    else if (record.arm->all_joints != usual->first.first ||
             (record.arm->whole() && record.arm->reach.linear != usual->first.second))
      record.why_not = record.name + " is of a robot with other joints";
    else {
      chosen.push_back(std::move(record));
      continue;
    }
    history.left_out.push_back(std::move(record));
  }
  return chosen;
}

bool are_same_result(const ToldArm& a, const ToldArm& b) {
  if (a.joints() != b.joints() || a.arm.covariance.rows() != b.arm.covariance.rows()) return false;
  const auto same_row = [](const identify::DhRow& one, const identify::DhRow& other) {
    return one.b_mm == other.b_mm && one.theta_rad == other.theta_rad && one.a_mm == other.a_mm &&
           one.alpha_rad == other.alpha_rad && one.beta_rad == other.beta_rad;
  };
  return std::ranges::equal(values(a.arm.dh), values(b.arm.dh), same_row) &&
         a.arm.covariance == b.arm.covariance;
}

/// In the order of time. A copy is no campaign of its own: of several the first stays, or the one
/// that is asked for as the reference, with the state that any is marked as.
std::vector<CampaignRecord> each_result_once(std::vector<CampaignRecord> records,
                                             const HistoryOptions& options, History& history) {
  const auto by_time = [](const CampaignRecord& a, const CampaignRecord& b) {
    return a.time < b.time;
  };
  std::stable_sort(records.begin(), records.end(), by_time);
  if (options.reference)
    std::stable_partition(records.begin(), records.end(), [&](const CampaignRecord& record) {
      return is_at(record, *options.reference);
    });
  std::vector<CampaignRecord> kept;
  for (CampaignRecord& record : records) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const CampaignRecord& other) {
      return are_same_result(*record.arm, *other.arm);
    });
    if (same == kept.end()) {
      kept.push_back(std::move(record));
      continue;
    }
    if (const auto state = record.same_state(); !state.empty() && same->same_state().empty())
      same->notes.push_back({same->time, {}, state});
    record.why_not = record.name + " and " + same->name + " are the same result: it counts once";
    history.left_out.push_back(std::move(record));
  }
  std::stable_sort(kept.begin(), kept.end(), by_time);
  return kept;
}

/// Where it is; the first that is marked, else the first that is complete.
std::size_t reference_in(const std::vector<CampaignRecord>& records, const HistoryOptions& options,
                         const std::vector<std::string>& states) {
  const auto find = [&](const auto& is) {
    const auto place = std::find_if(records.begin(), records.end(), is);
    return static_cast<std::size_t>(place - records.begin());
  };
  if (options.reference) {
    const std::size_t place =
        find([&](const CampaignRecord& record) { return is_at(record, *options.reference); });
    if (place < records.size() && records[place].arm->whole()) return place;
    throw std::runtime_error(options.reference->string() +
                             " is none of the campaigns that can be compared, or leaves axes open: "
                             "choose another one for --reference");
  }
  for (std::size_t i = 0; i < records.size(); ++i)
    if (!states[i].empty() && records[i].arm->whole()) return i;
  const std::size_t complete = find([](const CampaignRecord& record) {
    return record.arm->status == "complete" && record.arm->whole();
  });
  return complete < records.size()
             ? complete
             : find([](const CampaignRecord& record) { return record.arm->whole(); });
}

void tell_robots(const std::vector<CampaignRecord>& records, History& history) {
  std::map<std::string, std::size_t> robots;
  for (const CampaignRecord& record : records) ++robots[record.arm->robot];
  std::string others;
  for (const auto& [robot, count] : robots)
    if (robot != history.robot) others += (others.empty() ? "" : ", ") + robot;
  if (!others.empty())
    history.messages.push_back("Campaigns of other names are among them: " + others +
                               ". Is it one robot?");
  std::size_t by_age = 0;
  for (const CampaignRecord& record : records) by_age += record.time_from == "age";
  if (by_age > 0)
    history.messages.push_back(
        "Of " + rsi::counted(by_age, "campaign") +
        " only the age of the files tells when it was: `sweepd note DIR --measured DATE` says it.");
}

void gather_notes(const std::vector<CampaignNote>& of_no_campaign, History& history) {
  for (const CampaignNote& note : of_no_campaign) history.notes.emplace_back("", note);
  const auto add = [&](const CampaignRecord& record) {
    for (const CampaignNote& note : record.notes)
      if (!note.text.empty()) history.notes.emplace_back(record.name, note);
    for (const std::size_t line : record.broken_notes)
      history.messages.push_back("Line " + std::to_string(line) + " of " + record.name + '/' +
                                 kNotesFile + " is no note; it is passed over.");
  };
  for (const ComparedCampaign& campaign : history.campaigns) add(campaign.record);
  for (const CampaignRecord& record : history.left_out) add(record);
  std::stable_sort(history.notes.begin(), history.notes.end(),
                   [](const auto& a, const auto& b) { return a.second.time < b.second.time; });
}

constexpr std::size_t kFewest = 6;
constexpr double kLeast_a = 1e-4;  // as files print it

/// Of one campaign, by what differs to the next one: what is slow or happens once is not in it.
double successive_sigma(const std::vector<double>& values) {
  std::vector<double> differences;
  double before = kNothing;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (std::isfinite(before)) differences.push_back(std::abs(value - before));
    before = value;
  }
  if (differences.empty()) return kLeast_a;
  return std::max(kLeast_a,
                  identify::kSigmaByMedian / std::sqrt(2) * identify::median_of(differences));
}

/// Friction of each joint over the campaigns, and its dated changes. How much friction scatters is
/// taken from what differs from one campaign to the next.
void find_friction(History& history) {
  std::map<std::size_t, FrictionSeries> joints;
  for (std::size_t i = 0; i < history.campaigns.size(); ++i)
    for (const JointFriction& one : history.campaigns[i].record.friction) {
      FrictionSeries& series = joints[one.joint];
      series.joint = one.joint;
      series.values_a.resize(history.campaigns.size(), kNothing);
      series.values_a[i] = one.friction_a;
    }
  for (auto& [joint, series] : joints) history.friction.push_back(std::move(series));
  for (std::size_t k = 0; k < history.friction.size(); ++k) {
    const auto& values = history.friction[k].values_a;
    NumberSeries series;
    std::vector<std::size_t> places;
    const double weight = 1 / std::pow(successive_sigma(values), 2);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      places.push_back(i);
      series.times.push_back(years(history.campaigns[i].record.time));
      series.values.push_back(Eigen::VectorXd::Constant(1, values[i]));
      series.weights.push_back(Eigen::MatrixXd::Constant(1, 1, weight));
    }
    if (places.size() < kFewest) continue;
    // A median of differences tells a scatter about a third as well as its degrees.
    series.degrees = std::max(3.0, static_cast<double>(places.size()) / 3);
    for (DatedChange change :
         dated_changes(series, history.level / static_cast<double>(history.friction.size()))) {
      change.number = k;
      for (std::size_t* at : {&change.at, &change.earliest, &change.latest}) *at = places[*at];
      history.friction_changes.push_back(change);
    }
  }
}

/// Of no campaign it cannot be said that nothing changed. There are records.
void refuse_none_since(const std::vector<CampaignRecord>& records, std::chrono::nanoseconds since) {
  const auto newest = std::ranges::max_element(records, {}, &CampaignRecord::time);
  if (newest->time >= since) return;
  throw std::runtime_error("no campaign is from --since " + date_of(since) +
                           " on: the newest is of " + date_of(newest->time));
}

}  // namespace

double years(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count() / kYear_s;
}

std::vector<CampaignNote> History::notes_near(const DatedChange& change) const {
  const std::size_t before = change.earliest > 0 ? change.earliest - 1 : 0;
  const auto from = campaigns[before].record.time - kShortlyBefore;
  const auto to = campaigns[change.latest].record.time;
  std::vector<CampaignNote> near;
  for (const auto& [campaign, note] : notes)
    if ((note.time >= from && note.time <= to) || campaign == campaigns[change.at].record.name)
      near.push_back(note);
  return near;
}

History history_of(FoundCampaigns found, const HistoryOptions& options) {
  History history;
  history.level = options.level;
  history.messages = std::move(found.messages);
  auto records =
      each_result_once(of_one_kind(std::move(found.records), options, history), options, history);
  std::vector<std::string> states;
  for (const CampaignRecord& record : records) {
    const bool same = options.same_state && record.time >= options.same_state->first &&
                      record.time <= options.same_state->second;
    states.push_back(same ? "--same-state" : record.same_state());
  }
  std::size_t reference = reference_in(records, options, states);
  history.robot = records[reference].arm->robot;
  if (options.since) refuse_none_since(records, *options.since);
  if (options.since)  // earlier ones go, but for what is compared with
    for (std::size_t i = records.size(); i-- > 0;) {
      if (i == reference || !states[i].empty() || records[i].time >= *options.since) continue;
      records.erase(records.begin() + static_cast<std::ptrdiff_t>(i));
      states.erase(states.begin() + static_cast<std::ptrdiff_t>(i));
      if (i < reference) --reference;
    }
  tell_robots(records, history);
  compare_campaigns(std::move(records), states, reference, options, history);
  find_friction(history);
  gather_notes(found.notes, history);
  return history;
}

}  // namespace sweepd
