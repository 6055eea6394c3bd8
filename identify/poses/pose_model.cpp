#include "identify/poses/pose_model.hpp"

#include <algorithm>
#include <cmath>

#include "identify/chain/chain_sag.hpp"
#include "identify/geometry/line.hpp"

namespace identify {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kGravity_m_s2 = 9.80665;
constexpr double kMillimetres = 1000;

/// Of the weights beyond a joint, about its axis, Nm.
double torque(const PoseModel& model, std::size_t joint, const Turns& turns) {
  Isometry3d carried = Isometry3d::Identity();
  Vector3d axis = Vector3d::Zero(), point = Vector3d::Zero();
  double sum = 0;
  for (std::size_t j = 0; j < model.chain.axes.size(); ++j) {
    if (j == joint) {
      axis = carried.linear() * model.chain.axes[j].direction;
      point = carried * model.chain.axes[j].point_mm;
    }
    carried = carried * model.chain.axes[j].displacement(turns[j]);
    if (j < joint) continue;
    for (const Load& load : model.loads)
      if (load.joint == j)
        sum -= load.mass_kg * axis.dot((carried * load.center_mm - point).cross(model.chain.up));
  }
  return kGravity_m_s2 * sum / kMillimetres;
}

}  // namespace

std::string_view text(JointEffect::Kind kind) noexcept {
  switch (kind) {
    case JointEffect::Kind::once:
      return "once_a_turn";
    case JointEffect::Kind::twice:
      return "twice_a_turn";
    case JointEffect::Kind::weight:
      return "weight";
    case JointEffect::Kind::compliance:
      return "compliance";
    case JointEffect::Kind::play:
      return "play";
  }
  return "";
}

Turns PoseModel::told(const Sample& sample) const {
  Turns turns{};
  for (std::size_t j = 0; j < chain.axes.size(); ++j) {
    const double turn = sample.angles_rad[j] - home_rad[j];
    turns[j] = chain.axes[j].linear ? turn : short_way(turn);
  }
  return turns;
}

std::vector<Vector2d> PoseModel::patterns(const std::vector<JointEffect>& of, const Turns& told,
                                          const JointSenses& senses) const {
  const LinkLevers levers(chain, told);
  std::vector<Vector2d> found;
  for (const JointEffect& effect : of) {
    Vector2d here(0, 0);
    if (effect.kind == JointEffect::Kind::play) {
      here.x() = static_cast<double>(senses[effect.joint]);
    } else if (effect.kind == JointEffect::Kind::compliance) {
      here.x() = torque(*this, effect.joint, told);
    } else if (effect.kind == JointEffect::Kind::weight) {
      const auto arms = across(chain.axes[effect.carried].direction);
      for (Index k = 0; k < 2; ++k)
        here(k) = levers.lever(effect.joint, effect.carried, arms.col(k));
    } else {
      const double turn = (effect.kind == JointEffect::Kind::once ? 1 : 2) * told[effect.joint];
      here = {std::cos(turn), std::sin(turn)};
    }
    found.emplace_back(here - effect.middle);
  }
  return found;
}

Turns PoseModel::turned(const Turns& told, const JointSenses& senses) const {
  Turns turns = told;
  const auto by_size = patterns(effects, told, senses);
  for (std::size_t e = 0; e < effects.size(); ++e)
    turns[effects[e].joint] += effects[e].size.dot(by_size[e]);
  for (std::size_t j = 0; j < chain.axes.size(); ++j)
    if (const std::size_t at = place_of(j, told[j]); at < places.size())
      turns[j] += places[at].off_rad;
  return turns;
}

Vector3d PoseModel::position_mm(const Pose& pose) const {
  return chain.target_mm(pose.target, turned(told(pose.sample), pose.senses));
}

std::size_t PoseModel::place_of(std::size_t joint, double told_rad) const {
  if (is_known(told_rad)) return places.size();
  const auto at = std::find_if(places.begin(), places.end(), [&](const JointPlace& place) {
    return place.joint == joint && std::abs(place.told_rad - told_rad) <= kOnePlace_rad;
  });
  return static_cast<std::size_t>(at - places.begin());
}

Index PoseModel::parameters() const {
  return lasting_parameters() + static_cast<Index>(places.size());
}

Index PoseModel::fixed_parameters() const {
  Index count = chain_parameters().count(true);
  for (const JointEffect& effect : effects)
    if (!effect.assumed) count += effect.count();
  return count;
}

Index PoseModel::lasting_parameters() const {
  Index count = chain_parameters().count(true);
  for (const JointEffect& effect : effects) count += effect.count();
  return count;
}

PoseModel moved(const PoseModel& model, const Eigen::VectorXd& change) {
  PoseModel other = model;
  Index at = model.chain_parameters().count(true);
  other.chain = moved(model.chain, change.head(at));
  for (JointEffect& effect : other.effects) {
    effect.size.head(effect.count()) += change.segment(at, effect.count());
    at += effect.count();
  }
  for (JointPlace& place : other.places) place.off_rad += change(at++);
  return other;
}

}  // namespace identify
