#include "tests/acceptance/halves.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <regex>
#include <utility>

#include "daemon/points/point_sweeps.hpp"
#include "daemon/points/points_file.hpp"
#include "daemon/text/units.hpp"
#include "identify/geometry/angle.hpp"
#include "identify/identification.hpp"
#include "tests/simulation/simulation.hpp"

namespace acceptance {
namespace {

/// Files of one arm, one a joint, in the order of the joints.
struct Logs {
  std::string name;
  std::vector<std::filesystem::path> files;
  std::string columns;
};

std::vector<Logs> logs_in(const std::filesystem::path& data) {
  std::vector<Logs> all;
  for (const auto& [folder, columns] :
       {std::pair<const char*, const char*>{"sweep-logs", "t_s,x_m,y_m,z_m,qx,qy,qz,qw"},
        {"sweep-logs-scene", ""}}) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(data / folder))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    const std::regex of_a_joint("(.*)-joint[0-9]+\\.csv");
    for (const auto& file : files) {
      std::smatch match;
      const std::string name = file.filename().string();
      if (!std::regex_match(name, match, of_a_joint)) continue;
      if (all.empty() || all.back().name != match[1]) all.push_back({match[1], {}, columns});
      all.back().files.push_back(file);
    }
  }
  return all;
}

struct Halves {
  identify::Identification first, second;
};

/// The part of a sweep that begins at this share of its arc's samples and ends at that.
identify::Sweep part_of(const identify::Sweep& sweep, double from, double to) {
  const auto& samples = *sweep.samples;
  const auto at = [&](double share) {
    return samples.begin() +
           static_cast<std::ptrdiff_t>(share * static_cast<double>(samples.size()));
  };
  identify::Sweep part = sweep;
  part.samples = std::make_shared<const std::vector<identify::Sample>>(at(from), at(to));
  return part;
}

Halves halves_of(const std::vector<identify::Sweep>& sweeps, const identify::Campaign& campaign) {
  const auto identified = [&](double from, double to) {
    std::vector<identify::Sweep> parts;
    for (const auto& sweep : sweeps) parts.push_back(part_of(sweep, from, to));
    return identify::identify(parts, campaign);
  };
  return {identified(0, 0.5), identified(0.5, 1)};
}

Halves halves_of(const Logs& logs) {
  std::vector<std::string> columns;
  for (std::size_t from = 0; from < logs.columns.size();) {
    const auto end = std::min(logs.columns.find(',', from), logs.columns.size());
    columns.push_back(logs.columns.substr(from, end - from));
    from = end + 1;
  }
  sweepd::PointsReader reader(columns, logs.files.size());
  std::vector<identify::Sweep> sweeps;
  sweepd::WorstLimit limit;
  for (std::size_t joint = 0; joint < logs.files.size(); ++joint) {
    auto file = reader.read(logs.files[joint], [](std::size_t) {});
    // Positions alone, as a device has them.
    for (auto& point : file.points) point.sample.has_orientation = false;
    for (auto& sweep :
         sweepd::sweeps_of_joint(file, joint, logs.files.size(), reader.resolution(), limit))
      if (sweep.defect == identify::SweepDefect::none) sweeps.push_back(std::move(sweep));
  }
  identify::Campaign campaign;
  campaign.joints = logs.files.size();
  campaign.resolution = reader.resolution();
  campaign.device_frame = true;
  return halves_of(sweeps, campaign);
}

