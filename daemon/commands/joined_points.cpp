#include "daemon/commands/joined_points.hpp"

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <utility>

#include "daemon/points/csv_file.hpp"
#include "daemon/stream/device_take.hpp"
#include "daemon/stream/session.hpp"
#include "daemon/stream/traces.hpp"
#include "rsi/capture/capture_reader.hpp"
#include "rsi/capture/conversation.hpp"

namespace sweepd {
namespace {

void check(const PointsFile& file) {
  const std::string name = file.path.string();
  if (!file.with_times)
    throw CsvError(name +
                   ": expected times beside the points, as --angles needs them, found none: "
                   "export the file with times");
  if (file.angles > 0 || file.with_joints)
    throw CsvError(name +
                   ": expected points without joints and angles, as --angles tells them, "
                   "found some: skip them with --columns, or leave out --angles");
}

/// The angles of all samples.
class AngleRecorder : public StreamSink {
 public:
  explicit AngleRecorder(identify::AngleTape& tape) : tape_(tape) {}
  void sample(const identify::Sample& sample, std::string_view) override { tape_.add(sample); }

 private:
  identify::AngleTape& tape_;
};

}  // namespace

Outcome joined_with_trace(const std::vector<PointsFile>& files,
                          const identify::Resolution& resolution,
                          const std::vector<std::string>& targets,
                          const std::vector<std::filesystem::path>& traces, const RobotSetup& setup,
                          bool quiet) {
  auto take = std::make_shared<DeviceTake>(DeviceTake{identify::AngleTape(setup.joints), {}, {}});
  for (const PointsFile& file : files) {
    check(file);
    for (const Point& point : file.points)
      if (point.sample.has_position) take->points.push_back({point.target, point.sample});
  }
  std::stable_sort(take->points.begin(), take->points.end(),
                   [](const auto& a, const auto& b) { return a.sample.time_s < b.sample.time_s; });
  take->targets = targets;
  take->step_mm = resolution.position_mm;
  take->files = files.size();
  take->required = true;

  AngleRecorder angles(take->angles);
  Session session(setup, "points", angles);
  const auto ordered = traces_in_order(traces);
  const auto search = rsi::find_conversation(ordered);
  if (!search.note.empty()) std::cerr << "sweepd: " << search.note << '\n';
  if (search.chosen)
    read_traces(ordered, "identify", quiet, std::cerr, [&](const rsi::Datagram& datagram) {
      if (search.chosen->direction(datagram) == rsi::Direction::from_controller)
        session.telegram(datagram);
    });
  session.finish();
  if (take->angles.size() == 0)
    throw std::runtime_error(
        traces.front().string() + ": expected RSI telegrams with the angles of " +
        std::to_string(setup.joints) +
        " joints, found none: record with DEF_AIPos in the Ethernet file's SEND list");
  Snapshot snapshot = session.snapshot();
  snapshot.device = std::move(take);
  return outcome_of(snapshot);
}

}  // namespace sweepd
