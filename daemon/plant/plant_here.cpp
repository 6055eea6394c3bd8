#include <stdexcept>
#include <utility>

#include "daemon/commands/compare_command.hpp"
#include "daemon/commands/history_command.hpp"
#include "daemon/commands/plant_commands.hpp"
#include "daemon/plant/campaign_store.hpp"
#include "daemon/plant/plant_services.hpp"
#include "daemon/results/told_arm.hpp"

namespace sweepd::plant {
namespace {

[[noreturn]] void refuse_name(const std::string& name, const std::string& how) {
  throw std::invalid_argument(name + " names no robot: write " + how +
                              ", and of a name that holds / or % those as %2F and %25");
}

[[noreturn]] void refuse_missing(const std::string& name) {
  throw std::runtime_error("the database has no campaign " + name +
                           ": check the name, and that `sweepd collect` runs");
}

/// SITE/CELL/ROBOT, or with /START behind it.
ToldArm stored_arm(Database& database, const std::string& name) {
  auto place = parse_robot_place(name);
  std::string session;
  if (!place) {
    const auto last = name.rfind('/');
    if (last != name.npos) place = parse_robot_place(name.substr(0, last));
    if (place) session = name.substr(last + 1);
  }
  if (!place) refuse_name(name, "SITE/CELL/ROBOT, or SITE/CELL/ROBOT/START");
  const auto campaigns = stored_campaigns(database, *place, session);
  if (campaigns.empty()) refuse_missing(name);
  const StoredCampaign& newest = campaigns.back();
  return told_arm(newest.result, text(*place) + '/' + newest.session);
}

}  // namespace

int publish(const PublishOptions& options, const std::vector<std::string>&) {
  return publish_all(options);
}

int collect(const CollectOptions& options, const std::vector<std::string>&) {
  return collect_all(options);
}

int compare(const CompareOptions& options, const std::vector<std::string>&) {
  Database database(*options.database);
  return sweepd::compare(options, stored_arm(database, options.first.string()),
                         stored_arm(database, options.second.string()));
}

int history(const HistoryCommandOptions& options, const std::vector<std::string>&) {
  Database database(*options.database);
  FoundCampaigns found;
  for (const auto& name : options.of) {
    const auto place = parse_robot_place(name.string());
    if (!place) refuse_name(name.string(), "SITE/CELL/ROBOT");
    const auto campaigns = stored_campaigns(database, *place);
    if (campaigns.empty()) refuse_missing(name.string());
    for (const StoredCampaign& one : campaigns) {
      CampaignTexts texts;
      texts.name = one.session;
      texts.result = one.result;
      found.records.push_back(campaign_record(texts));
    }
  }
  return show_history(options, std::move(found));
}

}  // namespace sweepd::plant