/// Next to where the first half states the axis.
void add(Apart& apart, const identify::Axis& one, const identify::Axis& other) {
  const auto basis = identify::across(one.direction);
  const double sense = one.direction.dot(other.direction) < 0 ? -1 : 1;
  const Eigen::Vector3d turn = sense * other.direction - one.direction;
  // Where the other axis is stated, its place and its direction vary together.
  const double along = one.direction.dot(one.point_mm - other.point_mm);
  Eigen::Matrix<double, 3, 6> place;
  place << sense * along * Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity();
  const Eigen::Vector3d shift = other.point_mm + along * sense * other.direction - one.point_mm;
  const Eigen::Matrix2d turn_covariance =
      basis.transpose() *
      (one.covariance.topLeftCorner<3, 3>() + other.covariance.topLeftCorner<3, 3>()) * basis;
  const Eigen::Matrix2d shift_covariance =
      basis.transpose() *
      (one.covariance.bottomRightCorner<3, 3>() + place * other.covariance * place.transpose()) *
      basis;
  for (int k = 0; k < 2; ++k) {
    apart.z.push_back(basis.col(k).dot(turn) / std::sqrt(turn_covariance(k, k)));
    apart.direction_deg.push_back(sweepd::degrees(basis.col(k).dot(turn)));
    apart.z.push_back(basis.col(k).dot(shift) / std::sqrt(shift_covariance(k, k)));
    apart.place_mm.push_back(basis.col(k).dot(shift));
  }
}

void add_axes(Apart& apart, const Halves& halves) {
  for (std::size_t j = 0; j < halves.first.joints.size(); ++j) {
    const auto& one = halves.first.joints[j].axis;
    const auto& other = halves.second.joints[j].axis;
    if (one && other) add(apart, *one, *other);
  }
}

/// The table's numbers that do not depend on where home is. Where axes meet, the sense of X, and
/// with it the signs of a and alpha, is the sign of a length that is nothing.
Apart table_apart(const Halves& halves) {
  Apart apart;
  const auto& one = halves.first.dh;
  const auto& other = halves.second.dh;
  const auto compare = [&](const identify::DhNumber& first, const identify::DhNumber& second,
                           std::vector<double>& differences, double unit) {
    if (first.knowledge != identify::Knowledge::identified ||
        second.knowledge != identify::Knowledge::identified)
      return;
    const double difference = std::abs(second.value) - std::abs(first.value);
    apart.z.push_back(difference / std::hypot(first.sigma, second.sigma));
    differences.push_back(unit * difference);
  };
  for (std::size_t j = 0; j + 1 < one.size(); ++j) {
    if (j > 0) compare(one[j].b_mm, other[j].b_mm, apart.place_mm, 1);
    compare(one[j].a_mm, other[j].a_mm, apart.place_mm, 1);
    compare(one[j].alpha_rad, other[j].alpha_rad, apart.direction_deg, 1 / identify::kDegree);
  }
  return apart;
}

}  // namespace

std::vector<HalvesApart> halves_apart(const std::filesystem::path& data) {
  std::vector<HalvesApart> all;
  for (const Logs& logs : logs_in(data)) {
    const Halves halves = halves_of(logs);
    HalvesApart& apart = all.emplace_back(HalvesApart{logs.name, {}, table_apart(halves)});
    add_axes(apart.axes, halves);
  }
  return all;
}

std::vector<HalvesApart> sagging_halves_apart(double sag_arcsec, std::uint32_t arms) {
  std::vector<HalvesApart> all{{"kr5", {}, {}}, {"iiwa", {}, {}}};
  for (HalvesApart& of_kind : all)
    for (std::uint32_t seed = 1; seed <= arms; ++seed) {
      auto robot =
          simulation::built(of_kind.arm == "kr5" ? simulation::kr5() : simulation::iiwa(), seed);
      robot.elastic.clear();
      for (std::size_t j = 1; j < robot.arm.joints(); ++j) robot.elastic.push_back(j);
      simulation::World world;
      world.noise.range_mm = world.noise.across_mm = 0.0003;  // a micrometre that is printed
      world.sag_arcsec = sag_arcsec;
      simulation::Strokes how;
      how.arc_deg = 140;
      how.samples = 184;
      const simulation::Simulation simulation(simulation::at_random_home(robot, seed), how, world,
                                              seed);
      auto campaign = simulation.campaign();
      campaign.specified.reset();
      campaign.device_frame = true;
      add_axes(of_kind.axes, halves_of(simulation.sweeps(), campaign));
    }
  return all;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

}  // namespace acceptance
