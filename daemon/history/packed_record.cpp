#include <algorithm>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "daemon/history/campaign_record.hpp"
#include "daemon/report/file_parts.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Index;

Json packed_numbers(const double* begin, Index count) {
  // One text of bytes: a list of numbers takes ten times as long to read.
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(begin);
  return Json::binary(
      std::vector<std::uint8_t>(bytes, bytes + static_cast<std::size_t>(count) * sizeof(double)));
}

std::vector<double> numbers_in(const Json& json) {
  const auto& bytes = json.get_binary();
  std::vector<double> numbers(bytes.size() / sizeof(double));
  std::copy_n(bytes.data(), numbers.size() * sizeof(double),
              reinterpret_cast<std::uint8_t*>(numbers.data()));
  return numbers;
}

Json maybe(const std::optional<double>& value) {
  return value ? Json(*value) : Json();
}
std::optional<double> maybe(const Json& json) {
  return json.is_number() ? std::optional(json.get<double>()) : std::nullopt;
}

Json packed(const ToldArm& told) {
  std::vector<double> rows;
  Json relations = Json::array(), linear = Json::array(), positive = Json::array(),
       home = Json::array(), gear = Json::array(), ranges = Json::array();
  for (std::size_t j = 0; j < told.joints(); ++j) {
    const identify::DhEstimate& row = told.arm.dh[j];
    for (const auto* number : numbers_of(row)) rows.push_back(number->value);
    relations.push_back(static_cast<int>(row.relation));
    linear.push_back(row.linear);
    positive.push_back(told.arm.positive[j]);
    home.push_back(maybe(told.arm.home_rad[j]));
    gear.push_back(maybe(told.arm.gear[j]));
    ranges.push_back(told.reach.ranges[j]);
  }
  const Eigen::MatrixXd& covariance = told.arm.covariance;
  return {{"file", told.file.string()},
          {"robot", told.robot},
          {"status", told.status},
          {"reason", told.reason},
          {"describes", told.describes},
          {"rows", packed_numbers(rows.data(), static_cast<Index>(rows.size()))},
          {"covariance", packed_numbers(covariance.data(), covariance.size())},
          {"relations", relations},
          {"linear", linear},
          {"positive", positive},
          {"home", home},
          {"gear", gear},
          {"ranges", ranges},
          {"tool", packed_numbers(told.reach.tool_mm.data(), 3)},
          {"with_limits", told.with_limits},
          {"all_joints", told.all_joints}};
}

ToldArm arm_in(const Json& json) {
  ToldArm told;
  told.file = json.at("file").get<std::string>();
  told.robot = json.at("robot").get<std::string>();
  told.status = json.at("status").get<std::string>();
  told.reason = json.at("reason").get<std::string>();
  told.describes = json.at("describes").get<std::string>();
  const auto rows = numbers_in(json.at("rows"));
  const std::size_t joints = rows.size() / 5;
  for (std::size_t j = 0; j < joints; ++j) {
    identify::DhEstimate row;
    std::size_t k = 5 * j;
    for (const auto& of : identify::kDhNumbers) (row.*of.number).value = rows[k++];
    row.relation = static_cast<identify::Relation>(json.at("relations").at(j).get<int>());
    row.linear = json.at("linear").at(j).get<bool>();
    told.arm.dh.push_back(row);
    told.arm.positive.push_back(json.at("positive").at(j).get<int>());
    told.arm.home_rad.push_back(maybe(json.at("home").at(j)));
    told.arm.gear.push_back(maybe(json.at("gear").at(j)));
    told.reach.linear.push_back(row.linear);
    told.reach.ranges.push_back(json.at("ranges").at(j).get<identify::TurnRange>());
  }
  const auto covariance = numbers_in(json.at("covariance"));
  const auto size = static_cast<Index>(5 * joints);
  if (static_cast<Index>(covariance.size()) != size * size)
    throw std::runtime_error("a record's covariance has another size");
  told.arm.covariance = Eigen::Map<const Eigen::MatrixXd>(covariance.data(), size, size);
  const auto tool = numbers_in(json.at("tool"));
  if (tool.size() != 3) throw std::runtime_error("a record's tool has another size");
  told.reach.tool_mm = Eigen::Vector3d(tool[0], tool[1], tool[2]);
  told.with_limits = json.at("with_limits").get<bool>();
  told.all_joints = json.at("all_joints").get<std::size_t>();
  return told;
}

}  // namespace

std::vector<std::uint8_t> packed(const CampaignRecord& record) {
  Json json = {{"name", record.name},
               {"time", record.time.count()},
               {"time_from", record.time_from},
               {"why_not", record.why_not},
               {"broken_notes", record.broken_notes}};
  if (record.arm) json["arm"] = packed(*record.arm);
  for (const JointFriction& one : record.friction)
    json["friction"].push_back({one.joint, one.friction_a, one.scatter_a, one.speed_deg_s});
  if (record.link)
    json["link"] = {
        record.link->verdict,      record.link->received,         record.link->lost,
        record.link->late_replies, record.link->latency_p99_9_us, record.link->jitter_p99_9_us};
  std::string notes;
  for (const CampaignNote& note : record.notes) notes += note_line(note) + '\n';
  json["notes"] = notes;
  return Json::to_cbor(json);
}

CampaignRecord unpacked(const std::uint8_t* bytes, std::size_t size) {
  const Json json = Json::from_cbor(bytes, bytes + size);
  CampaignRecord record;
  record.name = json.at("name").get<std::string>();
  record.time = std::chrono::nanoseconds(json.at("time").get<std::int64_t>());
  record.time_from = json.at("time_from").get<std::string>();
  record.why_not = json.at("why_not").get<std::string>();
  record.broken_notes = json.at("broken_notes").get<std::vector<std::size_t>>();
  if (json.contains("arm")) record.arm = arm_in(json.at("arm"));
  for (const Json& one : list_of(json, "friction"))
    record.friction.push_back({one.at(0).get<std::size_t>(), one.at(1).get<double>(),
                               one.at(2).get<double>(), one.at(3).get<double>()});
  if (json.contains("link")) {
    const Json& link = json.at("link");
    record.link = LinkQuality{link.at(0).get<std::string>(), link.at(1).get<double>(),
                              link.at(2).get<double>(),      link.at(3).get<double>(),
                              link.at(4).get<double>(),      link.at(5).get<double>()};
  }
  record.notes = parse_notes(json.at("notes").get<std::string>()).notes;
  return record;
}

}  // namespace sweepd
