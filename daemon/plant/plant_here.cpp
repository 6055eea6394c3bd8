#include <stdexcept>
#include <utility>

#include "daemon/commands/compare_command.hpp"
#include "daemon/commands/plant_commands.hpp"
#include "daemon/plant/campaign_store.hpp"
#include "daemon/plant/collect.hpp"
#include "daemon/plant/publish.hpp"
#include "daemon/results/told_arm.hpp"

namespace sweepd::plant {
namespace {

/// SITE/CELL/ROBOT, or with /START behind it.
ToldArm stored_arm(Database& database, const std::string& name) {
  auto place = parse_robot_place(name);
  std::string session;
  if (!place) {
    const auto last = name.rfind('/');
    if (last != name.npos) place = parse_robot_place(name.substr(0, last));
    if (place) session = name.substr(last + 1);
  }
  if (!place)
    throw std::invalid_argument(name +
                                " names no robot: write SITE/CELL/ROBOT, or SITE/CELL/ROBOT/START");
  const auto campaigns = stored_campaigns(database, *place, session);
  if (campaigns.empty())
    throw std::runtime_error("the database has no campaign " + name +
                             ": check the name, and that `sweepd collect` runs");
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

}  // namespace sweepd::plant
