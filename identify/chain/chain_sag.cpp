#include "identify/chain/chain_sag.hpp"

#include <algorithm>
#include <cmath>

#include "identify/dh/upright.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

LinkLevers::LinkLevers(const Chain& chain, const Turns& turns) : chain_(&chain) {
  Matrix3d turned = Matrix3d::Identity();
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    if (turns[j] != 0 && !chain.axes[j].linear)
      turned = turned * Eigen::AngleAxisd(turns[j], chain.axes[j].direction);
    turned_[j] = turned;
  }
}

double LinkLevers::lever(std::size_t joint, std::size_t link, const Vector3d& arm) const {
  return chain_->up.dot(
      (turned_[joint] * chain_->axes[joint].direction).cross(turned_[link] * arm));
}

namespace {

/// A link as its weights may be on it.
struct Link {
  std::size_t joint = 0;  ///< turns it
  Vector3d along;         ///< from its axis to the next one, unit
  double length_mm = 0;
  double beyond_mm = 0;  ///< of the links behind
};

/// The links that turn, from the first joint's on. Along an axis, links may be put anywhere: they
/// begin where they are nearest to where the next one begins.
std::vector<Link> links_of(const Chain& chain, const std::vector<bool>& known) {
  std::vector<Link> links;
  Vector3d next = chain.targets_mm.front();
  double beyond = 0;
  for (std::size_t j = chain.axes.size(); j-- > 0;) {
    const ChainAxis& axis = chain.axes[j];
    if (!known[j] || axis.linear) continue;
    const Vector3d foot = axis.point_mm + axis.direction.dot(next - axis.point_mm) * axis.direction;
    const double length = (next - foot).norm();
    links.push_back({j,
                     length > 0 ? Vector3d((next - foot) / length) : across(axis.direction).col(0),
                     length, beyond});
    beyond += length;
    next = foot;
  }
  std::reverse(links.begin(), links.end());
  return links;
}

}  // namespace

std::vector<ChainSag> sags_of(const Chain& chain, const std::vector<bool>& known,
                              const std::vector<double>& sag_rad) {
  std::vector<ChainSag> sags;
  if (sag_rad.empty() || chain.up.isZero()) return sags;
  constexpr double kBeside = 0.5;  // how far beside its line a link's weight is, in that along it
  constexpr double kOff = 0.1;     // and at least off its axis, in the length of the arm from there
  const auto links = links_of(chain, known);
  const double most = *std::max_element(sag_rad.begin(), sag_rad.end());
  for (std::size_t first = 0; first < links.size(); ++first) {
    const std::size_t j = links[first].joint;
    const bool stays = first == 0 && is_upright(chain.axes[j].direction, chain.up);
    if (!(sag_rad[j] > 0) || stays) continue;
    const std::size_t before = sags.size();
    double squares = 0;
    for (std::size_t l = first; l < links.size(); ++l) {
      const Link& link = links[l];
      const double off = kOff * (link.length_mm + link.beyond_mm);
      const double weight = link.length_mm / 2 + link.beyond_mm;
      const double along = weight * std::hypot(link.length_mm, off);
      const double beside = weight * std::hypot(kBeside * link.length_mm, off);
      squares += along * along;
      sags.push_back({j, link.joint, link.along, along, 0});
      sags.push_back(
          {j, link.joint, chain.axes[link.joint].direction.cross(link.along), beside, 0});
    }
    for (std::size_t s = before; s < sags.size(); ++s)
      sags[s].share *= sag_rad[j] / most / std::sqrt(squares);
  }
  std::erase_if(sags, [](const ChainSag& sag) { return !(sag.share > 0); });
  return sags;
}

std::vector<double> sag_levers(const Chain& chain, const Turns& turns) {
  std::vector<double> levers;
  if (chain.sags.empty()) return levers;
  const LinkLevers here(chain, turns), home(chain, {});
  for (const ChainSag& sag : chain.sags)
    levers.push_back(here.lever(sag.joint, sag.link, sag.arm) -
                     home.lever(sag.joint, sag.link, sag.arm));
  return levers;
}

Turns sagged(const Chain& chain, const Turns& turns) {
  Turns bent = turns;
  const auto levers = sag_levers(chain, turns);
  for (std::size_t s = 0; s < levers.size(); ++s)
    bent[chain.sags[s].joint] += chain.sags[s].rad * levers[s];
  return bent;
}

}  // namespace identify
