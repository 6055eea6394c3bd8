#include "daemon/settings/robot_setup.hpp"

#include <algorithm>

#include "daemon/settings/toml_table.hpp"
#include "daemon/text/units.hpp"

namespace sweepd {
namespace {

void check_fit(const RobotSetup& setup) {
  if (!setup.plan || !setup.description) return;
  const auto findings = check_plan(*setup.plan, *setup.description);
  if (!findings.empty()) throw ConfigError(findings.front());
}

}  // namespace

RobotSetup load_setup(const RobotSettings& settings) {
  const auto description =
      settings.description.empty() ? std::nullopt : std::optional(settings.description);
  RobotSetup setup = load_setup(description, settings.plan);
  setup.name = settings.name;
  setup.signals = settings.signals;
  setup.device = settings.device;
  return setup;
}

RobotSetup load_setup(const std::optional<std::filesystem::path>& description,
                      const std::optional<std::filesystem::path>& plan) {
  RobotSetup setup;
  setup.name = "robot";
  if (description) {
    setup.description = load_robot(*description);
    setup.name = description->stem().string();
    std::replace(setup.name.begin(), setup.name.end(), '_', '-');
    setup.joints = setup.description->joints();
  }
  if (plan) {
    setup.plan = load_plan(*plan);
    if (!description) setup.joints = setup.plan->home_deg.size();
  }
  check_fit(setup);
  return setup;
}

identify::Campaign campaign(const RobotSetup& setup, const identify::Resolution& resolution) {
  identify::Campaign campaign;
  campaign.joints = setup.joints;
  campaign.resolution = resolution;
  if (setup.description) {
    campaign.specified = setup.description->arm;
    if (campaign.specified) {
      campaign.loads = setup.description->loads;
      campaign.up = setup.description->up;
    }
    for (const double sag : setup.description->sag_arcsec)
      campaign.sag_rad.push_back(sag * identify::kArcsec);
  }
  if (setup.plan) {
    for (const double home : setup.plan->home_deg)
      campaign.declared_home_rad.push_back(radians(home));
    for (const auto& sweep : setup.plan->sweeps) {
      const std::size_t joint = sweep.joint - 1;
      for (const PlannedMove& move : moves_of(*setup.plan, sweep)) {
        const double way_deg = move.to_deg - move.from_deg;
        if (way_deg == 0) continue;
        if (campaign.order.empty() || campaign.order.back().joint != joint)
          campaign.order.push_back({joint, way_deg > 0 ? 1 : -1});
        campaign.order.back().strokes_rad.push_back(radians(way_deg));
      }
    }
  }
  return campaign;
}

}  // namespace sweepd
