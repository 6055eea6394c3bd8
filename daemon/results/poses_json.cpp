#include "daemon/results/poses_json.hpp"

#include <stdexcept>

#include "daemon/results/json_parts.hpp"

namespace sweepd {
namespace {

using Json = nlohmann::ordered_json;
using identify::JointEffect;
using identify::PlacedArm;
using identify::PoseEstimate;

/// All digits.
Json list(const Eigen::VectorXd& of) {
  return std::vector<double>(of.begin(), of.end());
}

Eigen::VectorXd numbers(const Json& json) {
  const auto values = json.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::Vector3d vector3(const Json& json) {
  const Eigen::VectorXd values = numbers(json);
  if (values.size() != 3) throw std::runtime_error("a vector has not three numbers");
  return values;
}

Json effect(const identify::EffectEvidence& seen) {
  Json json = {{"joint", seen.effect.joint + 1}, {"kind", text(seen.effect.kind)}};
  if (seen.effect.kind == JointEffect::Kind::compliance) {
    json["urad_per_nm"] = rounded(1e6 * seen.effect.size(0), 4);
    json["sigma_urad_per_nm"] = rounded(1e6 * seen.sigma(0), 4);
  } else {
    if (seen.effect.kind == JointEffect::Kind::weight)
      json["link_of_joint"] = seen.effect.carried + 1;
    json["cos_arcsec"] = json_arcsec(seen.effect.size(0));
    json["sin_arcsec"] = json_arcsec(seen.effect.size(1));
    json["cos_sigma_arcsec"] = json_arcsec(seen.sigma(0));
    json["sin_sigma_arcsec"] = json_arcsec(seen.sigma(1));
  }
  json["chance"] = seen.chance;
  return json;
}

Json placed(const PlacedArm& arm) {
  Json rows = Json::array();
  for (const auto& row : arm.arm.rows)
    rows.push_back({row.b_mm, row.theta_rad, row.a_mm, row.alpha_rad, row.beta_rad});
  Json base = Json::array();
  for (Eigen::Index r = 0; r < 3; ++r) base.push_back(list(arm.base.matrix().row(r).transpose()));
  Json targets = Json::array();
  for (const auto& target : arm.targets_mm) targets.push_back(list(target));
  return {{"base", std::move(base)},      {"rows", std::move(rows)},
          {"home_rad", arm.arm.home_rad}, {"positive", arm.arm.positive},
          {"linear", arm.arm.linear},     {"targets_mm", std::move(targets)}};
}

PlacedArm placed(const Json& json) {
  PlacedArm arm;
  for (Eigen::Index r = 0; r < 3; ++r) {
    const Eigen::VectorXd row = numbers(json.at("base").at(static_cast<std::size_t>(r)));
    if (row.size() != 4) throw std::runtime_error("a row of a pose has not four numbers");
    arm.base.matrix().row(r) = row.transpose();
  }
  for (const Json& row : json.at("rows")) {
    const auto values = row.get<std::array<double, 5>>();
    arm.arm.rows.push_back({values[0], values[1], values[2], values[3], values[4]});
  }
  arm.arm.home_rad = json.at("home_rad").get<std::vector<double>>();
  arm.arm.positive = json.at("positive").get<std::vector<int>>();
  arm.arm.linear = json.at("linear").get<std::vector<bool>>();
  if (arm.arm.home_rad.size() != arm.arm.joints() || arm.arm.positive.size() != arm.arm.joints())
    throw std::runtime_error("a level has not one number a joint");
  for (const Json& target : json.at("targets_mm")) arm.targets_mm.push_back(vector3(target));
  return arm;
}

/// Poses counted from 1.
Json step(const PoseEstimate& found) {
  if (!found.step.seen) return {};
  using Of = identify::PoseStep::Of;
  const Of of = found.step.of;
  Json json = {{"of", of == Of::device   ? "device"
                      : of == Of::target ? "target"
                                         : "joint"},
               {"from", found.step.from + 1},
               {"chi_squared", rounded(found.step.chi_squared, 3)},
               {"moved_mm", json_length(found.step.moved_mm)},
               {"sudden", found.step.sudden}};
  if (of == Of::joint) json["joint"] = found.step.which + 1;
  return json;
}

Json model(const PoseEstimate& found, const std::vector<std::string>& names) {
  const identify::PoseFit& fit = found.fit;
  const identify::PoseModel& of = fit.model;
  Json axes = Json::array();
  for (const auto& axis : of.chain.axes)
    axes.push_back({{"direction", list(axis.direction)},
                    {"point_mm", list(axis.point_mm)},
                    {"linear", axis.linear}});
  Json targets = Json::array();
  for (std::size_t t = 0; t < of.chain.targets_mm.size(); ++t)
    targets.push_back({{"name", t < names.size() ? names[t] : std::string()},
                       {"point_mm", list(of.chain.targets_mm[t])}});
  Json effects = Json::array();
  for (const auto& one : of.effects) {
    effects.push_back({{"joint", one.joint + 1},
                       {"kind", text(one.kind)},
                       {"size", list(one.size)},
                       {"middle", list(one.middle)}});
    if (one.kind == JointEffect::Kind::weight) effects.back()["link_of_joint"] = one.carried + 1;
  }
  Json loads = Json::array();
  for (const auto& load : of.loads)
    loads.push_back({{"mass_kg", load.mass_kg},
                     {"joint", load.joint + 1},
                     {"center_mm", list(load.center_mm)}});
  Json covariance = Json::array();  // rows up to the diagonal
  const Eigen::MatrixXd whole = found.whole_covariance();
  for (Eigen::Index r = 0; r < of.lasting_parameters(); ++r)
    covariance.push_back(list(whole.row(r).head(r + 1).transpose()));
  return {{"home_rad", of.home_rad},
          {"axes", std::move(axes)},
          {"targets", std::move(targets)},
          {"effects", std::move(effects)},
          {"loads", std::move(loads)},
          {"up", list(of.chain.up)},
          {"position_mm", fit.noise.position_mm},
          {"joint_rad", fit.noise.joint_rad},
          {"covariance", std::move(covariance)}};
}

JointEffect::Kind kind(const std::string& name) {
  for (const auto one :
       {JointEffect::Kind::once, JointEffect::Kind::twice, JointEffect::Kind::weight,
        JointEffect::Kind::compliance, JointEffect::Kind::play})
    if (name == text(one)) return one;
  throw std::runtime_error("an effect of an unknown kind");
}

/// Counted from 1 in the file.
std::size_t joint_of(const Json& json, std::size_t joints, const char* key = "joint") {
  const auto joint = json.at(key).get<std::size_t>();
  if (joint < 1 || joint > joints) throw std::runtime_error("a joint that the arm has not");
  return joint - 1;
}

}  // namespace

const char* words(identify::Freedom freedom) noexcept {
  switch (freedom) {
    case identify::Freedom::frames:
      return "base and tool";
    case identify::Freedom::zeros:
      return "and the joints' zeros";
    case identify::Freedom::lengths:
      return "and all lengths";
    case identify::Freedom::twists:
      return "and all twists";
  }
  return "";
}

Json poses_json(const Outcome& outcome) {
  const PoseEstimate& found = *outcome.identification.poses;
  Json outliers = Json::array();
  for (const std::size_t i : found.outliers) outliers.push_back(i + 1);
  Json effects = Json::array();
  for (const auto& one : found.effects) effects.push_back(effect(one));
  Json levels = Json::array();
  for (const auto& level : found.levels) {
    levels.push_back({{"free", words(level.freedom)}});
    levels.back().update(json_left(level.left));
    levels.back()["arm"] = placed(level.arm);
  }
  const auto& seen = found.observability;
  return {{"count", found.poses.size()},
          {"outliers", std::move(outliers)},
          {"with_sweeps", found.with_sweeps},
          {"left", json_left(found.left)},
          {"noise",
           {{"position_mm", json_length(found.fit.noise.position_mm)},
            {"joint_arcsec", json_arcsec(found.fit.noise.joint_rad)},
            {"gears_arcsec", json_arcsec(found.fit.noise.gears_rad)},
            {"weights_arcsec", json_arcsec(found.fit.noise.weights_rad)},
            {"play_arcsec", json_arcsec(found.fit.noise.play_rad)},
            {"orientation_arcsec",
             found.fit.with_orientation ? json_arcsec(found.fit.noise.orientation_rad) : Json()}}},
          {"observability",
           {{"largest_per_mm", seen.largest},
            {"smallest_per_mm", seen.smallest},
            {"mean_per_mm", seen.mean},
            {"displacement_sigma_mm", json_length(seen.displacement_mm)}}},
          {"drift",
           {{"chi_squared", rounded(found.drift.chi_squared, 3)},
            {"degrees_of_freedom", found.drift.numbers},
            {"moved_mm", json_length(found.drift.moved_mm)},
            {"seen", found.drift.seen}}},
          {"step", step(found)},
          {"effects", std::move(effects)},
          {"levels", std::move(levels)},
          {"model",
           model(found, outcome.points ? outcome.points->targets : std::vector<std::string>())}};
}

Eigen::Matrix3d PosePredictor::covariance_at(const identify::Pose& pose) const {
  const identify::PoseRow row = identify::pose_row(fit.model, pose, false);
  return row.by_parameter * fit.covariance * row.by_parameter.transpose() +
         fit.noise.covariance(row.by_joint) + identify::play_covariance(fit.model, pose, row);
}

PosePredictor pose_predictor(const Json& poses) {
  PosePredictor predictor;
  const Json& json = poses.at("model");
  identify::PoseModel& model = predictor.fit.model;
  model.home_rad = json.at("home_rad").get<std::vector<double>>();
  for (const Json& axis : json.at("axes"))
    model.chain.axes.push_back({vector3(axis.at("direction")), vector3(axis.at("point_mm")),
                                axis.at("linear").get<bool>()});
  const std::size_t joints = model.chain.axes.size();
  if (joints == 0 || joints > identify::kMostJoints || model.home_rad.size() != joints)
    throw std::runtime_error("not one axis and home a joint");
  for (const Json& target : json.at("targets")) {
    predictor.targets.push_back(target.at("name").get<std::string>());
    model.chain.targets_mm.push_back(vector3(target.at("point_mm")));
  }
  for (const Json& one : json.at("effects")) {
    JointEffect effect{kind(one.at("kind").get<std::string>()), joint_of(one, joints)};
    if (effect.kind == JointEffect::Kind::weight)
      effect.carried = joint_of(one, joints, "link_of_joint");
    effect.size = numbers(one.at("size"));
    effect.middle = numbers(one.at("middle"));
    model.effects.push_back(effect);
  }
  for (const Json& one : json.at("loads"))
    model.loads.push_back(
        {one.at("mass_kg").get<double>(), joint_of(one, joints), vector3(one.at("center_mm"))});
  model.chain.up = vector3(json.at("up"));
  predictor.fit.noise.position_mm = json.at("position_mm").get<double>();
  predictor.fit.noise.joint_rad = json.at("joint_rad").get<double>();
  const Eigen::Index count = model.parameters();
  const Json& rows = json.at("covariance");
  if (rows.size() != static_cast<std::size_t>(count))
    throw std::runtime_error("a covariance of another size than the model");
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::VectorXd row = numbers(rows.at(static_cast<std::size_t>(r)));
    if (row.size() != r + 1) throw std::runtime_error("a covariance that is not triangular");
    lower.row(r).head(r + 1) = row.transpose();
  }
  predictor.fit.covariance = lower.selfadjointView<Eigen::Lower>();
  for (const Json& level : poses.at("levels")) predictor.levels.push_back(placed(level.at("arm")));
  return predictor;
}

}  // namespace sweepd
