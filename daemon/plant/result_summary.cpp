#include "daemon/plant/result_summary.hpp"

#include <exception>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/report/file_parts.hpp"
#include "daemon/results/change.hpp"
#include "daemon/text/file_names.hpp"
#include "daemon/text/json_text.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string result_summary(const RobotPlace& place, const FinishedResult& result) {
  const Json told = Json::parse(result.bytes, nullptr, false);
  Json json = {{"schema", "sweepd.summary/1"},
               {"site", place.site},
               {"cell", place.cell},
               {"robot", place.robot},
               {"session", result.session}};
  if (!result.started.empty()) json["started"] = result.started;
  if (!result.ended.empty()) json["ended"] = result.ended;
  json["status"] = text_of(told, "status");
  if (const auto reason = text_of(told, "reason"); !reason.empty()) json["reason"] = reason;
  json["describes"] = text_of(told, "describes");
  json["joints"] = list_of(told, "joints").size();
  json["doubts"] = list_of(told, "doubts").size();
  json["warnings"] = list_of(told, "warnings").size();
  json["bytes"] = result.bytes.size();
  json["sha256"] = result.sha256;
  return json_text(json);
}

SummaryOfChange change_since(const std::filesystem::path& before, const FinishedResult& result) {
  try {
    // The order of arguments is the compiler's, and what is said of both being wrong is not.
    ToldArm was = read_told_arm(before);
    ToldArm is = told_arm(result.bytes, result.folder / file_names::kResult);
    return {change_json(change_between(std::move(was), std::move(is), kUsualLevel)), {}};
  } catch (const std::exception& problem) {
    return {std::nullopt, problem.what()};
  }
}

}  // namespace sweepd
